// The light, before it is turned, on an octahedron that is unfolded to a square.
uniform float side;
out vec4 colour;

void main() {
    vec2 at = 2.0 * gl_FragCoord.xy / side - 1.0;
    float up = 1.0 - abs(at.x) - abs(at.y);
    // The corners are the lower half, folded outwards.
    vec2 aside = up < 0.0 ? (1.0 - abs(at.yx)) * vec2(at.x < 0.0 ? -1.0 : 1.0, at.y < 0.0 ? -1.0 : 1.0) : at;
    colour = vec4(radiance(normalize(vec3(aside, up))), 1.0);
}
