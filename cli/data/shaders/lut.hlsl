// Reflectance of a film from a table made by `goniochrome export --to lut`; HLSL, shader model 4 or newer.
//
// Texel centres lie at the ends: the first column is cos θ = 0 (grazing), the last cos θ = 1 (facing); the first row in
// memory (v = 0) is parameter 0 (the --vary range's start), the last parameter 1 (its end). Upload the rows in the
// file's order, as linear data, with linear filtering, no mipmaps, edges clamped. Some programs turn a picture over as
// they load it, so that v = 0 is its bottom (Blender, three.js): for them, export with --origin bottom. A table without
// --vary has one row: any parameter will do.
float3 goniochrome_reflectance(Texture2D lut, SamplerState lut_sampler, float cos_theta, float parameter) {
    float2 size;
    lut.GetDimensions(size.x, size.y);
    float2 place = saturate(float2(cos_theta, parameter));
    return lut.SampleLevel(lut_sampler, (place * (size - 1.0) + 0.5) / size, 0.0).rgb;
}
