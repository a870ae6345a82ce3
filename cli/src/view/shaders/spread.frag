// Convolves a lat-long grid with exp((cos γ − 1)/σ²) on the sphere, as `render` does.
uniform sampler2D baked;
uniform float concentration; // 1/σ²
out vec4 colour;

const float LAST_EXPONENT = 10.0;

void main() {
    ivec2 size = textureSize(baked, 0), at = ivec2(gl_FragCoord.xy);
    float theta = PI * (float(at.y) + 0.5) / float(size.y);
    vec4 sum = vec4(0.0);
    for (int y = 0; y < size.y; ++y) {
        float from = PI * (float(y) + 0.5) / float(size.y);
        // 1 − cos x = 2 sin² (x/2), without cancellation.
        float halved = sin(0.5 * (theta - from));
        float across = 2.0 * concentration * halved * halved;
        if (across > LAST_EXPONENT) continue;
        float area = sin(from);
        float along = 2.0 * concentration * sin(theta) * area;
        for (int step = 0; step <= size.x / 2; ++step) {
            float turn = sin(PI * float(step) / float(size.x));
            float exponent = across + along * turn * turn;
            if (exponent > LAST_EXPONENT) break;
            float weight = area * exp(-exponent) * (step == 0 || 2 * step == size.x ? 0.5 : 1.0);
            vec3 left = texelFetch(baked, ivec2((at.x + size.x - step) % size.x, y), 0).rgb;
            vec3 right = texelFetch(baked, ivec2((at.x + step) % size.x, y), 0).rgb;
            sum += weight * vec4(left + right, 2.0);
        }
    }
    colour = vec4(sum.rgb / sum.a, 1.0);
}
