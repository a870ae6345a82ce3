// Energy compensation of that surface: light that meets several facets is returned (Kulla and Conty 2017). Call these
// three functions in place of those above.
//
// `compensation` is the texture of --compensation. Alpha is what facets lose of the light of a direction, in equal
// steps of √cos θ from grazing to facing; red, green and blue are what several bounces return of it, in rows as those
// of the lut. Upload all four channels as they are, rows in the file's order, with linear filtering, no mipmaps, edges
// clamped.

fn goniochrome_lost(
    compensation: texture_2d<f32>, lut_sampler: sampler, cos_theta: f32, parameter: f32
) -> vec4<f32> {
    let size = vec2<f32>(textureDimensions(compensation, 0));
    let place = clamp(vec2<f32>(sqrt(max(cos_theta, 0.0)), parameter), vec2<f32>(0.0), vec2<f32>(1.0));
    return textureSampleLevel(compensation, lut_sampler, (place * (size - 1.0) + 0.5) / size, 0.0);
}

// BRDF in 1/sr, without the cosine: linear RGB.
fn goniochrome_compensated_brdf(
    lut: texture_2d<f32>, lut_sampler: sampler, /*facets: texture_2d<f32>, */compensation: texture_2d<f32>,
    wi: vec3<f32>, wo: vec3<f32>, parameter: f32
) -> vec3<f32> {
    if (min(wi.z, wo.z) <= 1e-6) {
        return vec3<f32>(0.0);
    }
    let lost = goniochrome_lost(compensation, lut_sampler, wi.z, parameter);
    let both = lost.a * goniochrome_lost(compensation, lut_sampler, wo.z, parameter).a;
    return goniochrome_brdf(lut, lut_sampler, /*facets, */wi, wo, parameter) + both * lost.rgb;
}

// Density per solid angle with which goniochrome_compensated_sample draws wo for wi.
fn goniochrome_compensated_pdf(
    /*facets: texture_2d<f32>, */compensation: texture_2d<f32>, lut_sampler: sampler, wi: vec3<f32>, wo: vec3<f32>
) -> f32 {
    if (min(wi.z, wo.z) <= 1e-6) {
        return 0.0;
    }
    let lost = goniochrome_lost(compensation, lut_sampler, wi.z, 0.0).a;
    return mix(goniochrome_pdf(/*facets, */wi, wo), wo.z / GONIOCHROME_PI, lost);
}

// Draws wo for wi by u in [0, 1)², as goniochrome_sample. The weight of a draw is goniochrome_compensated_brdf · wo.z /
// goniochrome_compensated_pdf.
fn goniochrome_compensated_sample(
    /*facets: texture_2d<f32>, */compensation: texture_2d<f32>, lut_sampler: sampler, wi: vec3<f32>, u: vec2<f32>
) -> vec3<f32> {
    let lost = goniochrome_lost(compensation, lut_sampler, wi.z, 0.0).a;
    if (u.x < lost) {
        let square = u.x / lost;
        let phi = 2.0 * GONIOCHROME_PI * u.y;
        return vec3<f32>(sqrt(square) * vec2<f32>(cos(phi), sin(phi)), sqrt(max(1.0 - square, 0.0)));
    }
    return goniochrome_sample(/*facets, */wi, vec2<f32>((u.x - lost) / max(1.0 - lost, 1e-6), u.y));
}
