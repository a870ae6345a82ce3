// A rough surface of that film: facets of a tabulated distribution of normals, which hide one another by Smith's model.
// Directions are unit vectors in the surface's frame, x along the tangent, y along the binormal, z along the normal,
// and leave the surface. Light that meets a second facet is left out.
//
// `facets` is the texture of --facets: the numbers of the distribution, one after the other, 256 in a row. Upload it as
// 32-bit floats in the file's order. Its texels are fetched, and need no filter.

const GONIOCHROME_PI: f32 = 3.14159265358979;
// Numbers in a row of densities, and in one of the squared roughnesses that directions see.
const GONIOCHROME_RING: i32 = select(GONIOCHROME_SECTORS + 1, 1, GONIOCHROME_SECTORS == 1);
const GONIOCHROME_VIEW: i32 = select(GONIOCHROME_SECTORS + 3, 1, GONIOCHROME_SECTORS == 1);
// Where the squared roughnesses begin, the probabilities within rings, and the integrals over sectors.
const GONIOCHROME_SEEN: i32 = (GONIOCHROME_RINGS + 1) * GONIOCHROME_RING;
const GONIOCHROME_WITHIN: i32 = GONIOCHROME_SEEN + 257 * GONIOCHROME_VIEW;
const GONIOCHROME_TURNED: i32 = GONIOCHROME_WITHIN + GONIOCHROME_RINGS + 1;

fn goniochrome_number(facets: texture_2d<f32>, place: i32) -> f32 {
    return textureLoad(facets, vec2<i32>(place % 256, place / 256), 0).r;
}

// Number between two places.
fn goniochrome_between(facets: texture_2d<f32>, low: i32, high: i32, part: f32) -> f32 {
    return mix(goniochrome_number(facets, low), goniochrome_number(facets, high), part);
}

// Sector of an azimuth, and the part of it that is passed.
fn goniochrome_sector(w: vec2<f32>) -> vec2<f32> {
    var turn = 0.0;
    if (dot(w, w) > 0.0) {
        turn = atan2(w.y, w.x) / (2.0 * GONIOCHROME_PI);
    }
    let at = select(turn, turn + 1.0, turn < 0.0) * f32(GONIOCHROME_SECTORS);
    let before = min(floor(at), f32(GONIOCHROME_SECTORS - 1));
    return vec2<f32>(before, at - before);
}

// Density of the facets' normals per solid angle and area, along a vector above the horizon.
fn goniochrome_density(facets: texture_2d<f32>, m: vec3<f32>) -> f32 {
    let t = min(dot(m.xy, m.xy) / dot(m, m), 1.0);
    let rings = f32(GONIOCHROME_RINGS);
    let k = min(floor(sqrt(sqrt(t)) * rings), rings - 1.0);
    let square = k * k;
    let apart = (2.0 * k + 1.0) * (2.0 * (square + k) + 1.0);
    let part = clamp((t * rings * rings * rings * rings - square * square) / apart, 0.0, 1.0);
    let inner = i32(k) * GONIOCHROME_RING;
    let outer = inner + GONIOCHROME_RING;
    if (GONIOCHROME_SECTORS == 1) {
        return goniochrome_between(facets, inner, outer, part);
    }
    let sector = goniochrome_sector(m.xy);
    let j = i32(sector.x);
    let here = goniochrome_between(facets, inner + j, outer + j, part);
    return mix(here, goniochrome_between(facets, inner + j + 1, outer + j + 1, part), sector.y);
}

// Area of the facets that a direction sees, cos θ/G1.
fn goniochrome_visible_area(facets: texture_2d<f32>, w: vec3<f32>) -> f32 {
    let at = sqrt(clamp(w.z, 0.0, 1.0)) * 256.0;
    let row = min(floor(at), 255.0);
    let part = at - row;
    var low = GONIOCHROME_SEEN + i32(row) * GONIOCHROME_VIEW;
    var high = low + GONIOCHROME_VIEW;
    var e = goniochrome_between(facets, low, high, part);
    if (GONIOCHROME_SECTORS > 1) {
        let sector = goniochrome_sector(w.xy);
        low += i32(sector.x);
        high += i32(sector.x);
        // Catmull and Rom's weights.
        let x = sector.y;
        let xx = x * x;
        let xxx = xx * x;
        e = (xx - 0.5 * (xxx + x)) * goniochrome_between(facets, low, high, part)
            + (1.5 * xxx - 2.5 * xx + 1.0) * goniochrome_between(facets, low + 1, high + 1, part)
            + (2.0 * xx - 1.5 * xxx + 0.5 * x) * goniochrome_between(facets, low + 2, high + 2, part)
            + 0.5 * (xxx - xx) * goniochrome_between(facets, low + 3, high + 3, part);
    }
    let square = w.z * w.z;
    return 0.5 * (w.z + sqrt(max(square + e * (1.0 - square), 0.25 * square)));
}

