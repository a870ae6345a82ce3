// A rough surface of that film: facets whose normals have a distribution, and which hide one another by Smith's model.
// Directions are unit vectors in the surface's frame, x along the tangent, y along the binormal, z along the normal,
// and leave the surface. Light that meets a second facet is left out.

const GONIOCHROME_PI = 3.14159265358979;

// erf, to 1.5e-7.
fn goniochrome_erf(x: f32) -> f32 {
    let a = abs(x);
    let t = 1.0 / (1.0 + 0.3275911 * a);
    let p = t * (0.254829592 + t * (-0.284496736 + t * (1.421413741 + t * (-1.453152027 + t * 1.061405429))));
    return sign(x) * (1.0 - p * exp(-a * a));
}

// Area of the facets that a direction sees, cos θ/G1.
fn goniochrome_visible_area(w: vec3<f32>) -> f32 {
    let root = length(w.xy * GONIOCHROME_ROUGHNESS);
    if (!GONIOCHROME_BECKMANN) {
        return 0.5 * (w.z + length(vec2<f32>(w.z, root)));
    }
    let a = min(w.z / max(root, 1e-20), 8.0);
    let tail = exp(-a * a);
    return 0.5 * (w.z * (1.0 + goniochrome_erf(a)) + root * tail / sqrt(GONIOCHROME_PI));
}

// Density of the facets' normals per solid angle and area.
fn goniochrome_density(m: vec3<f32>) -> f32 {
    let slope = m.xy / GONIOCHROME_ROUGHNESS;
    let stretched = dot(slope, slope);
    let square = m.z * m.z;
    let area = GONIOCHROME_PI * GONIOCHROME_ROUGHNESS.x * GONIOCHROME_ROUGHNESS.y;
    if (GONIOCHROME_BECKMANN) {
        return exp(-stretched / square) / (square * square * area);
    }
    return 1.0 / ((stretched + square) * (stretched + square) * area);
}

// BRDF in 1/sr, without the cosine: linear RGB.
fn goniochrome_brdf(
    lut: texture_2d<f32>, lut_sampler: sampler, wi: vec3<f32>, wo: vec3<f32>, parameter: f32
) -> vec3<f32> {
    if (min(wi.z, wo.z) <= 1e-6) {
        return vec3<f32>(0.0);
    }
    let sum = wi + wo;
    let size = length(sum);
    let area_i = goniochrome_visible_area(wi);
    let area_o = goniochrome_visible_area(wo);
    let seen = select(area_i * wo.z + area_o * wi.z - wi.z * wo.z, area_i * area_o, GONIOCHROME_SEPARABLE);
    let rho = goniochrome_reflectance(lut, lut_sampler, 0.5 * size, parameter);
    return rho * (0.25 * goniochrome_density(sum / size) / seen);
}

// Density per solid angle with which goniochrome_sample draws wo for wi.
fn goniochrome_pdf(wi: vec3<f32>, wo: vec3<f32>) -> f32 {
    if (min(wi.z, wo.z) <= 1e-6) {
        return 0.0;
    }
    return 0.25 * goniochrome_density(normalize(wi + wo)) / goniochrome_visible_area(wi);
}

// Inverse of erf (Giles 2010).
fn goniochrome_erf_inverse(at: f32) -> f32 {
    let x = clamp(at, -0.99999994, 0.99999994);
    var w = -log((1.0 - x) * (1.0 + x));
    var p = 0.0;
    if (w < 5.0) {
        w -= 2.5;
        p = 2.81022636e-08;
        p = 3.43273939e-07 + p * w;
        p = -3.5233877e-06 + p * w;
        p = -4.39150654e-06 + p * w;
        p = 0.00021858087 + p * w;
        p = -0.00125372503 + p * w;
        p = -0.00417768164 + p * w;
        p = 0.246640727 + p * w;
        p = 1.50140941 + p * w;
    } else {
        w = sqrt(w) - 3.0;
        p = -0.000200214257;
        p = 0.000100950558 + p * w;
        p = 0.00134934322 + p * w;
        p = -0.00367342844 + p * w;
        p = 0.00573950773 + p * w;
        p = -0.0076224613 + p * w;
        p = 0.00943887047 + p * w;
        p = 1.00167406 + p * w;
        p = 2.83297682 + p * w;
    }
    return p * x;
}

// Integral of (a - x) exp(-x²)/sqrt(π) up to `to`.
fn goniochrome_cumulative(a: f32, to: f32) -> f32 {
    return 0.5 * a * (1.0 + goniochrome_erf(to)) + 0.5 * exp(-to * to) / sqrt(GONIOCHROME_PI);
}

// Slope towards a direction of cotangent a, on a Beckmann surface of roughness 1, by u in [0, 1).
fn goniochrome_slope(a: f32, u: f32) -> f32 {
    var low = -4.0;
    var high = min(a, 4.0);
    let wanted = u * goniochrome_cumulative(a, high);
    var x = 0.5 * (low + high);
    for (var i = 0; i < 24; i++) {
        let excess = goniochrome_cumulative(a, x) - wanted;
        if (excess > 0.0) {
            high = x;
        } else {
            low = x;
        }
        let newton = x - excess / max((a - x) * exp(-x * x) / sqrt(GONIOCHROME_PI), 1e-30);
        x = select(0.5 * (low + high), newton, newton >= low && newton <= high);
    }
    return x;
}

// Draws wo for wi by u in [0, 1)²; its z is not positive for a draw without light, which counts. The weight of a draw
// is goniochrome_brdf · wo.z / goniochrome_pdf.
fn goniochrome_sample(wi: vec3<f32>, u: vec2<f32>) -> vec3<f32> {
    let stretched = vec3<f32>(wi.xy * GONIOCHROME_ROUGHNESS, wi.z);
    var m = vec3<f32>(0.0);
    if (GONIOCHROME_BECKMANN) {
        let across = length(stretched.xy);
        let phi = select(vec2<f32>(1.0, 0.0), stretched.xy / max(across, 1e-20), across > 0.0);
        let x = goniochrome_slope(min(stretched.z / max(across, 1e-20), 1e9), u.x);
        let y = goniochrome_erf_inverse(2.0 * u.y - 1.0);
        m = vec3<f32>(phi.y * y - phi.x * x, -phi.y * x - phi.x * y, 1.0);
    } else {
        let w = normalize(stretched);
        let phi = 2.0 * GONIOCHROME_PI * u.x;
        let z = (1.0 - u.y) * (1.0 + w.z) - w.z;
        m = vec3<f32>(sqrt(max(1.0 - z * z, 0.0)) * vec2<f32>(cos(phi), sin(phi)), z) + w;
    }
    m = normalize(vec3<f32>(m.xy * GONIOCHROME_ROUGHNESS, m.z));
    return normalize(2.0 * dot(wi, m) * m - wi);
}
