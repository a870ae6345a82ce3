
// A fragment for each line of a list, of two texels: wi with a parameter; then wo with 0, or two numbers for a draw
// with 1.
uniform sampler2D lut;
uniform sampler2D points;
uniform sampler2D facets;
out vec4 colour;
void main() {
    ivec2 place = ivec2(gl_FragCoord.xy) * ivec2(2, 1);
    vec4 from = texelFetch(points, place, 0), to = texelFetch(points, place + ivec2(1, 0), 0);
    if (to.w > 0.5) {
        vec3 wo = goniochrome_sample(facets, from.xyz, to.xy);
        colour = vec4(wo, goniochrome_pdf(facets, from.xyz, wo));
    } else {
        colour = vec4(goniochrome_brdf(lut, facets, from.xyz, to.xyz, from.w), goniochrome_pdf(facets, from.xyz, to.xyz));
    }
}
