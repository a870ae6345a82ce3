// Draws the light that facets around each normal lose, on an octahedron with a border of one texel: its mean, weighted
// by what a direction loses and by its cosine. In light of radiance 1 it is 1.
uniform sampler2D losses; // over √cos θ
out vec4 colour;

void main() {
    vec3 n = folded(2.0 * (gl_FragCoord.xy - 1.0) / RETURNED_SIDE - 1.0);
    float steps = float(textureSize(losses, 0).x - 1), level = log2(side / SEEN_SIDE);
    vec4 sum = vec4(0.0);
    for (float y = 0.5; y < SEEN_SIDE; y += 1.0) {
        for (float x = 0.5; x < SEEN_SIDE; x += 1.0) {
            vec2 place = vec2(x, y) / SEEN_SIDE;
            vec3 d = folded(2.0 * place - 1.0);
            float cosine = dot(n, d);
            if (cosine <= 0.0) continue;
            float lost = textureLod(losses, vec2((0.5 + sqrt(cosine) * steps) / (steps + 1.0), 0.5), 0.0).r;
            // A texel's solid angle grows with the cube of |x| + |y| + |z|.
            float across = abs(d.x) + abs(d.y) + abs(d.z);
            sum += cosine * lost * across * across * across * vec4(seenIn(level, SEEN_SIDE, place), 1.0);
        }
    }
    colour = vec4(sum.rgb / max(sum.a, 1e-20), 1.0);
}
