
// A fragment for each line of a list, of two texels: wi with a parameter; then wo with 0, or two numbers for a draw
// with 1.
uniform sampler2D lut;
uniform sampler2D points;
/*uniform sampler2D facets;
*/uniform sampler2D compensation;
out vec4 colour;
void main() {
    ivec2 place = ivec2(gl_FragCoord.xy) * ivec2(2, 1);
    vec4 from = texelFetch(points, place, 0), to = texelFetch(points, place + ivec2(1, 0), 0);
    if (to.w > 0.5) {
        vec3 wo = goniochrome_compensated_sample(/*facets, */compensation, from.xyz, to.xy);
        colour = vec4(wo, goniochrome_compensated_pdf(/*facets, */compensation, from.xyz, wo));
    } else {
        vec3 f = goniochrome_compensated_brdf(lut, /*facets, */compensation, from.xyz, to.xyz, from.w);
        colour = vec4(f, goniochrome_compensated_pdf(/*facets, */compensation, from.xyz, to.xyz));
    }
}
