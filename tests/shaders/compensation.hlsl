
// A fragment for each line of a list, of two texels: wi with a parameter; then wo with 0, or two numbers for a draw
// with 1.
Texture2D lut : register(t0);
SamplerState lut_sampler : register(s1);
Texture2D points : register(t2);
/*Texture2D<float> facets : register(t3);
*/Texture2D compensation : register(t4);
float4 main(float4 position : SV_Position) : SV_Target {
    int2 place = int2(position.xy) * int2(2, 1);
    float4 from = points.Load(int3(place, 0)), to = points.Load(int3(place + int2(1, 0), 0));
    if (to.w > 0.5) {
        float3 wo = goniochrome_compensated_sample(/*facets, */compensation, lut_sampler, from.xyz, to.xy);
        return float4(wo, goniochrome_compensated_pdf(/*facets, */compensation, lut_sampler, from.xyz, wo));
    }
    float3 f = goniochrome_compensated_brdf(
        lut, lut_sampler, /*facets, */compensation, from.xyz, to.xyz, from.w);
    return float4(f, goniochrome_compensated_pdf(/*facets, */compensation, lut_sampler, from.xyz, to.xyz));
}
