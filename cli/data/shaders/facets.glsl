// A rough surface of that film: facets of a tabulated distribution of normals, which hide one another by Smith's model.
// Directions are unit vectors in the surface's frame, x along the tangent, y along the binormal, z along the normal,
// and leave the surface. Light that meets a second facet is left out.
//
// `facets` is the texture of --facets: the numbers of the distribution, one after the other, 256 in a row. Upload it as
// 32-bit floats in the file's order. Its texels are fetched, and need no filter.

const float GONIOCHROME_PI = 3.14159265358979;
// Numbers in a row of densities, and in one of the squared roughnesses that directions see.
const int GONIOCHROME_RING = GONIOCHROME_SECTORS == 1 ? 1 : GONIOCHROME_SECTORS + 1;
const int GONIOCHROME_VIEW = GONIOCHROME_SECTORS == 1 ? 1 : GONIOCHROME_SECTORS + 3;
// Where the squared roughnesses begin, the probabilities within rings, and the integrals over sectors.
const int GONIOCHROME_SEEN = (GONIOCHROME_RINGS + 1) * GONIOCHROME_RING;
const int GONIOCHROME_WITHIN = GONIOCHROME_SEEN + 257 * GONIOCHROME_VIEW;
const int GONIOCHROME_TURNED = GONIOCHROME_WITHIN + GONIOCHROME_RINGS + 1;

float goniochrome_number(sampler2D facets, int place) {
    return texelFetch(facets, ivec2(place % 256, place / 256), 0).r;
}

// Number between two places.
float goniochrome_between(sampler2D facets, int low, int high, float part) {
    return mix(goniochrome_number(facets, low), goniochrome_number(facets, high), part);
}

// Sector of an azimuth, and the part of it that is passed.
vec2 goniochrome_sector(vec2 w) {
    float turn = dot(w, w) > 0.0 ? atan(w.y, w.x) / (2.0 * GONIOCHROME_PI) : 0.0;
    float at = (turn < 0.0 ? turn + 1.0 : turn) * float(GONIOCHROME_SECTORS);
    float before = min(floor(at), float(GONIOCHROME_SECTORS - 1));
    return vec2(before, at - before);
}

// Density of the facets' normals per solid angle and area, along a vector above the horizon.
float goniochrome_density(sampler2D facets, vec3 m) {
    float t = min(dot(m.xy, m.xy) / dot(m, m), 1.0), rings = float(GONIOCHROME_RINGS);
    float k = min(floor(sqrt(sqrt(t)) * rings), rings - 1.0), square = k * k;
    float apart = (2.0 * k + 1.0) * (2.0 * (square + k) + 1.0);
    float part = clamp((t * rings * rings * rings * rings - square * square) / apart, 0.0, 1.0);
    int inner = int(k) * GONIOCHROME_RING, outer = inner + GONIOCHROME_RING;
    float density = goniochrome_between(facets, inner, outer, part);
    if (GONIOCHROME_SECTORS > 1) {
        vec2 sector = goniochrome_sector(m.xy);
        int j = int(sector.x);
        float here = goniochrome_between(facets, inner + j, outer + j, part);
        density = mix(here, goniochrome_between(facets, inner + j + 1, outer + j + 1, part), sector.y);
    }
    return density;
}

// Area of the facets that a direction sees, cos θ/G1.
float goniochrome_visible_area(sampler2D facets, vec3 w) {
    float at = sqrt(clamp(w.z, 0.0, 1.0)) * 256.0, row = min(floor(at), 255.0), part = at - row;
    int low = GONIOCHROME_SEEN + int(row) * GONIOCHROME_VIEW, high = low + GONIOCHROME_VIEW;
    float e = goniochrome_between(facets, low, high, part);
    if (GONIOCHROME_SECTORS > 1) {
        vec2 sector = goniochrome_sector(w.xy);
        low += int(sector.x);
        high += int(sector.x);
        // Catmull and Rom's weights.
        float x = sector.y, xx = x * x, xxx = xx * x;
        e = (xx - 0.5 * (xxx + x)) * goniochrome_between(facets, low, high, part)
            + (1.5 * xxx - 2.5 * xx + 1.0) * goniochrome_between(facets, low + 1, high + 1, part)
            + (2.0 * xx - 1.5 * xxx + 0.5 * x) * goniochrome_between(facets, low + 2, high + 2, part)
            + 0.5 * (xxx - xx) * goniochrome_between(facets, low + 3, high + 3, part);
    }
    float square = w.z * w.z;
    return 0.5 * (w.z + sqrt(max(square + e * (1.0 - square), 0.25 * square)));
}

