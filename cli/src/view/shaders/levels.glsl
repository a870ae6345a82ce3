// The light before it is turned, at levels of growing blur, each half as large as the one before: octahedra that are
// unfolded to squares, with a border of one texel, one above the other.
uniform highp sampler2D levels;
uniform float side, last; // texels along the finest level without its border; number of the coarsest level
uniform vec2 texel; // over the whole texture

// The place of a direction in the unit square. The square's corners are the lower half, folded outwards.
vec2 unfolded(vec3 d) {
    d /= abs(d.x) + abs(d.y) + abs(d.z);
    vec2 folded = vec2(d.x < 0.0 ? -1.0 : 1.0, d.y < 0.0 ? -1.0 : 1.0) * (1.0 - abs(d.yx));
    return 0.5 + 0.5 * (d.z < 0.0 ? folded : d.xy);
}

// The direction of a place from −1 to 1. Beyond an edge the square goes on as the octahedron does: mirrored.
vec3 folded(vec2 at) {
    if (abs(at.x) > 1.0) at = vec2(sign(at.x) * 2.0 - at.x, -at.y);
    if (abs(at.y) > 1.0) at = vec2(-at.x, sign(at.y) * 2.0 - at.y);
    float up = 1.0 - abs(at.x) - abs(at.y);
    vec2 aside = up < 0.0 ? (1.0 - abs(at.yx)) * vec2(at.x < 0.0 ? -1.0 : 1.0, at.y < 0.0 ? -1.0 : 1.0) : at;
    return normalize(vec3(aside, up));
}

// Lower corner of a level without its border.
vec2 cornerOf(float level, float size) { return vec2(1.0, 2.0 * (side - size + level) + 1.0); }

vec3 seenIn(float level, float size, vec2 place) {
    return textureLod(levels, (cornerOf(level, size) + size * place) * texel, 0.0).rgb;
}

// Light from a direction, between two levels.
vec3 seen(vec3 d, float level) {
    float at = clamp(level, 0.0, last), lower = min(floor(at), last - 1.0), size = side * exp2(-lower);
    vec2 place = unfolded(d);
    return mix(seenIn(lower, size, place), seenIn(lower + 1.0, 0.5 * size, place), at - lower);
}