// BRDF in 1/sr, without the cosine: linear RGB.
fn goniochrome_brdf(
    lut: texture_2d<f32>,
    lut_sampler: sampler,
    facets: texture_2d<f32>,
    wi: vec3<f32>,
    wo: vec3<f32>,
    parameter: f32
) -> vec3<f32> {
    if (min(wi.z, wo.z) <= 1e-6) {
        return vec3<f32>(0.0);
    }
    let area_i = goniochrome_visible_area(facets, wi);
    let area_o = goniochrome_visible_area(facets, wo);
    let seen = select(area_i * wo.z + area_o * wi.z - wi.z * wo.z, area_i * area_o, GONIOCHROME_SEPARABLE);
    let rho = goniochrome_reflectance(lut, lut_sampler, 0.5 * length(wi + wo), parameter);
    return rho * (0.25 * goniochrome_density(facets, wi + wo) / seen);
}

// Density per solid angle with which goniochrome_sample draws wo for wi.
fn goniochrome_pdf(facets: texture_2d<f32>, wi: vec3<f32>, wo: vec3<f32>) -> f32 {
    if (min(wi.z, wo.z) <= 1e-6) {
        return 0.0;
    }
    let m = wi + wo;
    var density = goniochrome_density(facets, m);
    // Of a normal that wi does not see, the one is taken that is turned by half a turn.
    if (dot(wi.xy, m.xy) > wi.z * m.z) {
        density += goniochrome_density(facets, vec3<f32>(-m.xy, m.z));
    }
    return 0.5 * density * m.z / dot(m, m);
}

// Place in [0, 1] up to which a density that is linear from a to b holds a part u of all.
fn goniochrome_root(a: f32, b: f32, u: f32) -> f32 {
    let part = clamp(u, 0.0, 1.0);
    let divisor = a + sqrt(max(mix(a * a, b * b, part), 0.0));
    if (divisor > 0.0) {
        return min((a + b) * part / divisor, 1.0);
    }
    return part;
}

// Draws wo for wi by u in [0, 1)²; its z is not positive for a draw without light, which counts. The weight of a draw
// is goniochrome_brdf · wo.z / goniochrome_pdf.
fn goniochrome_sample(facets: texture_2d<f32>, wi: vec3<f32>, u: vec2<f32>) -> vec3<f32> {
    let last = GONIOCHROME_SECTORS - 1;
    // The first ring, and the first sector, whose end lies beyond.
    var k = 0;
    var count = GONIOCHROME_RINGS;
    while (count > 0) {
        let middle = count / 2;
        let beyond = goniochrome_number(facets, GONIOCHROME_WITHIN + k + middle + 1) > u.x;
        k = select(k + middle + 1, k, beyond);
        count = select(count - middle - 1, middle, beyond);
    }
    k = min(k, GONIOCHROME_RINGS - 1);
    let low = goniochrome_number(facets, GONIOCHROME_WITHIN + k);
    let high = goniochrome_number(facets, GONIOCHROME_WITHIN + k + 1);
    let inner = GONIOCHROME_TURNED + k * GONIOCHROME_SECTORS;
    let outer = inner + GONIOCHROME_SECTORS;
    let within = (u.x - low) / max(high - low, 1e-30);
    let part = goniochrome_root(
        goniochrome_number(facets, inner + last), goniochrome_number(facets, outer + last), within);
    let radii = vec2<f32>(f32(k), f32(k + 1)) / f32(GONIOCHROME_RINGS);
    let squares = radii * radii;
    let t = mix(squares.x * squares.x, squares.y * squares.y, part);
    let wanted = u.y * goniochrome_between(facets, inner + last, outer + last, part);
    var j = 0;
    count = last;
    while (count > 0) {
        let middle = count / 2;
        let beyond = goniochrome_between(facets, inner + j + middle, outer + j + middle, part) > wanted;
        j = select(j + middle + 1, j, beyond);
        count = select(count - middle - 1, middle, beyond);
    }
    var passed = 0.0;
    if (j > 0) {
        passed = goniochrome_between(facets, inner + j - 1, outer + j - 1, part);
    }
    let ahead = goniochrome_between(facets, inner + j, outer + j, part) - passed;
    let here = k * GONIOCHROME_RING + j;
    let next = select(here, here + 1, GONIOCHROME_SECTORS > 1);
    let a = goniochrome_between(facets, here, here + GONIOCHROME_RING, part);
    let b = goniochrome_between(facets, next, next + GONIOCHROME_RING, part);
    let turned = f32(j) + goniochrome_root(a, b, (wanted - passed) / max(ahead, 1e-30));
    let phi = 2.0 * GONIOCHROME_PI * turned / f32(GONIOCHROME_SECTORS);
    let straight = vec3<f32>(sqrt(t) * vec2<f32>(cos(phi), sin(phi)), sqrt(max(1.0 - t, 0.0)));
    let m = select(straight, vec3<f32>(-straight.xy, straight.z), dot(wi, straight) < 0.0);
    return normalize(2.0 * dot(wi, m) * m - wi);
}
