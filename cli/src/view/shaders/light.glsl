// The light around the body, turned about z. `light` is 0 for white, 1 for the studio, 2 for a lat-long image, 3
// for the lamp.
struct SoftBox { vec3 towards, right, up; vec2 halfExtent; float softness, radiance; };
uniform int light;
uniform vec2 turn; // sine and cosine
uniform vec3 room; // ceiling, horizon, floor
uniform SoftBox boxes[4];
uniform vec3 lampTowards;
uniform vec4 lamp; // angular radius, half the edge's width in radii, radiance, radiance of the surroundings
uniform sampler2D surroundings;

float smoothly(float x) {
    x = clamp(x, 0.0, 1.0);
    return x * x * (3.0 - 2.0 * x);
}

float studio(vec3 d) {
    float sum = mix(room.y, d.z < 0.0 ? room.z : room.x, smoothly(abs(d.z)));
    for (int i = 0; i < 4; ++i) {
        SoftBox box = boxes[i];
        float depth = dot(d, box.towards);
        if (depth <= 0.0) continue;
        vec2 beyond = abs(vec2(dot(d, box.right), dot(d, box.up)) / depth) - (box.halfExtent - box.softness);
        vec2 inside = 1.0 - vec2(smoothly(beyond.x / (2.0 * box.softness)), smoothly(beyond.y / (2.0 * box.softness)));
        sum += box.radiance * inside.x * inside.y;
    }
    return sum;
}

// The place of a direction in a lat-long image, and its inverse.
vec2 placeOf(vec3 d) { return vec2(0.5 - atan(d.y, d.x) / TAU, atan(length(d.xy), d.z) / PI); }

vec3 directionOf(vec2 place) {
    float theta = PI * place.y, phi = TAU * (0.5 - place.x);
    return vec3(sin(theta) * vec2(cos(phi), sin(phi)), cos(theta));
}

// What the lamp adds to its surroundings, at a chord from its middle.
float lampAt(float chord) {
    if (chord > lamp.x * (1.0 + lamp.y)) return 0.0;
    float angle = 2.0 * asin(min(0.5 * chord, 1.0));
    return lamp.z * (1.0 - smoothly((angle / lamp.x - 1.0 + lamp.y) / (2.0 * lamp.y)));
}

// A direction of the world, turned back with the light.
vec3 turned(vec3 d) { return vec3(turn.y * d.x + turn.x * d.y, turn.y * d.y - turn.x * d.x, d.z); }

// Radiance from a direction of the world.
vec3 radiance(vec3 direction) {
    if (light == 0) return vec3(1.0);
    vec3 d = turned(direction);
    if (light == 1) return vec3(studio(d));
    if (light == 3) return vec3(lamp.w + lampAt(distance(d, lampTowards)));
    return textureLod(surroundings, placeOf(d), 0.0).rgb;
}
