// The normal that the viewer sees: it points to the viewer's side of a sheet, and never away from the viewer.
in vec3 vPoint, vNormal, vTangent;
uniform vec3 eye;

vec3 facing(vec3 wo) {
    vec3 n = normalize(vNormal) * (gl_FrontFacing ? 1.0 : -1.0);
    float c = dot(n, wo);
    return c < 0.0 ? normalize(n - c * wo) : n;
}
