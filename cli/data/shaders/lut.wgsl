// Reflectance of a film from a table made by `goniochrome export --to lut`; WGSL.
//
// Texel centres lie at the ends: the first column is cos θ = 0 (grazing), the last cos θ = 1 (facing); the first row in
// memory (v = 0) is parameter 0 (the --vary range's start), the last parameter 1 (its end). Upload the rows in the
// file's order, as linear data, with linear filtering, no mipmaps, edges clamped. Some programs turn a picture over as
// they load it, so that v = 0 is its bottom (Blender, three.js): for them, export with --origin bottom. A table without
// --vary has one row: any parameter will do.
fn goniochrome_reflectance(lut: texture_2d<f32>, lut_sampler: sampler, cos_theta: f32, parameter: f32) -> vec3<f32> {
    let size = vec2<f32>(textureDimensions(lut, 0));
    let place = clamp(vec2<f32>(cos_theta, parameter), vec2<f32>(0.0), vec2<f32>(1.0));
    return textureSampleLevel(lut, lut_sampler, (place * (size - 1.0) + 0.5) / size, 0.0).rgb;
}
