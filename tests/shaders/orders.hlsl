
// A fragment for each point of a list, in a frame turned by 45° around the binormal.
Texture2D strengths : register(t0);
SamplerState strengths_sampler : register(s1);
Texture2D points : register(t2);
float3 goniochrome_environment(float3 d, float width) {
    return float3(1.0 + d.x, 1.0 + d.y * d.z, 1.0 + 0.5 * d.z * d.z) / (1.0 + width);
}
float4 main(float4 place : SV_Position) : SV_Target {
    float3 tangent = float3(sqrt(0.5), 0.0, sqrt(0.5)), binormal = float3(0.0, 1.0, 0.0);
    float3 normal = float3(-sqrt(0.5), 0.0, sqrt(0.5));
    float2 t = 2.0 * points.Load(int3(int2(place.xy), 0)).xy - 1.0;
    float up_squared = 1.0 - dot(t, t);
    float3 wo = normalize(float3(t, -1.0));
    if (up_squared > 0.0) {
        wo = float3(t, sqrt(up_squared));
    }
    wo = wo.x * tangent + wo.y * binormal + wo.z * normal;
    return float4(goniochrome_orders(strengths, strengths_sampler, tangent, binormal, normal, wo), 1.0);
}
