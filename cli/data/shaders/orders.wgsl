// Light that a surface reflects in diffraction orders, from a table made by `goniochrome export --to order-lut`; WGSL.
//
// Upload the texture's rows in the file's order, as linear half floats, with linear filtering, no mipmaps, edges
// clamped. The tangent is the table's x: lines of a grating run along the binormal unless LINES_ALONG_TANGENT says
// otherwise. tangent, binormal and normal are orthogonal unit vectors, wo is the unit vector towards the viewer.
//
// Define `fn goniochrome_environment(direction: vec3<f32>, width: f32) -> vec3<f32>`: linear RGB radiance that arrives
// from a unit vector. `width` is the angle in radians between the light of two neighbouring wavelengths, 0 for a
// mirror: with an environment blurred by it (a mip level), a small light becomes a streak instead of dots. The angle is
// measured along the streak.

fn goniochrome_orders(strengths: texture_2d<f32>, strengths_sampler: sampler, tangent: vec3<f32>, binormal: vec3<f32>,
                      normal: vec3<f32>, wo: vec3<f32>) -> vec3<f32> {
    const MAX_ANGLE = 1.5533430343; // 89°
    let o = vec3<f32>(dot(wo, tangent), dot(wo, binormal), dot(wo, normal));
    if (o.z <= 0.0) {
        return vec3<f32>(0.0);
    }
    let at = select(o.xy, o.yx, GONIOCHROME_LINES_ALONG_TANGENT);
    let angles = vec2<f32>(atan2(at.x, length(vec2<f32>(at.y, o.z))), atan2(at.y, o.z)) / MAX_ANGLE;
    var place = vec2<f32>(0.5 * angles.x + 0.5, select(0.5 * angles.y + 0.5, abs(angles.y), GONIOCHROME_LINES));
    place = clamp(place, vec2<f32>(0.0), vec2<f32>(1.0)) * (GONIOCHROME_NODES - 1.0) + 0.5;
    let size = vec2<f32>(textureDimensions(strengths, 0));
    var sum = vec3<f32>(0.0);
    for (var k = 0; k < GONIOCHROME_ORDER_COUNT; k++) {
        let grating = GONIOCHROME_ORDERS[k] / GONIOCHROME_PERIOD_NM;
        let mirror = all(grating == vec2<f32>(0.0));
        var reflectance = vec3<f32>(0.0);
        for (var group = 0; group < GONIOCHROME_WAVELENGTH_COUNT / 4; group++) {
            let texel = place + GONIOCHROME_NODES * vec2<f32>(f32(k), f32(group));
            let strength = textureSampleLevel(strengths, strengths_sampler, texel / size, 0.0);
            for (var c = 0; c < 4; c++) {
                let wavelength = 4 * group + c;
                let weight = GONIOCHROME_WEIGHTS[wavelength] * strength[c];
                let t = GONIOCHROME_WAVELENGTHS_NM[wavelength] * grating - o.xy;
                let up_squared = 1.0 - dot(t, t);
                if (mirror) {
                    reflectance += weight;
                } else if (up_squared > 0.0) {
                    let up = sqrt(up_squared);
                    let direction = t.x * tangent + t.y * binormal + up * normal;
                    let width = GONIOCHROME_STEP_NM * length(grating) / up;
                    let matched = 4.0 * up * o.z / ((up + o.z) * (up + o.z));
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
