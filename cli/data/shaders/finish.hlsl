// A rough surface of that film: facets whose normals have a distribution, and which hide one another by Smith's model.
// Directions are unit vectors in the surface's frame, x along the tangent, y along the binormal, z along the normal,
// and leave the surface. Light that meets a second facet is left out.

static const float GONIOCHROME_PI = 3.14159265358979;

// erf, to 1.5e-7.
float goniochrome_erf(float x) {
    float a = abs(x), t = 1.0 / (1.0 + 0.3275911 * a);
    float p = t * (0.254829592 + t * (-0.284496736 + t * (1.421413741 + t * (-1.453152027 + t * 1.061405429))));
    return sign(x) * (1.0 - p * exp(-a * a));
}

// Area of the facets that a direction sees, cos θ/G1.
float goniochrome_visible_area(float3 w) {
    float2 stretched = w.xy * GONIOCHROME_ROUGHNESS;
    float root = length(stretched);
    if (!GONIOCHROME_BECKMANN) {
        return 0.5 * (w.z + length(float2(w.z, root)));
    }
    float a = min(w.z / max(root, 1e-20), 8.0);
    float tail = exp(-a * a) / sqrt(GONIOCHROME_PI);
    return 0.5 * (w.z * (1.0 + goniochrome_erf(a)) + root * tail);
}

// Density of the facets' normals per solid angle and area.
float goniochrome_density(float3 m) {
    float2 slope = m.xy / GONIOCHROME_ROUGHNESS;
    float stretched = dot(slope, slope), square = m.z * m.z;
    float shape = GONIOCHROME_BECKMANN ? exp(-stretched / square) / (square * square)
                                       : 1.0 / ((stretched + square) * (stretched + square));
    return shape / (GONIOCHROME_PI * GONIOCHROME_ROUGHNESS.x * GONIOCHROME_ROUGHNESS.y);
}

// BRDF in 1/sr, without the cosine: linear RGB.
float3 goniochrome_brdf(Texture2D lut, SamplerState lut_sampler, float3 wi, float3 wo, float parameter) {
    if (min(wi.z, wo.z) <= 1e-6) {
        return float3(0.0, 0.0, 0.0);
    }
    float3 sum = wi + wo;
    float size = length(sum), area_i = goniochrome_visible_area(wi), area_o = goniochrome_visible_area(wo);
    float seen = GONIOCHROME_SEPARABLE ? area_i * area_o : area_i * wo.z + area_o * wi.z - wi.z * wo.z;
    float3 rho = goniochrome_reflectance(lut, lut_sampler, 0.5 * size, parameter);
    return rho * (0.25 * goniochrome_density(sum / size) / seen);
}

// Density per solid angle with which goniochrome_sample draws wo for wi.
float goniochrome_pdf(float3 wi, float3 wo) {
    if (min(wi.z, wo.z) <= 1e-6) {
        return 0.0;
    }
    return 0.25 * goniochrome_density(normalize(wi + wo)) / goniochrome_visible_area(wi);
}

// Inverse of erf (Giles 2010).
float goniochrome_erf_inverse(float x) {
    x = clamp(x, -0.99999994, 0.99999994);
    float w = -log((1.0 - x) * (1.0 + x)), p;
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
float goniochrome_cumulative(float a, float to) {
    return 0.5 * a * (1.0 + goniochrome_erf(to)) + 0.5 * exp(-to * to) / sqrt(GONIOCHROME_PI);
}

// Slope towards a direction of cotangent a, on a Beckmann surface of roughness 1, by u in [0, 1).
float goniochrome_slope(float a, float u) {
    float low = -4.0, high = min(a, 4.0), wanted = u * goniochrome_cumulative(a, high);
    float x = 0.5 * (low + high);
    for (int i = 0; i < 24; ++i) {
        float excess = goniochrome_cumulative(a, x) - wanted;
        if (excess > 0.0) {
            high = x;
        } else {
            low = x;
        }
        float newton = x - excess / max((a - x) * exp(-x * x) / sqrt(GONIOCHROME_PI), 1e-30);
        x = newton >= low && newton <= high ? newton : 0.5 * (low + high);
    }
    return x;
}

// Draws wo for wi by u in [0, 1)²; its z is not positive for a draw without light, which counts. The weight of a draw
// is goniochrome_brdf · wo.z / goniochrome_pdf.
float3 goniochrome_sample(float3 wi, float2 u) {
    float3 w = float3(wi.xy * GONIOCHROME_ROUGHNESS, wi.z), m;
    if (GONIOCHROME_BECKMANN) {
        float across = length(w.xy);
        float2 phi = across > 0.0 ? w.xy / across : float2(1.0, 0.0);
        float x = goniochrome_slope(min(w.z / max(across, 1e-20), 1e9), u.x);
        float y = goniochrome_erf_inverse(2.0 * u.y - 1.0);
        m = float3(phi.y * y - phi.x * x, -phi.y * x - phi.x * y, 1.0);
    } else {
        w = normalize(w);
        float phi = 2.0 * GONIOCHROME_PI * u.x, z = (1.0 - u.y) * (1.0 + w.z) - w.z;
        m = float3(sqrt(max(1.0 - z * z, 0.0)) * float2(cos(phi), sin(phi)), z) + w;
    }
    m = normalize(float3(m.xy * GONIOCHROME_ROUGHNESS, m.z));
    return normalize(2.0 * dot(wi, m) * m - wi);
}
