// The light, before it is turned, on a face of a cube: means over cells.
uniform float side;
uniform mat3 face; // right, up, towards
out vec4 colour;

const int FINE = 2; // parts of a cell along each side

void main() {
    vec3 sum = vec3(0.0);
    for (int i = 0; i < FINE * FINE; ++i) {
        vec2 within = (vec2(i / FINE, i % FINE) + 0.5) / float(FINE) - 0.5;
        sum += radiance(normalize(face * vec3(2.0 * (gl_FragCoord.xy + within) / side - 1.0, 1.0)));
    }
    colour = vec4(sum / float(FINE * FINE), 1.0);
}
