// Encodes scene-linear radiance for the screen: colours out of gamut are mixed with the grey of their luminance, then
// scaled.
uniform sampler2D sum;
uniform float factor, samples;
out vec4 colour;

void main() {
    vec4 total = texelFetch(sum, ivec2(gl_FragCoord.xy), 0);
    vec3 rgb = total.a > 0.0 ? total.rgb / total.a * factor : vec3(0.0);
    float coverage = clamp(total.a / samples, 0.0, 1.0);
    colour = vec4(0.0, 0.0, 0.0, coverage);
    float luminance = dot(rgb, vec3(0.2126, 0.7152, 0.0722));
    if (!(luminance > 0.0)) return;
    float smallest = min(rgb.r, min(rgb.g, rgb.b));
    float saturation = smallest < 0.0 ? luminance / (luminance - smallest) : 1.0;
    rgb = max(luminance + saturation * (rgb - luminance), 0.0);
    rgb /= max(1.0, max(rgb.r, max(rgb.g, rgb.b)));
    vec3 encoded = mix(1.055 * pow(rgb, vec3(1.0 / 2.4)) - 0.055, 12.92 * rgb, vec3(lessThanEqual(rgb, vec3(0.0031308))));
    colour = vec4(encoded * coverage, coverage);
}
