// The light, before it is turned, on a lat-long grid: means over cells.
uniform vec2 cells; // columns and rows
uniform int fine; // parts of a cell along each side
out vec4 colour;

void main() {
    float texel = PI / cells.y;
    vec4 sum = vec4(0.0);
    bool even = light == 3 && distance(directionOf(gl_FragCoord.xy / cells), lampTowards) > lamp.x * (1.0 + lamp.y) + texel;
    int count = even ? 1 : fine;
    for (int j = 0; j < count; ++j) {
        for (int i = 0; i < count; ++i) {
            vec2 within = (vec2(i, j) + 0.5) / float(count) - 0.5;
            vec3 d = directionOf((gl_FragCoord.xy + within) / cells);
            sum += length(d.xy) * vec4(radiance(d), 1.0);
        }
    }
    colour = vec4(sum.rgb / sum.a, 1.0);
}
