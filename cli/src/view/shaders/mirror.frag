// A mirror-like table: L = ρ(θ) E(mirror direction). A sheet lets the share τ(θ) of the light straight through.
uniform sampler2D table, through; // ρ and τ in equal steps of θ from 0 to 90°, a row for each thickness
uniform float layer; // thickness, or what is added to that of the vertices, in parts of the range of rows
uniform int part; // 0 for reflected light, 1 for τ, 2 for the light straight ahead
in float vShare;
out vec4 colour;

vec3 at(sampler2D list, float theta) {
    ivec2 last = textureSize(list, 0) - 1;
    vec2 place = vec2(theta / (0.5 * PI), clamp(vShare + layer, 0.0, 1.0)) * vec2(last);
    ivec2 below = clamp(ivec2(place), ivec2(0), max(last - 1, 0)), above = min(below + 1, last);
    vec2 weight = clamp(place - vec2(below), 0.0, 1.0);
    return mix(
        mix(texelFetch(list, below, 0).rgb, texelFetch(list, ivec2(above.x, below.y), 0).rgb, weight.x),
        mix(texelFetch(list, ivec2(below.x, above.y), 0).rgb, texelFetch(list, above, 0).rgb, weight.x),
        weight.y
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
