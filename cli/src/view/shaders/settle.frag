// What is added to each sample that has light, so that in even light their mean is exactly that of the table.
uniform highp sampler2DArray strengths;
uniform sampler2D scattered; // albedo times cos θ
uniform int count;
out vec4 rest;

void main() {
    ivec2 view = ivec2(gl_FragCoord.xy);
    vec4 sum = vec4(0.0);
    for (int i = 0; i < count; ++i) sum += texelFetch(strengths, ivec3(view, i), 0);
    vec3 missing = float(count) * texelFetch(scattered, view, 0).rgb - sum.rgb;
    rest = sum.a > 0.0 ? vec4(missing / sum.a, 1.0) : vec4(0.0);
}