// BRDF in 1/sr, without the cosine: linear RGB.
vec3 goniochrome_brdf(sampler2D lut, sampler2D facets, vec3 wi, vec3 wo, float parameter) {
    if (min(wi.z, wo.z) <= 1e-6) {
        return vec3(0.0);
    }
    float area_i = goniochrome_visible_area(facets, wi), area_o = goniochrome_visible_area(facets, wo);
    float seen = GONIOCHROME_SEPARABLE ? area_i * area_o : area_i * wo.z + area_o * wi.z - wi.z * wo.z;
    vec3 rho = goniochrome_reflectance(lut, 0.5 * length(wi + wo), parameter);
    return rho * (0.25 * goniochrome_density(facets, wi + wo) / seen);
}

// Density per solid angle with which goniochrome_sample draws wo for wi.
float goniochrome_pdf(sampler2D facets, vec3 wi, vec3 wo) {
    if (min(wi.z, wo.z) <= 1e-6) {
        return 0.0;
    }
    vec3 m = wi + wo;
    float density = goniochrome_density(facets, m);
    // Of a normal that wi does not see, the one is taken that is turned by half a turn.
    if (dot(wi.xy, m.xy) > wi.z * m.z) {
        density += goniochrome_density(facets, vec3(-m.xy, m.z));
    }
    return 0.5 * density * m.z / dot(m, m);
}

// Place in [0, 1] up to which a density that is linear from a to b holds a part u of all.
float goniochrome_root(float a, float b, float u) {
    float part = clamp(u, 0.0, 1.0), divisor = a + sqrt(max(mix(a * a, b * b, part), 0.0));
    return divisor > 0.0 ? min((a + b) * part / divisor, 1.0) : part;
}

// Draws wo for wi by u in [0, 1)²; its z is not positive for a draw without light, which counts. The weight of a draw
// is goniochrome_brdf · wo.z / goniochrome_pdf.
vec3 goniochrome_sample(sampler2D facets, vec3 wi, vec2 u) {
    const int last = GONIOCHROME_SECTORS - 1;
    // The first ring, and the first sector, whose end lies beyond.
    int k = 0, count = GONIOCHROME_RINGS;
    while (count > 0) {
        int middle = count / 2;
        bool beyond = goniochrome_number(facets, GONIOCHROME_WITHIN + k + middle + 1) > u.x;
        k = beyond ? k : k + middle + 1;
        count = beyond ? middle : count - middle - 1;
    }
    k = min(k, GONIOCHROME_RINGS - 1);
    float low = goniochrome_number(facets, GONIOCHROME_WITHIN + k);
    float high = goniochrome_number(facets, GONIOCHROME_WITHIN + k + 1);
    int inner = GONIOCHROME_TURNED + k * GONIOCHROME_SECTORS, outer = inner + GONIOCHROME_SECTORS;
    float within = (u.x - low) / max(high - low, 1e-30);
    float part = goniochrome_root(
        goniochrome_number(facets, inner + last), goniochrome_number(facets, outer + last), within);
    vec2 radii = vec2(float(k), float(k + 1)) / float(GONIOCHROME_RINGS), squares = radii * radii;
    float t = mix(squares.x * squares.x, squares.y * squares.y, part);
    float wanted = u.y * goniochrome_between(facets, inner + last, outer + last, part);
    int j = 0;
    count = last;
    while (count > 0) {
        int middle = count / 2;
        bool beyond = goniochrome_between(facets, inner + j + middle, outer + j + middle, part) > wanted;
        j = beyond ? j : j + middle + 1;
        count = beyond ? middle : count - middle - 1;
    }
    float passed = j > 0 ? goniochrome_between(facets, inner + j - 1, outer + j - 1, part) : 0.0;
    float ahead = goniochrome_between(facets, inner + j, outer + j, part) - passed;
    int from = k * GONIOCHROME_RING + j, to = GONIOCHROME_SECTORS > 1 ? from + 1 : from;
    float a = goniochrome_between(facets, from, from + GONIOCHROME_RING, part);
    float b = goniochrome_between(facets, to, to + GONIOCHROME_RING, part);
    float turned = float(j) + goniochrome_root(a, b, (wanted - passed) / max(ahead, 1e-30));
    float phi = 2.0 * GONIOCHROME_PI * turned / float(GONIOCHROME_SECTORS);
    vec3 m = vec3(sqrt(t) * vec2(cos(phi), sin(phi)), sqrt(max(1.0 - t, 0.0)));
    m.xy = dot(wi, m) < 0.0 ? -m.xy : m.xy;
    return normalize(2.0 * dot(wi, m) * m - wi);
}
