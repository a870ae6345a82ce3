
// A fragment for each point of a list.
uniform sampler2D lut;
uniform sampler2D points;
out vec4 colour;
void main() {
    vec2 point = texelFetch(points, ivec2(gl_FragCoord.xy), 0).xy;
    colour = vec4(goniochrome_reflectance(lut, point.x, point.y), 1.0);
}
