// A sample of a scatter table for each direction of the viewer. Each sample is a half vector, drawn by the table.
//
// The density over the warped square is that of the library's sampler: bilinear between nodes, and linear between
// incident directions. The inverse of its integral moves half vectors steadily with the viewer, so that all pixels can
// share the samples: along y by the marginal density, then along x.
uniform sampler2D atlas; // s, and the density, by incident direction, then by place; in lines of 2048
uniform sampler2D sums; // per incident direction: integrals of the density along y; then along x, for each row
uniform sampler2D knots; // density and integral of the warp, over u in the first row, over v in the second
uniform ivec2 incident, nodes, views, intervals;
uniform int places, count; // values of each incident direction; number of samples
uniform vec2 u; // place of this sample in the unit square
layout(location = 0) out vec4 look; // half vector, without z; logarithm to base 2 of the side of its light
layout(location = 1) out vec4 strength; // RGB of radiance 1 from there, times cos θ; whether there is light

int near[4];
float near_weight[4];

vec4 texel(sampler2D list, int at) { return texelFetch(list, ivec2(at & 2047, at >> 11), 0); }

// Integral along y up to a row, and along x up to a node of a row.
float alongY(int row) {
    float sum = 0.0;
    int stride = (nodes.y + 1) + nodes.x * nodes.y;
    for (int k = 0; k < 4; ++k) sum += near_weight[k] * texel(sums, near[k] * stride + row).r;
    return sum;
}

float alongX(int row, int column) {
    float sum = 0.0;
    int stride = (nodes.y + 1) + nodes.x * nodes.y;
    int at = nodes.y + 1 + (row % nodes.y) * nodes.x + column;
    for (int k = 0; k < 4; ++k) sum += near_weight[k] * texel(sums, near[k] * stride + at).r;
    return sum;
}

vec4 value(int row, int column) {
    vec4 sum = vec4(0.0);
    for (int k = 0; k < 4; ++k) sum += near_weight[k] * texel(atlas, near[k] * places + (row % nodes.y) * nodes.x + column);
    return sum;
}

// The part of an interval at which the integral of a density, linear from `a` to `b`, is `rest`.
float part(float a, float b, float rest) {
    float root = sqrt(max(a * a + 2.0 * rest * (b - a), 0.0));
    return a + root > 0.0 ? clamp(2.0 * rest / (a + root), 0.0, 1.0) : 0.0;
}

// u of x (`axis` 0) or v of y (1), and the density of the warp there.
vec2 plain(int axis, float place) {
    int low = 0, high = intervals[axis] - 1;
    while (low < high) {
        int middle = (low + high) / 2;
        if (texelFetch(knots, ivec2(middle + 1, axis), 0).g <= place) low = middle + 1; else high = middle;
    }
    vec2 from = texelFetch(knots, ivec2(low, axis), 0).rg;
    float to = texelFetch(knots, ivec2(low + 1, axis), 0).r;
    float within = part(from.r, to, (place - from.g) * float(intervals[axis]));
    return vec2((float(low) + within) / float(intervals[axis]), mix(from.r, to, within));
}

void main() {
    look = vec4(0.0);
    strength = vec4(0.0);
    ivec2 view = ivec2(gl_FragCoord.xy);
    // The viewer, between incident directions.
    float row = float(view.y * (incident.x - 1)) / float(views.x - 1);
    float column = float(view.x * incident.y) / float(views.y);
    ivec2 lower = ivec2(min(int(row), incident.x - 2), int(column));
    vec2 share = vec2(row, column) - vec2(lower);
    for (int k = 0; k < 4; ++k) {
        ivec2 upper = ivec2(k >> 1, k & 1);
        near[k] = (lower.x + upper.x) * incident.y + (lower.y + upper.y) % incident.y;
        vec2 weight = mix(1.0 - share, share, vec2(upper));
        near_weight[k] = weight.x * weight.y;
    }
    float theta = THETA_MAX * float(view.y) / float(views.x - 1);
    float phi = views.y == 1 ? 0.0 : TAU * float(view.x) / float(views.y) - PI;
    vec3 wo = vec3(sin(theta) * vec2(cos(phi), sin(phi)), cos(theta));

    float whole = alongY(nodes.y);
    if (!(whole > 0.0)) return;
    int low = 0, high = nodes.y - 1;
    while (low < high) {
        int middle = (low + high) / 2;
        if (alongY(middle + 1) <= u.y * whole) low = middle + 1; else high = middle;
    }
    int line = low, last = nodes.x - 1;
    float t = part(alongX(line, last), alongX(line + 1, last), (u.y * whole - alongY(line)) * float(nodes.y));
    float wanted = u.x * mix(alongX(line, last), alongX(line + 1, last), t);
    low = 0;
    high = last - 1;
    while (low < high) {
        int middle = (low + high) / 2;
        if (mix(alongX(line, middle + 1), alongX(line + 1, middle + 1), t) <= wanted) low = middle + 1; else high = middle;
    }
    vec4 left = mix(value(line, low), value(line + 1, low), t);
    vec4 right = mix(value(line, low + 1), value(line + 1, low + 1), t);
    float before = mix(alongX(line, low), alongX(line + 1, low), t);
    float s = part(left.a, right.a, (wanted - before) * float(last));
    vec4 here = mix(left, right, s);
    float density = here.a / whole;

    vec2 x = plain(0, (float(low) + s) / float(last)), y = plain(1, (float(line) + t) / float(nodes.y));
    float polar = 0.5 * PI * x.x * x.x, azimuth = TAU * y.x - PI;
    vec3 m = vec3(sin(polar) * vec2(cos(azimuth), sin(azimuth)), cos(polar));
    float cosine = dot(wo, m);
    // |dω/(dx dy)|
    float area = 8.0 * PI * PI * x.x * sin(polar) * cosine / (x.y * y.y);
    look.xy = m.xy;
    look.z = 0.5 * log2(max(area / (density * float(count)), 1e-12));
    bool lit = 2.0 * cosine * m.z > wo.z && area > 0.0 && density > 0.0;
    if (lit) strength = vec4(here.rgb * (area / density), 1.0);
}
