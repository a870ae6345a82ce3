// A mirror-like table: L = ρ(θ) E(mirror direction). A sheet lets the share τ(θ) of the light straight through.
uniform sampler2D table, through; // ρ and τ in equal steps of θ from 0 to 90°
uniform int part; // 0 for reflected light, 1 for τ, 2 for the light straight ahead
out vec4 colour;

vec3 at(sampler2D list, float theta) {
    int last = textureSize(list, 0).x - 1;
    float row = theta / (0.5 * PI) * float(last);
    int below = clamp(int(row), 0, last - 1);
    return mix(
        texelFetch(list, ivec2(below, 0), 0).rgb,
        texelFetch(list, ivec2(below + 1, 0), 0).rgb,
        clamp(row - float(below), 0.0, 1.0)
    );
}

void main() {
    vec3 wo = normalize(eye - vPoint);
    vec3 n = facing(wo);
    float cosine = clamp(dot(wo, n), 0.0, 1.0);
    float theta = atan(length(cross(wo, n)), cosine);
    if (part == 2) colour = vec4(radiance(-wo), 1.0);
    else if (part == 1) colour = vec4(at(through, theta), 1.0);
    else colour = vec4(at(table, theta) * radiance(2.0 * cosine * n - wo), 1.0);
}
