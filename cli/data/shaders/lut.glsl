// Reflectance of a film from a table made by `goniochrome export --to lut`; GLSL 3.30 or ES 3.00.
//
// Texel centres lie at the ends: the first column is cos θ = 0 (grazing), the last cos θ = 1 (facing); the first row in
// memory (v = 0) is parameter 0 (the --vary range's start), the last parameter 1 (its end). Upload the rows in the
// file's order, as linear data, with linear filtering, no mipmaps, edges clamped. Some programs turn a picture over as
// they load it, so that v = 0 is its bottom (Blender, three.js): for them, export with --origin bottom. A table without
// --vary has one row: any parameter will do.
vec3 goniochrome_reflectance(sampler2D lut, float cos_theta, float parameter) {
    vec2 size = vec2(textureSize(lut, 0));
    vec2 place = clamp(vec2(cos_theta, parameter), 0.0, 1.0);
    return textureLod(lut, (place * (size - 1.0) + 0.5) / size, 0.0).rgb;
}
