// A mirror-like table: L = ρ(θ) E(mirror direction).
uniform sampler2D table; // ρ in equal steps of θ from 0 to 90°
out vec4 colour;

void main() {
    vec3 wo = normalize(eye - vPoint);
    vec3 n = facing(wo);
    float cosine = clamp(dot(wo, n), 0.0, 1.0);
    int last = textureSize(table, 0).x - 1;
    float row = atan(length(cross(wo, n)), cosine) / (0.5 * PI) * float(last);
    int below = clamp(int(row), 0, last - 1);
    vec3 rho = mix(
        texelFetch(table, ivec2(below, 0), 0).rgb,
        texelFetch(table, ivec2(below + 1, 0), 0).rgb,
        clamp(row - float(below), 0.0, 1.0)
    );
    colour = vec4(rho * radiance(2.0 * cosine * n - wo), 1.0);
}
