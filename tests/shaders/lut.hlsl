
// A fragment for each point of a list.
Texture2D lut : register(t0);
SamplerState lut_sampler : register(s1);
Texture2D points : register(t2);
float4 main(float4 place : SV_Position) : SV_Target {
    float2 at = points.Load(int3(int2(place.xy), 0)).xy;
    return float4(goniochrome_reflectance(lut, lut_sampler, at.x, at.y), 1.0);
}
