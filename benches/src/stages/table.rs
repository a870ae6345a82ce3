use std::f64::consts::TAU;
use std::hint::black_box;

use glam::Vec3;
use goniochrome::microfacet::{Compensation, Distribution, FacetTable, Finish, Masking};
use goniochrome::table::{
    FilmArrays, FilmTable, HalfVectorWarp, MirrorTable, OrderArrays, OrderLayout, OrderTable, Periodicity,
    ScatterLayout, ScatterSampler, ScatterTable,
};
use goniochrome::trace::random::Random;
use goniochrome_cli::export::gltf::iridescence::eval_iridescence;

use super::{Visit, Work};

const LOOKUPS: usize = 1024;
/// Number of angles of `estimate`'s default table.
const ROWS: usize = 90;
/// Number of knots of the warp of `estimate`'s tables, along each axis.
const KNOTS: usize = 33;
/// Number of rings of tabulated facets.
const RINGS: usize = 256;
/// Numbers of rings and of sectors of tabulated facets that depend on the azimuth.
const GRID: [usize; 2] = [96, 36];

fn work(name: &'static str) -> Work {
    Work { stage: "table", name, unit: "look-ups", amount: LOOKUPS as f64 }
}

/// Orders, wavelengths and periods of a compact disc's table.
const ORDERS: [[f32; 2]; 9] =
    [[-4.0, 0.0], [-3.0, 0.0], [-2.0, 0.0], [-1.0, 0.0], [0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [3.0, 0.0], [4.0, 0.0]];
const WAVELENGTHS: usize = 41;
const PERIOD_NM: [f32; 2] = [1600.0; 2];

/// Table look-ups: RGB of 2D and 4D tables in random directions, RGB and density of 2D ones with a finish, and glTF's
/// formula for a film, which they replace; all orders and wavelengths of a table of orders from random directions.
///
/// # Panics
/// If a result is wrong.
pub fn table(visit: Visit<'_>) {
    let mut random = Random::new(0, 2);
    let angles: Vec<f32> = (0..LOOKUPS).map(|_| (random.next() * 1.55) as f32).collect();

    let values: Vec<f32> = (0..3 * ROWS).map(|i| i as f32 / (3 * ROWS) as f32).collect();
    let table = MirrorTable::new(&values, 3, 1.55).expect("a good table");
    assert!(table.rgb(0.8)[1] > table.rgb(0.7)[1]);
    visit(&work("2D, RGB"), &mut || {
        for &theta in black_box(&angles) {
            black_box(table.rgb(theta));
        }
    });

    // 400 nm of index 1.33 on glass. As in a shader, the cosine is known.
    let cosines: Vec<f32> = angles.iter().map(|theta| theta.cos()).collect();
    let film = |cos| eval_iridescence(1.0, 1.33, cos, 400.0, [0.04; 3]);
    assert!(film(0.5).iter().all(|c| (0.0..0.2).contains(c)));
    visit(&work("glTF's formula"), &mut || {
        for &cos in black_box(&cosines) {
            black_box(film(cos));
        }
    });

    let layout = ScatterLayout::new([8, 8], [16, 32], 0).expect("a good layout");
    let density: [f32; KNOTS] = std::array::from_fn(|i| 1.0 + 0.7 * (TAU as f32 * i as f32 / (KNOTS - 1) as f32).cos());
    let mut memory = vec![0.0; HalfVectorWarp::required_len([KNOTS; 2])];
    let warp = HalfVectorWarp::new([&density, &density], &mut memory).expect("a good warp");
    let values = vec![0.1; 3 * layout.count()];
    let table = ScatterTable::new(&values, layout, warp, &[], 3).expect("a good table");
    let mut memory = vec![0.0; ScatterSampler::required_len(&layout)];
    let sampler = ScatterSampler::new(&table, &mut memory).expect("enough memory");
    let mut direction = || {
        let (z, phi) = (0.02 + 0.98 * random.next(), TAU * random.next());
        let s = (1.0 - z * z).sqrt();
        Vec3::new((s * phi.cos()) as f32, (s * phi.sin()) as f32, z as f32)
    };
    let pairs: Vec<(Vec3, Vec3)> = (0..LOOKUPS).map(|_| (direction(), direction())).collect();
    let (wi, wo) = pairs[0];
    assert!((table.rgb(wi, wo)[0] * wi.z * wo.z - values[0]).abs() < 1e-5);
    visit(&work("4D, RGB"), &mut || {
        for &(wi, wo) in black_box(&pairs) {
            black_box(table.rgb(wi, wo));
        }
    });
    visit(&work("4D, sample"), &mut || {
        for &(wi, wo) in black_box(&pairs) {
            black_box(sampler.sample(wi, [wo.z, wi.z]));
        }
    });
    visit(&work("4D, pdf"), &mut || {
        for &(wi, wo) in black_box(&pairs) {
            black_box(sampler.pdf(wi, wo));
        }
    });
    for (name, distribution) in [("finish, GGX", Distribution::Ggx), ("finish, Beckmann", Distribution::Beckmann)] {
        let finish = Finish::new(distribution, Masking::Correlated, [0.2, 0.3]).expect("a good roughness");
        finished(name, finish, &pairs, visit);
    }
    let ggx = Finish::new(Distribution::Ggx, Masking::Correlated, [0.25; 2]).expect("a good roughness");
    let mut losses = [0.0; Compensation::LEN];
    let compensated = ggx.compensated(&mut losses).expect("memory of the right length");
    finished("finish, GGX, compensated", compensated, &pairs, visit);
    for (name, size) in [("finish, tabulated", [RINGS, 1]), ("finish, tabulated, azimuth", GRID)] {
        let density: Vec<f32> = (0..(size[0] + 1) * size[1])
            .map(|node| (FacetTable::sin_square(size[0], node / size[1]) as f32).min(0.999_999))
            .map(|t| ggx.density(Vec3::new(t.sqrt(), 0.0, (1.0 - t).sqrt())))
            .collect();
        let mut memory = vec![0.0; FacetTable::required_len(size)];
        let facets = FacetTable::new(size, &density, &mut memory).expect("good facets");
        finished(name, Finish::tabulated(facets, Masking::Correlated), &pairs, visit);
    }
    orders(&pairs, visit);
}

/// RGB and density of a 2D table with a finish.
fn finished(name: &'static str, finish: Finish<'_>, pairs: &[(Vec3, Vec3)], visit: Visit<'_>) {
    let values: Vec<f32> = (0..3 * ROWS).map(|i| i as f32 / (3 * ROWS) as f32).collect();
    let arrays = FilmArrays { reflectance: &values, transmittance: &[], thickness_nm: &[0.0] };
    let mut table = FilmTable::new(&arrays, 3, 1.55, Some(finish)).expect("a good table");
    if finish.compensation().is_some() {
        table = table.with_returned(&[0.5; 3]).expect("a finish with compensation");
    }
    let eval = |wi, wo| table.eval_and_pdf(wi, wo, 0.0);
    let (rgb, pdf) = eval(Vec3::Z, Vec3::Z);
    assert!(rgb[2] > rgb[1] && pdf > 0.0);
    visit(&work(name), &mut || {
        for &(wi, wo) in black_box(pairs) {
            black_box(eval(wi, wo));
        }
    });
}

fn orders(pairs: &[(Vec3, Vec3)], visit: Visit<'_>) {
    const VIEWS: usize = 16;
    let layout = OrderLayout::new([61, 16], Periodicity::X, PERIOD_NM).expect("a good layout");
    let wavelength_nm: Vec<f32> = (0..WAVELENGTHS).map(|w| 380.0 + 8.0 * w as f32).collect();
    let strength = vec![0.1; WAVELENGTHS * layout.count() * ORDERS.len()];
    let arrays = OrderArrays {
        orders: &ORDERS,
        wavelength_nm: &wavelength_nm,
        index: &[1.0; WAVELENGTHS],
        rgb_weights: &[[1.0 / WAVELENGTHS as f32; 3]; WAVELENGTHS],
        strength: &strength,
    };
    let table = OrderTable::new(layout, &arrays).expect("a good table");
    let directions: Vec<Vec3> = pairs.iter().take(VIEWS).map(|(wi, _)| *wi).collect();
    assert!((table.view(Vec3::Z).and_then(|view| view.light(0, 4)).map_or(0.0, |l| l.efficiency) - 0.1).abs() < 1e-6);
    let amount = (VIEWS * WAVELENGTHS * ORDERS.len()) as f64;
    visit(&Work { amount, ..work("orders, all of a view") }, &mut || {
        for &wo in black_box(&directions) {
            let Some(view) = table.view(wo) else { continue };
            for wavelength in 0..WAVELENGTHS {
                for order in 0..ORDERS.len() {
                    black_box(view.light(wavelength, order));
                }
            }
        }
    });
}
