//! Times ray tracing through planar stacks of more and more layers: with loops closed, hit by hit, and with the paper's
//! literal list of rays, which merges none.

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use goniochrome::simd::lanes::F32;
use goniochrome::trace::planar::{Summation, Workspace, trace_planar};
use goniochrome_benches::{LIMITS, Layered, MAX_PLANES, contrast, group};
use num_complex::Complex64;
use std::f64::consts::TAU;
use std::hint::black_box;

/// Times each method for 2 to 60 layers, one wavelength in each lane, and prints the visits, since they are what grows.
fn growth(c: &mut Criterion) {
    let mut workspace = Box::new(Workspace::<F32, MAX_PLANES>::new());
    let mut benches = c.benchmark_group("growth");
    benches.sample_size(10);
    for layers in [2, 4, 8, 15, 30, 60] {
        let stack = contrast(layers);
        let mut literal = None;
        if layers <= 4 {
            literal = Some(Literal::new(&stack, 550.0));
        }
        stack.with_prepared::<F32, _>(0.0, &group::<F32>(), |prepared| {
            for (method, summation) in
                [("closed-loops", Summation::ClosedLoops), ("generations", Summation::Generations(LIMITS))]
            {
                let traced = trace_planar(prepared, summation, workspace.memory()).expect("the stack fits");
                eprintln!("{layers} layers, {method}: {} visits", traced.trace.visits);
                benches.bench_function(BenchmarkId::new(method, layers), |b| {
                    b.iter(|| trace_planar(black_box(prepared), summation, workspace.memory()));
                });
            }
        });
        if let Some(mut literal) = literal {
            let reflectance = literal.reflectance(1e-4);
            eprintln!("{layers} layers, literal, amplitudes ≥ 1e-4: {} visits, R = {reflectance:.4}", literal.visits);
            benches.bench_function(BenchmarkId::new("literal", layers), |b| {
                b.iter(|| literal.reflectance(black_box(1e-4)));
            });
        }
    }
    benches.finish();
}

/// The paper's list of rays: each hit replaces a ray by two, and small amplitudes are cut off. Normal incidence, one
/// wavelength.
struct Literal {
    /// Reflection coefficient of each plane, from above.
    r: Vec<f64>,
    /// exp(i n k₀ d) of each layer.
    e: Vec<Complex64>,
    visits: u64,
}

impl Literal {
    fn new(stack: &Layered, wavelength_nm: f64) -> Self {
        let n = |medium: u16| stack.media[usize::from(medium)].re;
        let indices: Vec<f64> = [n(stack.ambient)]
            .into_iter()
            .chain(stack.layers.iter().map(|film| n(film.medium)))
            .chain([n(stack.substrate)])
            .collect();
        Self {
            r: indices.windows(2).map(|pair| (pair[0] - pair[1]) / (pair[0] + pair[1])).collect(),
            e: stack
                .layers
                .iter()
                .map(|film| Complex64::cis(TAU * n(film.medium) * film.thickness_nm / wavelength_nm))
                .collect(),
            visits: 0,
        }
    }

    fn reflectance(&mut self, cut_off: f64) -> f64 {
        let mut reflected = Complex64::default();
        let mut rays = vec![(0usize, true, Complex64::from(1.0))];
        self.visits = 0;
        while let Some((facet, from_above, amplitude)) = rays.pop() {
            self.visits += 1;
            let r = if from_above { self.r[facet] } else { -self.r[facet] };
            let (same_side, other_side) = (amplitude * r, amplitude * (1.0 + r));
            let (up, down) = if from_above { (same_side, other_side) } else { (other_side, same_side) };
            if facet == 0 {
                reflected += up;
            } else if up.norm() >= cut_off {
                rays.push((facet - 1, false, up * self.e[facet - 1]));
            }
            if facet < self.e.len() && down.norm() >= cut_off {
                rays.push((facet + 1, true, down * self.e[facet]));
            }
        }
        reflected.norm_sqr()
    }
}

criterion_group!(all, growth);
criterion_main!(all);
