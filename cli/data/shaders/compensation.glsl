// Energy compensation of that surface: light that meets several facets is returned (Kulla and Conty 2017). Call these
// three functions in place of those above.
//
// `compensation` is the texture of --compensation. Alpha is what facets lose of the light of a direction, in equal
// steps of √cos θ from grazing to facing; red, green and blue are what several bounces return of it, in rows as those
// of the lut. Upload all four channels as they are, rows in the file's order, with linear filtering, no mipmaps, edges
// clamped.

vec4 goniochrome_lost(sampler2D compensation, float cos_theta, float parameter) {
    vec2 size = vec2(textureSize(compensation, 0));
    vec2 place = clamp(vec2(sqrt(max(cos_theta, 0.0)), parameter), 0.0, 1.0);
    return textureLod(compensation, (place * (size - 1.0) + 0.5) / size, 0.0);
}

// BRDF in 1/sr, without the cosine: linear RGB.
vec3 goniochrome_compensated_brdf(
    sampler2D lut, /*sampler2D facets, */sampler2D compensation, vec3 wi, vec3 wo, float parameter
) {
    if (min(wi.z, wo.z) <= 1e-6) {
        return vec3(0.0);
    }
    vec4 lost = goniochrome_lost(compensation, wi.z, parameter);
    lost.a *= goniochrome_lost(compensation, wo.z, parameter).a;
    return goniochrome_brdf(lut, /*facets, */wi, wo, parameter) + lost.a * lost.rgb;
}

// Density per solid angle with which goniochrome_compensated_sample draws wo for wi.
float goniochrome_compensated_pdf(/*sampler2D facets, */sampler2D compensation, vec3 wi, vec3 wo) {
    if (min(wi.z, wo.z) <= 1e-6) {
        return 0.0;
    }
    float lost = goniochrome_lost(compensation, wi.z, 0.0).a;
    return mix(goniochrome_pdf(/*facets, */wi, wo), wo.z / GONIOCHROME_PI, lost);
}

// Draws wo for wi by u in [0, 1)², as goniochrome_sample. The weight of a draw is goniochrome_compensated_brdf · wo.z /
// goniochrome_compensated_pdf.
vec3 goniochrome_compensated_sample(/*sampler2D facets, */sampler2D compensation, vec3 wi, vec2 u) {
    float lost = goniochrome_lost(compensation, wi.z, 0.0).a;
    if (u.x < lost) {
        float square = u.x / lost, phi = 2.0 * GONIOCHROME_PI * u.y;
        return vec3(sqrt(square) * vec2(cos(phi), sin(phi)), sqrt(max(1.0 - square, 0.0)));
    }
    return goniochrome_sample(/*facets, */wi, vec2((u.x - lost) / max(1.0 - lost, 1e-6), u.y));
}
