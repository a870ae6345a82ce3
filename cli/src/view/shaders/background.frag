// Draws the surroundings behind the body.
in vec2 place;
uniform vec3 right, up, backward;
uniform vec2 scale, jitter;
out vec4 colour;

void main() {
    vec2 across = (place - jitter) / scale;
    colour = vec4(radiance(normalize(across.x * right + across.y * up - backward)), 1.0);
}
