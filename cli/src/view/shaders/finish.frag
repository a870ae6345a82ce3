// A mirror-like table on rough facets, by filtered importance sampling (Křivánek and Colbert, "Real-time shading with
// filtered importance sampling", 2008).
//
// A picture looks at some of the GGX facets that the viewer sees, drawn by spherical caps (Dupuy and Benyoub, 2023).
// Each mirrors ρ(θ_d) of light that is blurred over the solid angle for which the look stands. Facets of Beckmann's
// distribution are weighted by the ratio of the densities. Tabulated facets are drawn by D cos θ_m, and turned by half
// a turn where the viewer does not see them. In even light the looks have exactly the albedo.
//
// A sheet lets light straight through, by the mean of τ over the facets that the viewer sees.
uniform sampler2D table; // ρ in equal steps of cos θ_d
// Light that is reflected, and that goes through, over cos θ and cos² φ; for tabulated facets over cos θ and φ.
uniform sampler2D albedo, through;
uniform sampler2D seenFacets; // squared roughness of facets of which directions see as much, over azimuth and √cos θ
// With energy compensation: what facets lose over √cos θ, what several bounces return of it, and the mean of the light
// that they lose around each normal.
uniform sampler2D losses, returnedLight;
uniform vec3 several;
uniform int part; // 0 for reflected light, 1 for what goes through, 2 for the light straight ahead
uniform vec2 alpha; // roughness along tangent and binormal
// Cosine and sine of the azimuth on the cap, height over it; how many looks it stands for. Of tabulated facets, x and y
// of the normal; share of its D in the sum of both turns; level of light by that sum.
uniform vec4 looks[LOOKS];
uniform float sharpness; // level of light that a look at facets straight ahead sees
out vec4 colour;

vec3 wo; // the viewer
vec3 viewer; // as facets of roughness 1 see it
mat3 back; // from the surface to the light
float area, level; // visible facets of the viewer; level of light
vec3 sum = vec3(0.0), even = vec3(0.0); // light that facets reflect; the same in light of radiance 1
vec4 mean = vec4(0.0); // light that they see, and its weight

// Linear between texels from the middle of the first to that of the last.
vec3 between(sampler2D list, vec2 place) {
    vec2 size = vec2(textureSize(list, 0));
    return textureLod(list, (0.5 + place * (size - 1.0)) / size, 0.0).rgb;
}

// Area of the facets that a direction sees, projected along it: cos θ/G₁.
float visibleArea(vec3 w) {
    if (TABULATED) {
        vec2 size = vec2(textureSize(seenFacets, 0));
        vec2 place = vec2(atan(w.y, w.x) / TAU, sqrt(w.z)) * vec2(1.0, (size.y - 1.0) / size.y) + 0.5 / size;
        return 0.5 * (w.z + sqrt(w.z * w.z + textureLod(seenFacets, place, 0.0).r * dot(w.xy, w.xy)));
    }
    float root = length(alpha * w.xy);
    if (!BECKMANN) return 0.5 * (w.z + length(vec2(w.z, root)));
    // erf by Abramowitz and Stegun, 7.1.26.
    float a = w.z / max(root, 1e-20), tail = exp(-a * a), t = 1.0 / (1.0 + 0.3275911 * a);
    float poly = t * (0.2548296 + t * (-0.2844967 + t * (1.4214138 + t * (-1.453152 + t * 1.0614054))));
    return 0.5 * (w.z * (2.0 - tail * poly) + root * 0.5641896 * tail);
}

// G₂ of light from a direction at this height, over G₁ and cos θ of the viewer.
float unmasked(float towards, float areaOfLight) {
    return towards / (SEPARABLE ? areaOfLight * area : areaOfLight * wo.z + area * towards - towards * wo.z);
}

