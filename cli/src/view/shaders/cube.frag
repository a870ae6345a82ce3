// The light, before it is turned, on a face of a cube map.
uniform int face;
uniform float side;
out vec4 colour;

void main() {
    vec2 at = 2.0 * gl_FragCoord.xy / side - 1.0;
    vec3 d = vec3(1.0, -at.y, -at.x);
    if (face == 1) d = vec3(-1.0, -at.y, at.x);
    if (face == 2) d = vec3(at.x, 1.0, at.y);
    if (face == 3) d = vec3(at.x, -1.0, -at.y);
    if (face == 4) d = vec3(at.x, -at.y, 1.0);
    if (face == 5) d = vec3(-at.x, -at.y, -1.0);
    colour = vec4(radiance(normalize(d)), 1.0);
}
