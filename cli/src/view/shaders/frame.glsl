// The frame that the viewer sees: behind a sheet n turns over; n stays at least at right angles to the viewer.
in vec3 vPoint, vNormal, vTangent;
uniform vec3 eye;

vec3 facing(vec3 wo) {
    vec3 n = normalize(vNormal) * (gl_FrontFacing ? 1.0 : -1.0);
    float c = dot(n, wo);
    return c < 0.0 ? normalize(n - c * wo) : n;
}
