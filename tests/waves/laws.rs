//! Laws of physics that hold at any truncation.

use goniochrome::optics::incidence::Incidence;
use goniochrome::optics::interface::{Below, Model};
use goniochrome::optics::medium::{MediaLanes, Medium, MediumIndex};
use goniochrome::optics::stack::{Film, PreparedStack, PreparedStackArrays, Stack, StackArrays};
use goniochrome::simd::complex::ComplexLanes;
use goniochrome::simd::lanes::{F64, Lanes};
use goniochrome_waves::Complex64;
use goniochrome_waves::lamellar::Modes;
use goniochrome_waves::profile::{Profile, Slice};
use goniochrome_waves::response::{Order, Response};

use crate::random::{Media, Random, profile};

/// Rounding of decompositions and of the joining of layers; stated as the goal of the solver.
const ENERGY: f64 = 1e-10;
/// The two directions of a path have different decompositions, of other matrices.
const RECIPROCITY: f64 = 1e-9;
/// Rounding of two closed forms of the same stack.
const FLAT: f64 = 1e-9;
/// Rounding of one problem in other units or coordinates.
const SYMMETRY: f64 = 1e-9;
/// Order `index[0]` where it travels.
fn travelling(orders: &[Order]) -> impl Iterator<Item = &Order> {
    orders.iter().filter(|order| order.vertical.im == 0.0)
}

/// Sum of all efficiencies for s and for p.
fn total(response: &Response) -> [f64; 2] {
    let reflected = response.reflected.iter().map(|order| response.reflected_efficiency(order));
    let transmitted = response.transmitted.iter().map(|order| response.transmitted_efficiency(order));
    reflected.chain(transmitted).fold([0.0; 2], |[s, p], [more_s, more_p]| [s + more_s, p + more_p])
}

/// Largest difference of the efficiencies of two responses whose orders correspond one to one.
fn difference(a: &Response, b: &Response, order_of_b: impl Fn(i32) -> i32) -> f64 {
    let mut largest = 0.0_f64;
    for order in &a.reflected {
        let other = b.reflected.iter().find(|other| other.index[0] == order_of_b(order.index[0])).expect("order");
        for (x, y) in a.reflected_efficiency(order).iter().zip(b.reflected_efficiency(other)) {
            largest = largest.max((x - y).abs());
        }
    }
    for order in &a.transmitted {
        let other = b.transmitted.iter().find(|other| other.index[0] == order_of_b(order.index[0])).expect("order");
        for (x, y) in a.transmitted_efficiency(order).iter().zip(b.transmitted_efficiency(other)) {
            largest = largest.max((x - y).abs());
        }
    }
    largest
}

#[test]
fn lossless_surfaces_keep_all_energy_at_any_truncation() {
    let mut random = Random(1);
    let mut worst = 0.0_f64;
    for case in 0..60 {
        let profile = profile(&mut random, Media::Lossless);
        let [kx, ky] = random.tangential(85.0);
        let ky = if case % 4 == 0 { 0.0 } else { ky };
        let modes = Modes::new(&profile, random.within(380.0, 780.0), kx, [1, 4, 12][case % 3]).expect("modes");
        let [s, p] = total(&modes.response(ky).expect("response"));
        worst = worst.max((s - 1.0).abs()).max((p - 1.0).abs());
    }
    println!("|R + T - 1| <= {worst:.1e}");
    assert!(worst <= ENERGY, "{worst:e}");
}

#[test]
fn absorbing_surfaces_create_no_energy() {
    let mut random = Random(2);
    for media in [Media::Absorbing, Media::Metal] {
        for _ in 0..30 {
            let profile = profile(&mut random, media);
            let [kx, ky] = random.tangential(85.0);
            let modes = Modes::new(&profile, random.within(380.0, 780.0), kx, 12).expect("modes");
            let sums = total(&modes.response(ky).expect("response"));
            assert!(sums.iter().all(|sum| (-ENERGY..=1.0 + ENERGY).contains(sum)), "{sums:?}");
        }
    }
}

