// Diffraction orders.
//
// In even light a surface has the colour of `albedo`. Order (0, 0) leaves in one direction and has the colour of
// `mirrored`. For the others, a picture looks into the light at `lookCount` wavelengths along exact directions; later
// pictures look between them, so that their mean is the integral. The wavelengths at which an order meets the lamp
// follow from the grating equation; there, every picture integrates. Other lights are held by an
// octahedron, unfolded to a square, which is faster to look up than a sphere or a cube.
const int MAX_LOOKS = 16;
const int MAX_BLOCKS = 32;
const int LAMP_LOOKS = 24;
uniform sampler3D strengths; // four orders a texel, over α, β in a block for each four orders, and wavelengths
uniform sampler2D albedo, mirrored; // over α and β
uniform sampler2D response; // over the wavelength in the medium: RGB of a reflectance of 1, per nanometre; layer
uniform sampler2D around;
uniform vec4 looks[MAX_LOOKS]; // RGB of a reflectance of 1; wavelength in the medium above
uniform float layers[MAX_LOOKS]; // the wavelength's place among the layers of `strengths`
uniform vec4 stepsX[MAX_BLOCKS], stepsY[MAX_BLOCKS]; // m/Λx and n/Λy
uniform int lookCount, blocks, lines; // lines along y (1), along x (2), or none (0)
uniform vec2 nodes; // along α and β
uniform vec2 range; // first and last wavelength in the medium above
uniform float interval; // between wavelengths that are looked at, in the medium above
out vec4 colour;

// The place of a unit vector among nodes, from 0 to 1; then among as many texels, or those of a block.
vec2 placeAmongNodes(vec3 wo) {
    vec2 along = lines == 2 ? wo.yx : wo.xy;
    vec2 angle = vec2(atan(along.x, length(vec2(along.y, wo.z))), atan(along.y, wo.z)) / THETA_MAX;
    return clamp(vec2(0.5 * (angle.x + 1.0), lines == 0 ? 0.5 * (angle.y + 1.0) : abs(angle.y)), 0.0, 1.0);
}

vec2 amongTexels(vec2 place, vec2 size) { return (place * (size - 1.0) + 0.5) / size; }

vec2 amongStrengths(vec2 place, int block) {
    vec2 node = place * (nodes - 1.0) + 0.5;
    return vec2(node.x, node.y + float(block) * nodes.y) / vec2(nodes.x, nodes.y * float(blocks));
}

// Efficiency over strength, as match_factor of the library.
float matched(float i, float o) { return 4.0 * i * o / ((i + o) * (i + o)); }
vec4 matched(vec4 i, float o) { return 4.0 * i * o / ((i + o) * (i + o)); }

// Light of the lamp by one order of the step `by`, without its surroundings.
vec3 fromLamp(vec3 wo, vec3 towards, vec2 by, vec2 place, int component) {
    // Tangential components of directions are no farther apart than their chords: |by λ − middle| ≤ reach.
    vec2 middle = towards.xy + wo.xy;
    float square = dot(by, by), along = dot(by, middle) / square, reach = lamp.x * (1.0 + lamp.y);
    vec2 aside = middle - along * by;
    float within = reach * reach - dot(aside, aside);
    if (within <= 0.0) return vec3(0.0);
    float reached = sqrt(within / square);
    vec2 ends = clamp(along + vec2(-reached, reached), range.x, range.y);
    if (ends.x >= ends.y) return vec3(0.0);
    float step = (ends.y - ends.x) / float(LAMP_LOOKS);
    vec3 sum = vec3(0.0);
    for (int i = 0; i < LAMP_LOOKS; ++i) {
        float nm = ends.x + (float(i) + 0.5) * step;
        vec2 wi = by * nm - wo.xy;
        float up = 1.0 - dot(wi, wi);
        if (up <= 0.0) continue;
        vec3 direction = vec3(wi, sqrt(up));
        float light = lampAt(distance(direction, towards));
        if (light <= 0.0) continue;
        vec2 of = vec2((nm - range.x) / (range.y - range.x), 0.0);
        vec4 weight = textureLod(response, amongTexels(of, vec2(textureSize(response, 0))), 0.0);
        float strength = textureLod(strengths, vec3(place, weight.a), 0.0)[component];
        sum += weight.rgb * (light * matched(direction.z, wo.z) * strength);
    }
    return sum * step;
}

