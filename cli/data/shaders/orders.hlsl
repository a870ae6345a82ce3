// Light that a surface reflects in diffraction orders, from a table made by `goniochrome export --to order-lut`; HLSL,
// shader model 4 or newer.
//
// Upload the texture's rows in the file's order, as linear half floats, with linear filtering, no mipmaps, edges
// clamped. The tangent is the table's x: lines of a grating run along the binormal unless LINES_ALONG_TANGENT says
// otherwise. tangent, binormal and normal are orthogonal unit vectors, wo is the unit vector towards the viewer.
//
// Define goniochrome_environment: linear RGB radiance that arrives from a unit vector. `width` is the angle in radians
// between the light of two neighbouring wavelengths, 0 for a mirror: with an environment blurred by it (a mip level),
// a small light becomes a streak instead of dots. The angle is measured along the streak.

float3 goniochrome_environment(float3 direction, float width);

float3 goniochrome_orders(Texture2D strengths, SamplerState strengths_sampler, float3 tangent, float3 binormal,
                          float3 normal, float3 wo) {
    const float MAX_ANGLE = 1.5533430343; // 89°
    float3 o = float3(dot(wo, tangent), dot(wo, binormal), dot(wo, normal));
    if (o.z <= 0.0) {
        return float3(0.0, 0.0, 0.0);
    }
    float2 at = GONIOCHROME_LINES_ALONG_TANGENT ? o.yx : o.xy;
    float2 angles = float2(atan2(at.x, length(float2(at.y, o.z))), atan2(at.y, o.z)) / MAX_ANGLE;
    float2 place = float2(0.5 * angles.x + 0.5, GONIOCHROME_LINES ? abs(angles.y) : 0.5 * angles.y + 0.5);
    place = saturate(place) * (GONIOCHROME_NODES - 1.0) + 0.5;
    float2 size;
    strengths.GetDimensions(size.x, size.y);
    float3 sum = float3(0.0, 0.0, 0.0);
    for (int k = 0; k < GONIOCHROME_ORDER_COUNT; ++k) {
        float2 grating = GONIOCHROME_ORDERS[k] / GONIOCHROME_PERIOD_NM;
        bool mirror = all(grating == 0.0);
        float3 reflectance = float3(0.0, 0.0, 0.0);
        for (int group = 0; group < GONIOCHROME_WAVELENGTH_COUNT / 4; ++group) {
            float2 texel = place + GONIOCHROME_NODES * float2(float(k), float(group));
            float4 strength = strengths.SampleLevel(strengths_sampler, texel / size, 0.0);
            for (int c = 0; c < 4; ++c) {
                int wavelength = 4 * group + c;
                float3 weight = GONIOCHROME_WEIGHTS[wavelength] * strength[c];
                float2 t = GONIOCHROME_WAVELENGTHS_NM[wavelength] * grating - o.xy;
                float up_squared = 1.0 - dot(t, t);
                if (mirror) {
                    reflectance += weight;
                } else if (up_squared > 0.0) {
                    float up = sqrt(up_squared);
                    float3 direction = t.x * tangent + t.y * binormal + up * normal;
                    float width = GONIOCHROME_STEP_NM * length(grating) / up;
                    float matched = 4.0 * up * o.z / ((up + o.z) * (up + o.z));
                    sum += matched * weight * goniochrome_environment(direction, width);
                }
            }
        }
        if (mirror) {
            sum += reflectance * goniochrome_environment(2.0 * o.z * normal - wo, 0.0);
        }
    }
    return sum;
}
