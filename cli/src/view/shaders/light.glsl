// The light around the body, turned about z. `light` is 0 for white, 1 for the studio, 2 for a lat-long image.
struct Lamp { vec3 towards, right, up; vec2 halfExtent; float softness, radiance; };
uniform int light;
uniform vec2 turn; // sine and cosine
uniform vec3 room; // ceiling, horizon, floor
uniform Lamp lamps[4];
uniform sampler2D surroundings;

float smoothly(float x) {
    x = clamp(x, 0.0, 1.0);
    return x * x * (3.0 - 2.0 * x);
}

float studio(vec3 d) {
    float sum = mix(room.y, d.z < 0.0 ? room.z : room.x, smoothly(abs(d.z)));
    for (int i = 0; i < 4; ++i) {
        Lamp lamp = lamps[i];
        float depth = dot(d, lamp.towards);
        if (depth <= 0.0) continue;
        vec2 beyond = abs(vec2(dot(d, lamp.right), dot(d, lamp.up)) / depth) - (lamp.halfExtent - lamp.softness);
        vec2 inside = 1.0 - vec2(smoothly(beyond.x / (2.0 * lamp.softness)), smoothly(beyond.y / (2.0 * lamp.softness)));
        sum += lamp.radiance * inside.x * inside.y;
    }
    return sum;
}

// Radiance from a direction of the world.
vec3 radiance(vec3 direction) {
    if (light == 0) return vec3(1.0);
    vec3 d = vec3(turn.y * direction.x + turn.x * direction.y, turn.y * direction.y - turn.x * direction.x, direction.z);
    if (light == 1) return vec3(studio(d));
    vec2 place = vec2(0.5 - atan(d.y, d.x) / TAU, atan(length(d.xy), d.z) / PI);
    return textureLod(surroundings, place, 0.0).rgb;
}
