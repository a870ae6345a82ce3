
// A fragment for each line of a list, of two texels: wi with a parameter; then wo with 0, or two numbers for a draw
// with 1.
Texture2D lut : register(t0);
SamplerState lut_sampler : register(s1);
Texture2D points : register(t2);
Texture2D<float> facets : register(t3);
float4 main(float4 position : SV_Position) : SV_Target {
    int2 place = int2(position.xy) * int2(2, 1);
    float4 from = points.Load(int3(place, 0)), to = points.Load(int3(place + int2(1, 0), 0));
    if (to.w > 0.5) {
        float3 wo = goniochrome_sample(facets, from.xyz, to.xy);
        return float4(wo, goniochrome_pdf(facets, from.xyz, wo));
    }
    float3 f = goniochrome_brdf(lut, lut_sampler, facets, from.xyz, to.xyz, from.w);
    return float4(f, goniochrome_pdf(facets, from.xyz, to.xyz));
}
