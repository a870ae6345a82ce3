#version 300 es
// A mesh in the unit sphere, seen by a pinhole; `jitter` moves the picture by parts of a pixel, in clip space.
in vec3 position;
in vec3 normal;
in vec3 tangent;
in float share; // of the way from the first thickness of a film to the last
uniform vec3 eye, right, up, backward;
uniform vec2 scale, jitter, depths;
out vec3 vPoint, vNormal, vTangent;
out float vShare;

void main() {
    vec3 along = position - eye;
    float depth = -dot(along, backward);
    gl_Position = vec4(
        vec2(dot(along, right), dot(along, up)) * scale + jitter * depth,
        (depth * (depths.y + depths.x) - 2.0 * depths.y * depths.x) / (depths.y - depths.x),
        depth
    );
    vPoint = position;
    vNormal = normal;
    vTangent = tangent;
    vShare = share;
}