// Adds what a facet reflects, by its weight and the level of light that it sees.
void add(float cosine, vec3 wi, float weight, float atLevel) {
    vec3 rho = texelFetch(table, ivec2(cosine * RHO_STEPS + 0.5, 0), 0).rgb;
    vec4 seenHere = weight * vec4(seen(back * wi, atLevel), 1.0);
    sum += rho * seenHere.rgb;
    even += rho * seenHere.a;
    mean += seenHere;
}

void lookAtNormal(vec4 look) {
    vec3 m = vec3(look.xy, sqrt(1.0 - dot(look.xy, look.xy)));
    float cosine = dot(wo, m), share = look.z;
    if (cosine < 0.0) {
        m.xy = -m.xy;
        cosine = dot(wo, m);
        share = 1.0 - share;
    }
    share = max(share, 1e-6);
    float drawn = dot(wo, vec3(-m.xy, m.z)) < 0.0 ? share : 1.0;
    vec3 wi = 2.0 * cosine * m - wo;
    float towards = max(wi.z, 0.0);
    float weight = drawn * cosine / m.z * unmasked(towards, visibleArea(vec3(wi.xy, towards)));
    add(cosine, wi, weight, level + look.w + 0.5 * log2(cosine * drawn / share));
}

void lookAlong(vec4 look) {
    if (TABULATED) { lookAtNormal(look); return; }
    float z = look.z * (1.0 + viewer.z) - viewer.z;
    vec3 h = vec3(sqrt(max(1.0 - z * z, 0.0)) * look.xy, z) + viewer;
    vec3 m = vec3(alpha * h.xy, h.z);
    float over = inversesqrt(dot(m, m)), blur = dot(h, h) * over * over;
    m *= over;
    float cosine = dot(wo, m);
    vec3 wi = 2.0 * cosine * m - wo;
    float towards = max(wi.z, 0.0), weight = unmasked(towards, visibleArea(vec3(wi.xy, towards)));
    if (BECKMANN) {
        float slope = dot(h.xy, h.xy) / (h.z * h.z);
        weight *= look.w * exp(-slope) * (1.0 + slope) * (1.0 + slope);
        blur *= sqrt(look.w);
    }
    add(cosine, wi, weight, level + log2(blur));
}

void main() {
    vec3 world = normalize(eye - vPoint);
    if (SHEET && part == 2) {
        colour = vec4(radiance(-world), 1.0);
        return;
    }
    vec3 n = facing(world);
    vec3 t = normalize(vTangent - dot(vTangent, n) * n);
    mat3 local = mat3(t, cross(n, t), n);
    wo = world * local;
    wo = wo.z < 1e-6 ? normalize(vec3(wo.xy, 1e-6)) : wo;
    float turnSquare = wo.x * wo.x / max(dot(wo.xy, wo.xy), 1e-12);
    vec2 place = vec2(wo.z, TABULATED ? fract(atan(wo.y, wo.x) / TAU) : turnSquare);
    colour = vec4(SHEET && part == 1 ? between(through, place) : between(albedo, place), 1.0);
    if (SHEET && part == 1) return;
    vec3 returned = COMPENSATED ? several * between(losses, vec2(sqrt(wo.z), 0.0)).r : vec3(0.0);
    if (light == 0) {
        colour.rgb += returned;
        return;
    }
    back = mat3(turned(local[0]), turned(local[1]), turned(local[2]));
    viewer = vec3(alpha * wo.xy, wo.z);
    float size = length(viewer);
    viewer /= size;
    area = visibleArea(wo);
    float areaDrawn = TABULATED ? 1.0 : 0.5 * (wo.z + size);
    level = sharpness + 0.5 * log2(areaDrawn);
    ALL_LOOKS
    float scale = areaDrawn / float(LOOKS);
    vec3 rest = colour.rgb - scale * even;
    colour.rgb = scale * sum + rest * mean.rgb / max(mean.a, 1e-12);
    if (COMPENSATED) {
        vec2 texelOf = (1.0 + RETURNED_SIDE * unfolded(back[2])) / (RETURNED_SIDE + 2.0);
        colour.rgb += returned * textureLod(returnedLight, texelOf, 0.0).rgb;
    }
}
