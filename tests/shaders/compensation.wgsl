
// A fragment for each line of a list, of two texels: wi with a parameter; then wo with 0, or two numbers for a draw
// with 1.
@group(0) @binding(0) var lut: texture_2d<f32>;
@group(0) @binding(1) var lut_sampler: sampler;
@group(0) @binding(2) var points: texture_2d<f32>;
/*@group(0) @binding(3) var facets: texture_2d<f32>;
*/@group(0) @binding(4) var compensation: texture_2d<f32>;
@fragment
fn main(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    let place = vec2<i32>(position.xy) * vec2<i32>(2, 1);
    let first = textureLoad(points, place, 0);
    let to = textureLoad(points, place + vec2<i32>(1, 0), 0);
    if (to.w > 0.5) {
        let wo = goniochrome_compensated_sample(/*facets, */compensation, lut_sampler, first.xyz, to.xy);
        return vec4<f32>(wo, goniochrome_compensated_pdf(/*facets, */compensation, lut_sampler, first.xyz, wo));
    }
    let f = goniochrome_compensated_brdf(lut, lut_sampler, /*facets, */compensation, first.xyz, to.xyz, first.w);
    return vec4<f32>(f, goniochrome_compensated_pdf(/*facets, */compensation, lut_sampler, first.xyz, to.xyz));
}
