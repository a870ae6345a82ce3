
// A fragment for each point of a list.
@group(0) @binding(0) var lut: texture_2d<f32>;
@group(0) @binding(1) var lut_sampler: sampler;
@group(0) @binding(2) var points: texture_2d<f32>;
@fragment
fn main(@builtin(position) place: vec4<f32>) -> @location(0) vec4<f32> {
    let at = textureLoad(points, vec2<i32>(place.xy), 0).xy;
    return vec4<f32>(goniochrome_reflectance(lut, lut_sampler, at.x, at.y), 1.0);
}