// `local` takes vectors from the frame into the world of the light before it is turned.
vec3 underLamp(vec3 wo, mat3 local, vec2 place, vec3 even, vec3 mirror) {
    vec3 towards = lampTowards * local;
    vec3 sum = vec3(0.0);
    for (int block = 0; block < blocks; ++block) {
        vec2 at = amongStrengths(place, block);
        vec4 x = stepsX[block], y = stepsY[block];
        sum += fromLamp(wo, towards, vec2(x.x, y.x), at, 0);
        sum += fromLamp(wo, towards, vec2(x.y, y.y), at, 1);
        sum += fromLamp(wo, towards, vec2(x.z, y.z), at, 2);
        sum += fromLamp(wo, towards, vec2(x.w, y.w), at, 3);
    }
    return even * lamp.w + mirror * lampAt(distance(vec3(-wo.xy, wo.z), towards)) + sum;
}

// Mean light around a direction, at a level of detail.
vec3 lookAt(vec3 direction, float level) {
    vec2 at = direction.xy / (abs(direction.x) + abs(direction.y) + abs(direction.z));
    vec2 folded = (1.0 - abs(at.yx)) * vec2(at.x < 0.0 ? -1.0 : 1.0, at.y < 0.0 ? -1.0 : 1.0);
    at = direction.z < 0.0 ? folded : at;
    return textureLod(around, 0.5 * at + 0.5, level).rgb;
}

void main() {
    vec3 world = normalize(eye - vPoint);
    vec3 n = facing(world);
    vec3 t = normalize(vTangent - dot(vTangent, n) * n);
    mat3 local = mat3(t, cross(n, t), n);
    vec3 wo = world * local;
    wo = wo.z < 1e-6 ? normalize(vec3(wo.xy, 1e-6)) : wo;
    local = mat3(turned(local[0]), turned(local[1]), turned(local[2]));
    vec2 place = placeAmongNodes(wo);

    if (light == 0) {
        colour = vec4(textureLod(albedo, amongTexels(place, vec2(textureSize(albedo, 0))), 0.0).rgb, 1.0);
        return;
    }
    vec3 mirror = textureLod(mirrored, amongTexels(place, nodes), 0.0).rgb;
    if (light == 3) {
        vec3 even = textureLod(albedo, amongTexels(place, vec2(textureSize(albedo, 0))), 0.0).rgb;
        colour = vec4(underLamp(wo, local, place, even, mirror), 1.0);
        return;
    }
    // A texel of an octahedron of side 1 takes from 2 to 4 radians.
    float texels = interval * float(textureSize(around, 0).x) / 3.0;
    vec3 sum = vec3(0.0);
    for (int block = 0; block < blocks; ++block) {
        vec2 at = amongStrengths(place, block);
        vec4 stepX = stepsX[block], stepY = stepsY[block];
        vec4 level = log2(max(sqrt(stepX * stepX + stepY * stepY) * texels, 1.0));
        for (int i = 0; i < lookCount; ++i) {
            vec4 look = looks[i];
            vec4 x = stepX * look.w - wo.x, y = stepY * look.w - wo.y;
            vec4 up = 1.0 - x * x - y * y;
            if (max(max(up.x, up.y), max(up.z, up.w)) <= 0.0) continue;
            up = sqrt(max(up, 0.0));
            vec4 part = matched(up, wo.z) * textureLod(strengths, vec3(at, layers[i]), 0.0);
            vec3 seen = vec3(0.0);
            if (part.x > 0.0) seen += part.x * lookAt(local * vec3(x.x, y.x, up.x), level.x);
            if (part.y > 0.0) seen += part.y * lookAt(local * vec3(x.y, y.y, up.y), level.y);
            if (part.z > 0.0) seen += part.z * lookAt(local * vec3(x.z, y.z, up.z), level.z);
            if (part.w > 0.0) seen += part.w * lookAt(local * vec3(x.w, y.w, up.w), level.w);
            sum += look.rgb * seen;
        }
    }
    colour = vec4(sum + mirror * lookAt(local * vec3(-wo.xy, wo.z), 0.0), 1.0);
}
