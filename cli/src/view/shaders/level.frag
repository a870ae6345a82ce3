// Draws one level of the light: the finest by means over texels, each other one as the level before it with blur.
uniform float level, blur; // blur: standard deviation in radians
out vec4 colour;

const int FINE = 2; // parts of a texel along each side
const int COUNT = 64; // directions of a blur
const float GOLDEN_ANGLE = 2.39996323;

void main() {
    float size = side * exp2(-level);
    vec3 sum = vec3(0.0);
    if (level == 0.0) {
        for (int i = 0; i < FINE * FINE; ++i) {
            vec2 within = (vec2(i / FINE, i % FINE) + 0.5) / float(FINE) - 0.5;
            sum += radiance(folded(2.0 * (gl_FragCoord.xy - 1.0 + within) / size - 1.0));
        }
        colour = vec4(sum / float(FINE * FINE), 1.0);
        return;
    }
    vec3 d = folded(2.0 * (gl_FragCoord.xy - 1.0) / size - 1.0);
    vec3 t = normalize(abs(d.z) < 0.7 ? vec3(-d.y, d.x, 0.0) : vec3(0.0, -d.z, d.y)), b = cross(d, t);
    for (int i = 0; i < COUNT; ++i) {
        float angle = blur * sqrt(-2.0 * log(1.0 - (float(i) + 0.5) / float(COUNT))), azimuth = GOLDEN_ANGLE * float(i);
        vec3 from = cos(angle) * d + sin(angle) * (cos(azimuth) * t + sin(azimuth) * b);
        sum += seenIn(level - 1.0, 2.0 * size, unfolded(from));
    }
    colour = vec4(sum / float(COUNT), 1.0);
}
