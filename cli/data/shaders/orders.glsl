// Light that a surface reflects in diffraction orders, from a table made by `goniochrome export --to order-lut`; GLSL
// 3.30 or ES 3.00.
//
// Upload the texture's rows in the file's order, as linear half floats, with linear filtering, no mipmaps, edges
// clamped. The tangent is the table's x: lines of a grating run along the binormal unless LINES_ALONG_TANGENT says
// otherwise. tangent, binormal and normal are orthogonal unit vectors, wo is the unit vector towards the viewer.
//
// Define goniochrome_environment: linear RGB radiance that arrives from a unit vector. `width` is the angle in radians
// between the light of two neighbouring wavelengths, 0 for a mirror: with an environment blurred by it (a mip level),
// a small light becomes a streak instead of dots. The angle is measured along the streak.

vec3 goniochrome_environment(vec3 direction, float width);

vec3 goniochrome_orders(sampler2D strengths, vec3 tangent, vec3 binormal, vec3 normal, vec3 wo) {
    const float MAX_ANGLE = 1.5533430343; // 89°
    vec3 o = vec3(dot(wo, tangent), dot(wo, binormal), dot(wo, normal));
    if (o.z <= 0.0) {
        return vec3(0.0);
    }
    vec2 at = GONIOCHROME_LINES_ALONG_TANGENT ? o.yx : o.xy;
    vec2 angles = vec2(atan(at.x, length(vec2(at.y, o.z))), atan(at.y, o.z)) / MAX_ANGLE;
    vec2 place = vec2(0.5 * angles.x + 0.5, GONIOCHROME_LINES ? abs(angles.y) : 0.5 * angles.y + 0.5);
    place = clamp(place, 0.0, 1.0) * (GONIOCHROME_NODES - 1.0) + 0.5;
    vec2 size = vec2(textureSize(strengths, 0));
    vec3 sum = vec3(0.0);
    for (int k = 0; k < GONIOCHROME_ORDER_COUNT; ++k) {
        vec2 grating = GONIOCHROME_ORDERS[k] / GONIOCHROME_PERIOD_NM;
        bool mirror = grating == vec2(0.0);
        vec3 reflectance = vec3(0.0);
        for (int group = 0; group < GONIOCHROME_WAVELENGTH_COUNT / 4; ++group) {
            vec2 texel = place + GONIOCHROME_NODES * vec2(float(k), float(group));
            vec4 strength = textureLod(strengths, texel / size, 0.0);
            for (int c = 0; c < 4; ++c) {
                int wavelength = 4 * group + c;
                vec3 weight = GONIOCHROME_WEIGHTS[wavelength] * strength[c];
                vec2 t = GONIOCHROME_WAVELENGTHS_NM[wavelength] * grating - o.xy;
                float up_squared = 1.0 - dot(t, t);
                if (mirror) {
                    reflectance += weight;
                } else if (up_squared > 0.0) {
                    float up = sqrt(up_squared);
                    vec3 direction = t.x * tangent + t.y * binormal + up * normal;
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
