
// A fragment for each point of a list, in a frame turned by 45° around the binormal.
uniform sampler2D strengths;
uniform sampler2D points;
out vec4 colour;
vec3 goniochrome_environment(vec3 d, float width) {
    return vec3(1.0 + d.x, 1.0 + d.y * d.z, 1.0 + 0.5 * d.z * d.z) / (1.0 + width);
}
void main() {
    vec3 tangent = vec3(sqrt(0.5), 0.0, sqrt(0.5)), binormal = vec3(0.0, 1.0, 0.0);
    vec3 normal = vec3(-sqrt(0.5), 0.0, sqrt(0.5));
    vec2 t = 2.0 * texelFetch(points, ivec2(gl_FragCoord.xy), 0).xy - 1.0;
    float up_squared = 1.0 - dot(t, t);
    vec3 wo = up_squared > 0.0 ? vec3(t, sqrt(up_squared)) : normalize(vec3(t, -1.0));
    wo = wo.x * tangent + wo.y * binormal + wo.z * normal;
    colour = vec4(goniochrome_orders(strengths, tangent, binormal, normal, wo), 1.0);
}