/// Light from wi into order m has the Jones matrix of the reversed path, transposed, up to signs of p, once amplitudes
/// are scaled by the root of k_z.
#[test]
fn reflection_is_reciprocal_in_each_order_and_polarisation() {
    let mut random = Random(3);
    let mut worst = 0.0_f64;
    let mut orders = 0;
    for case in 0..60 {
        let profile = profile(&mut random, [Media::Lossless, Media::Absorbing, Media::Metal][case % 3]);
        let wavelength = random.within(380.0, 780.0);
        let [kx, ky] = random.tangential(85.0);
        let max_order = 9;
        let there = Modes::new(&profile, wavelength, kx, max_order).expect("modes").response(ky).expect("response");
        let back = Modes::new(&profile, wavelength, -kx, max_order).expect("modes");
        for order in travelling(&there.reflected) {
            let m = order.index[0];
            let reversed = back.response_at(-m, -ky).expect("response");
            let found = reversed.reflected.iter().find(|order| order.index[0] == m).expect("order");
            let forward = (order.vertical.re / there.incident_vertical).sqrt();
            let backward = (found.vertical.re / reversed.incident_vertical).sqrt();
            for i in 0..2 {
                for j in 0..2 {
                    let sign = if i == j { 1.0 } else { -1.0 };
                    let difference = order.jones[i][j] * forward - found.jones[j][i] * backward * sign;
                    worst = worst.max(difference.norm());
                }
            }
            orders += 1;
        }
    }
    println!("{orders} orders, amplitudes within {worst:.1e}");
    assert!(worst <= RECIPROCITY, "{worst:e}");
    assert!(orders > 100, "{orders}");
}

/// Reflectance and transmittance in s and p of films in air, in closed form.
fn closed_form(films: &[(Complex64, f64)], below: Complex64, wavelength: f64, sine: f64) -> [[f64; 2]; 2] {
    let all: Vec<Medium<'_>> = [Complex64::ONE]
        .into_iter()
        .chain(films.iter().map(|(eta, _)| *eta))
        .chain([below])
        .map(|eta| Medium::constant(eta).expect("a passive medium"))
        .collect();
    let mut eta = vec![ComplexLanes::zero(); all.len()];
    let lanes = MediaLanes::<F64>::evaluate(&all, &[wavelength], &mut eta).expect("constant media hold everywhere");
    let medium = |i: usize| MediumIndex::try_from(i).expect("few media");
    let layers = films.iter().enumerate().map(|(i, &(_, thickness_nm))| Film { medium: medium(i + 1), thickness_nm });
    let mut arrays = StackArrays::<8>::new();
    let substrate = Below::Medium(medium(films.len() + 1));
    let stack = Stack::new(0, layers, substrate, arrays.memory()).expect("the stack fits");
    let mut memory = Box::new(PreparedStackArrays::<F64, 8>::new());
    let prepared = PreparedStack::new(stack, &lanes, Incidence::from_sine(sine), Model::Physical, memory.memory());
    let response = prepared.response();
    let (r, t) = (prepared.reflectance(response.reflection), prepared.transmittance(response.transmission));
    [[r.s.lane(0), r.p.lane(0)], [t.s.lane(0), t.p.lane(0)]]
}

#[test]
fn flat_layers_have_the_closed_form() {
    let mut random = Random(4);
    let mut worst = 0.0_f64;
    for case in 0..40 {
        let media = [Media::Lossless, Media::Absorbing, Media::Metal][case % 3];
        let source = profile(&mut random, media);
        let films: Vec<(Complex64, f64)> =
            source.slices.iter().map(|slice| (slice.eta[0], slice.thickness_nm)).collect();
        let slice = |(i, &(eta, thickness_nm)): (usize, &(Complex64, f64))| {
            // Edges between equal media are no edges.
            let edges_nm = if i % 2 == 0 { vec![] } else { vec![10.0, 60.0] };
            Slice { thickness_nm, eta: vec![eta; edges_nm.len().max(1)], edges_nm }
        };
        let flat = Profile { slices: films.iter().enumerate().map(slice).collect(), ..source };
        let wavelength = random.within(380.0, 780.0);
        let [kx, ky] = random.tangential(89.0);
        let modes = Modes::new(&flat, wavelength, kx, 2).expect("modes");
        assert_eq!(modes.decompositions(), 0);
        let response = modes.response(ky).expect("response");
        let [r, t] = closed_form(&films, flat.below, wavelength, kx.hypot(ky));
        let sides = [
            (response.reflected_efficiency(&response.reflected[2]), r),
            (response.transmitted_efficiency(&response.transmitted[2]), t),
        ];
        for (found, expected) in sides {
            for (found, expected) in found.iter().zip(expected) {
                worst = worst.max((found - expected).abs());
            }
        }
    }
    println!("flat layers within {worst:.1e}");
    assert!(worst <= FLAT, "{worst:e}");
}

