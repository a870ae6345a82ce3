// A scatter table, by filtered importance sampling (Křivánek and Colbert, "Real-time shading with filtered importance
// sampling", 2008).
//
// A picture looks into the light along some half vectors, the same in all pixels that are seen from one direction. Each
// sees the mean of the light over the solid angle that it stands for, so there is no noise. `prepare.frag` draws the
// half vectors. The table's incident direction is that of the viewer: f is reciprocal. Lobes of flat facets look in
// exact directions.
uniform highp sampler2DArray looks, strengths; // over directions of the viewer, for each sample
uniform sampler2D rest, scattered; // over directions of the viewer
uniform highp samplerCube around;
uniform sampler2D atlas; // by incident direction, then by place: nodes, then lobes; in lines of 2048
uniform sampler2D lobes; // n and M, by columns
uniform ivec2 incident, views; // θ × φ
uniform int places, lobeCount, count;
uniform float level; // of detail, of a solid angle of 1
out vec4 colour;

// Fraction that a lobe reflects, between incident directions.
vec3 lobe(int at, ivec2 lower, vec2 share) {
    vec3 sum = vec3(0.0);
    for (int k = 0; k < 4; ++k) {
        ivec2 upper = ivec2(k >> 1, k & 1);
        vec2 weight = mix(1.0 - share, share, vec2(upper));
        int i = ((lower.x + upper.x) * incident.y + (lower.y + upper.y) % incident.y) * places + at;
        sum += weight.x * weight.y * texelFetch(atlas, ivec2(i & 2047, i >> 11), 0).rgb;
    }
    return sum;
}

// Direction of a lobe, as FacetLobe of the library; below the horizon if there is none.
vec3 lobeDirection(int i, vec3 wo) {
    const vec3 NONE = vec3(0.0, 0.0, -1.0);
    vec4 a = texelFetch(lobes, ivec2(0, i), 0), b = texelFetch(lobes, ivec2(1, i), 0), c = texelFetch(lobes, ivec2(2, i), 0);
    float n = a.x, excess = (n - 1.0) * (n + 1.0);
    float down = wo.z * wo.z + excess;
    if (down < 0.0) return NONE;
    vec3 turned = mat3(a.yzw, b.xyz, vec3(b.w, c.xy)) * vec3(-wo.xy / n, -sqrt(down) / n);
    float up = turned.z * turned.z * n * n - excess;
    return turned.z > 0.0 && up > 0.0 ? vec3(turned.xy * n, sqrt(up)) : NONE;
}

void main() {
    vec3 world = normalize(eye - vPoint);
    vec3 n = facing(world);
    vec3 t = normalize(vTangent - dot(vTangent, n) * n);
    mat3 local = mat3(t, cross(n, t), n);
    vec3 wo = world * local;
    wo = wo.z < 1e-6 ? normalize(vec3(wo.xy, 1e-6)) : wo;

    float across = length(wo.xy);
    float theta = clamp(atan(across, wo.z) / THETA_MAX, 0.0, 1.0);
    float turns = across > 0.0 ? atan(wo.y, wo.x) / TAU + 0.5 : 0.5;
    // Half vectors of an isotropic table count from the viewer.
    vec2 origin = incident.y == 1 && across > 0.0 ? wo.xy / across : vec2(1.0, 0.0);
    mat2 rotation = mat2(origin, vec2(-origin.y, origin.x));
    vec2 at = vec2(turns + 0.5 / float(views.y), (theta * float(views.x - 1) + 0.5) / float(views.x));
    float divisor = max(wo.z, cos(THETA_MAX));

    vec3 sum = vec3(0.0);
    if (light == 0) {
        sum = textureLod(scattered, at, 0.0).rgb / divisor;
    } else {
        mat3 back = mat3(turned(local[0]), turned(local[1]), turned(local[2]));
        vec3 more = textureLod(rest, at, 0.0).rgb;
        for (int i = 0; i < count; ++i) {
            vec4 look = textureLod(looks, vec3(at, i), 0.0), strength = textureLod(strengths, vec3(at, i), 0.0);
            vec2 aside = rotation * look.xy;
            vec3 m = vec3(aside, sqrt(max(1.0 - dot(aside, aside), 0.0)));
            vec3 wi = 2.0 * dot(wo, m) * m - wo;
            vec3 d = back * vec3(wi.xy, max(wi.z, 0.0));
            // A cell of the cube takes (2 / side)² d³ of solid angle: d is the largest component of its direction.
            float largest = max(max(abs(d.x), abs(d.y)), abs(d.z));
            vec3 seen = textureLod(around, d, look.z + level - 1.5 * log2(largest)).rgb;
            sum += (strength.rgb + more * strength.a) * seen;
        }
        sum /= float(count) * divisor;
    }

    vec2 place = vec2(theta * float(incident.x - 1), fract(turns) * float(incident.y));
    ivec2 lower = ivec2(min(int(place.x), incident.x - 2), int(place.y) % incident.y);
    vec2 share = vec2(place.x - float(lower.x), fract(place.y));
    for (int i = 0; i < lobeCount; ++i) {
        vec3 reflected = lobe(places - lobeCount + i, lower, share);
        if (reflected == vec3(0.0)) continue;
        vec3 wi = lobeDirection(i, wo);
        if (wi.z > 0.0) sum += reflected * radiance(local * wi);
    }
    colour = vec4(sum, 1.0);
}
