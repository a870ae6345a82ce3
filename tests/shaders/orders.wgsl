
// A fragment for each point of a list, in a frame turned by 45° around the binormal.
@group(0) @binding(0) var strengths: texture_2d<f32>;
@group(0) @binding(1) var strengths_sampler: sampler;
@group(0) @binding(2) var points: texture_2d<f32>;
fn goniochrome_environment(d: vec3<f32>, width: f32) -> vec3<f32> {
    return vec3<f32>(1.0 + d.x, 1.0 + d.y * d.z, 1.0 + 0.5 * d.z * d.z) / (1.0 + width);
}
@fragment
fn main(@builtin(position) place: vec4<f32>) -> @location(0) vec4<f32> {
    let tangent = vec3<f32>(sqrt(0.5), 0.0, sqrt(0.5));
    let binormal = vec3<f32>(0.0, 1.0, 0.0);
    let normal = vec3<f32>(-sqrt(0.5), 0.0, sqrt(0.5));
    let t = 2.0 * textureLoad(points, vec2<i32>(place.xy), 0).xy - 1.0;
    let up_squared = 1.0 - dot(t, t);
    var wo = normalize(vec3<f32>(t, -1.0));
    if (up_squared > 0.0) {
        wo = vec3<f32>(t, sqrt(up_squared));
    }
    wo = wo.x * tangent + wo.y * binormal + wo.z * normal;
    return vec4<f32>(goniochrome_orders(strengths, strengths_sampler, tangent, binormal, normal, wo), 1.0);
}
