// A scattering table. Directions are sampled by the table, f(wo, ·) cos θ, and with probability BY_COSINE by the
// cosine, as in `render`. The light is not sampled, which only costs noise. The atlas holds f, and in its fourth
// channel the probability of each bin.
uniform sampler2D atlas; // by incident direction, then by bin, in lines of 2048
uniform sampler2D cumulative; // per incident direction: its albedo; sums of rows; sums of columns in each row
uniform ivec2 incident, bins; // θ × φ and cos θ × φ
uniform uint sampleIndex;
uniform int draws;
out vec4 colour;

const float BY_COSINE = 0.1;

uvec2 hashed(uvec2 v) { // PCG 2D (Jarzynski and Olano, JCGT 2020)
    v = v * 1664525u + 1013904223u;
    v.x += v.y * 1664525u;
    v.y += v.x * 1664525u;
    v ^= v >> 16u;
    v.x += v.y * 1664525u;
    v.y += v.x * 1664525u;
    return v ^ (v >> 16u);
}

// The last two of the four numbers of Roberts' R4 sequence, of which the first two place the ray in its pixel, shifted
// by numbers of the pixel's own.
vec2 uniformly(uint n) {
    uvec2 shift = hashed(uvec2(gl_FragCoord.xy));
    return vec2(shift + n * uvec2(2700274805u, 2313257605u)) / 4294967296.0;
}

float polar(vec3 w) { return atan(length(w.xy), w.z); }
float azimuth(vec3 w) { return w.x == 0.0 && w.y == 0.0 ? 0.0 : atan(w.y, w.x); }

// The two neighbours of a place, held at the ends, and the weight of the second.
void held(float place, int count, out ivec2 at, out float share) {
    place = clamp(place, 0.0, float(count - 1));
    at.x = min(int(place), max(count - 2, 0));
    share = place - float(at.x);
    at.y = min(at.x + 1, count - 1);
}

// The two neighbours of a place on a circle, and the weight of the second.
void periodic(float turns, int count, out ivec2 at, out float share) {
    float place = fract(turns) * float(count);
    share = fract(place);
    at.x = int(place) % count;
    at.y = (at.x + 1) % count;
}

vec4 texel(sampler2D list, int at) { return texelFetch(list, ivec2(at & 2047, at >> 11), 0); }

struct Nodes { ivec4 index; vec4 weight; };

Nodes product(ivec2 rows, float row, ivec2 columns, float column, int width) {
    return Nodes(
        ivec4(rows.xx * width + columns, rows.yy * width + columns),
        vec4(1.0 - row, 1.0 - row, row, row) * vec4(1.0 - column, column, 1.0 - column, column)
    );
}

Nodes incidentNodes(vec3 w) {
    ivec2 rows, columns;
    float row, column;
    held(polar(w) / (0.5 * PI) * float(incident.x) - 0.5, incident.x, rows, row);
    periodic((azimuth(w) - PI / float(bins.y)) / TAU, incident.y, columns, column);
    return product(rows, row, columns, column, incident.y);
}

Nodes outgoingNodes(vec3 w, float from) {
    ivec2 rows, columns;
    float row, column;
    held(w.z * float(bins.x) - 0.5, bins.x, rows, row);
    periodic((azimuth(w) - from) / TAU, bins.y, columns, column);
    return product(rows, row, columns, column, bins.y);
}

// f in the first three components, the probability of each bin in the fourth, for one incident direction.
vec4 between(int i, Nodes o) {
    vec4 sum = vec4(0.0);
    for (int k = 0; k < 4; ++k) sum += o.weight[k] * texel(atlas, i * bins.x * bins.y + o.index[k]);
    return sum;
}

float memory(int i, int at) { return texel(cumulative, i * (1 + bins.x + bins.x * bins.y) + at).r; }

// Inverts cumulative probabilities: returns the cell that `u` falls into, and sets `u` to the place within the cell.
int invertCdf(int i, int from, int count, inout float u) {
    int low = 0, high = count - 1;
    while (low < high) {
        int middle = (low + high) / 2;
        if (memory(i, from + middle) > u) high = middle; else low = middle + 1;
    }
    float below = low > 0 ? memory(i, from + low - 1) : 0.0;
    float above = memory(i, from + low);
    u = above > below ? clamp((u - below) / (above - below), 0.0, 0.9999999) : 0.5;
    return low;
}

