// Adds the latest picture to the sum of those before.
uniform sampler2D sum, latest;
out vec4 colour;

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    colour = texelFetch(sum, at, 0) + texelFetch(latest, at, 0);
}