#[test]
fn lengths_scale_with_the_wavelength() {
    let mut random = Random(5);
    for _ in 0..10 {
        let profile = profile(&mut random, Media::Absorbing);
        let [kx, ky] = random.tangential(80.0);
        let once = Modes::new(&profile, 500.0, kx, 8).expect("modes").response(ky).expect("response");
        let larger = Profile {
            period_nm: 3.0 * profile.period_nm,
            slices: profile
                .slices
                .iter()
                .map(|slice| Slice {
                    thickness_nm: 3.0 * slice.thickness_nm,
                    edges_nm: slice.edges_nm.iter().map(|edge| 3.0 * edge).collect(),
                    eta: slice.eta.clone(),
                })
                .collect(),
            ..profile.clone()
        };
        let thrice = Modes::new(&larger, 1500.0, kx, 8).expect("modes").response(ky).expect("response");
        let found = difference(&once, &thrice, |m| m);
        assert!(found <= SYMMETRY, "{found:e}");
    }
}

#[test]
fn mirrored_surfaces_mirror_their_orders() {
    let mut random = Random(6);
    for _ in 0..10 {
        let profile = profile(&mut random, Media::Metal);
        let [kx, ky] = random.tangential(80.0);
        let mirrored = Profile {
            slices: profile
                .slices
                .iter()
                .map(|slice| {
                    let n = slice.eta.len();
                    Slice {
                        thickness_nm: slice.thickness_nm,
                        edges_nm: slice.edges_nm.iter().rev().map(|edge| profile.period_nm - edge).collect(),
                        eta: (0..n).map(|i| slice.eta[(2 * n - 2 - i) % n]).collect(),
                    }
                })
                .collect(),
            ..profile.clone()
        };
        let one = Modes::new(&profile, 500.0, kx, 8).expect("modes").response(ky).expect("response");
        let other = Modes::new(&mirrored, 500.0, -kx, 8).expect("modes").response(-ky).expect("response");
        let found = difference(&one, &other, |m| -m);
        assert!(found <= SYMMETRY, "{found:e}");
    }
}

/// Period and wavelength of which orders ±1 graze the surface at normal incidence, in air, in the substrate and in a
/// film; and light along y, for which they do not although k_x is the index.
#[test]
fn rayleigh_anomalies_give_finite_numbers_that_keep_energy() {
    let line = |edges_nm: Vec<f64>, eta: Vec<f64>| Slice {
        thickness_nm: 100.0,
        edges_nm,
        eta: eta.into_iter().map(Complex64::from).collect(),
    };
    let profile = |below: f64| Profile {
        period_nm: 500.0,
        above: 1.0,
        below: below.into(),
        slices: vec![
            line(vec![100.0, 300.0], vec![2.0, 1.0]),
            line(vec![], vec![1.25]),
            line(vec![50.0, 250.0], vec![1.5, 1.0]),
        ],
    };
    for (below, wavelength) in [(1.5, 500.0), (1.5, 750.0), (1.0, 500.0), (1.5, 625.0)] {
        for [kx, ky] in [[0.0, 0.0], [0.0, 0.5], [0.0, 0.6], [1.0 - wavelength / 500.0, 0.0]] {
            let modes = Modes::new(&profile(below), wavelength, kx, 6).expect("modes");
            let sums = total(&modes.response(ky).expect("finite"));
            let worst = sums.iter().fold(0.0_f64, |worst, sum| worst.max((sum - 1.0).abs()));
            assert!(worst <= ENERGY, "{below} {wavelength} {kx} {ky}: {worst:e}");
        }
    }
}