// A number from −1 to 1 whose density is a tent, from a uniform one.
float tent(float u) { return u < 0.5 ? sqrt(2.0 * u) - 1.0 : 1.0 - sqrt(2.0 - 2.0 * u); }

// A number whose density is a tent, but flat beyond the first or the last row, where it ends after half a step.
float heldTent(float u, bool first, bool last) {
    if (first && last) return u - 0.5;
    if (first) return u < 0.5 ? u - 0.5 : 1.0 - sqrt(max(2.0 - 2.0 * u, 0.0));
    if (last) return u > 0.5 ? u - 0.5 : sqrt(2.0 * u) - 1.0;
    return tent(u);
}

vec3 fromTable(vec3 wo, Nodes mixture, vec2 u) {
    int chosen = mixture.index[3];
    float from = 0.0;
    for (int k = 0; k < 4; ++k) {
        if (mixture.weight[k] <= 0.0) continue; // rounding must not choose a direction that reflects nothing
        chosen = mixture.index[k];
        if (u.x < from + mixture.weight[k]) {
            u.x = clamp((u.x - from) / mixture.weight[k], 0.0, 0.9999999);
            break;
        }
        from += mixture.weight[k];
    }
    int row = invertCdf(chosen, 1, bins.x, u.x);
    int column = invertCdf(chosen, 1 + bins.x + row * bins.y, bins.y, u.y);
    float c = clamp((float(row) + 0.5 + heldTent(u.x, row == 0, row + 1 == bins.x)) / float(bins.x), 1e-6, 1.0);
    float phi = azimuth(wo) + TAU * (float(column) + tent(u.y)) / float(bins.y);
    return vec3(sqrt(max(1.0 - c * c, 0.0)) * vec2(cos(phi), sin(phi)), c);
}

void main() {
    vec3 world = normalize(eye - vPoint);
    vec3 n = facing(world);
    vec3 t = normalize(vTangent - dot(vTangent, n) * n);
    mat3 local = mat3(t, cross(n, t), n);
    vec3 wo = world * local;
    wo = wo.z < 1e-6 ? normalize(vec3(wo.xy, 1e-6)) : wo;

    Nodes mixture = incidentNodes(wo);
    vec4 reflected;
    for (int k = 0; k < 4; ++k) reflected[k] = mixture.weight[k] * memory(mixture.index[k], 0);
    float whole = reflected.x + reflected.y + reflected.z + reflected.w;
    if (whole > 0.0) mixture.weight = reflected / whole;

    float perBin = float(bins.x * bins.y) / TAU;
    vec3 sum = vec3(0.0);
    for (int draw = 0; draw < draws; ++draw) {
        uint number = sampleIndex * uint(draws) + uint(draw);
        vec2 u = uniformly(number);
        vec3 wi;
        // The first number chooses; its remainder is uniform again.
        bool byCosine = u.x < BY_COSINE;
        u.x = byCosine ? u.x / BY_COSINE : (u.x - BY_COSINE) / (1.0 - BY_COSINE);
        if (byCosine) {
            wi = vec3(sqrt(u.x) * vec2(cos(TAU * u.y), sin(TAU * u.y)), sqrt(max(1.0 - u.x, 1e-12)));
        } else {
            wi = fromTable(wo, mixture, u);
        }
        Nodes back = outgoingNodes(wi, azimuth(wo));
        float density = 0.0;
        for (int k = 0; k < 4; ++k) density += mixture.weight[k] * between(mixture.index[k], back).a;
        density = BY_COSINE * wi.z / PI + (1.0 - BY_COSINE) * density * perBin;

        Nodes there = incidentNodes(wi);
        Nodes here = outgoingNodes(wo, azimuth(wi));
        vec3 f = vec3(0.0);
        for (int k = 0; k < 4; ++k) f += there.weight[k] * between(there.index[k], here).rgb;
        sum += f * (wi.z / density) * radiance(local * wi);
    }
    colour = vec4(sum / float(draws), 1.0);
}
