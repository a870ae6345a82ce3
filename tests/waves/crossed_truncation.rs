//! Truncation of surfaces with two periods.

use goniochrome_waves::Complex64;
use goniochrome_waves::WaveError;
use goniochrome_waves::convergence::{Converged, Goal, converge, largest_change};
use goniochrome_waves::crossed::{CrossedModes, first_level, truncation};
use goniochrome_waves::light::Light;
use goniochrome_waves::profile::{CrossedProfile, CrossedSlice, Strip};
use goniochrome_waves::response::Response;

use crate::random::{Media, Random};

fn solve(profile: &CrossedProfile, light: &Light, level: usize) -> Vec<Response> {
    let max_order = truncation(profile.period_nm, level);
    vec![CrossedModes::new(profile, light, max_order).and_then(|modes| modes.response()).expect("response")]
}

fn converged(profile: &CrossedProfile, light: &Light, target: f64, limit: usize) -> Converged {
    let goal = Goal { target, first: first_level(profile, light), limit };
    converge(goal, |level| Ok::<_, WaveError>(solve(profile, light, level))).expect("responses")
}

/// Layer of one to three rectangles in air, of which later ones cover earlier ones.
fn random_slice(random: &mut Random, period: [f64; 2], media: Media) -> CrossedSlice {
    let rectangles: Vec<([f64; 2], [f64; 2], Complex64)> = (0..=random.below(3))
        .map(|_| {
            let from = period.map(|period| random.within(0.0, 0.6) * period);
            let to = [0, 1].map(|axis| (from[axis] + random.within(0.1, 0.6) * period[axis]).min(period[axis]));
            (from, to, media.index(random))
        })
        .collect();
    let lines = |axis: usize| {
        let edges = rectangles.iter().flat_map(|(from, to, _)| [from[axis], to[axis]]);
        let mut edges: Vec<f64> = edges.chain([0.0]).filter(|&edge| edge < period[axis]).collect();
        edges.sort_by(f64::total_cmp);
        edges.dedup();
        edges
    };
    let medium = |point: [f64; 2]| {
        let covers = |from: &[f64; 2], to: &[f64; 2]| (0..2).all(|i| from[i] <= point[i] && point[i] < to[i]);
        let top = rectangles.iter().rev().find(|(from, to, _)| covers(from, to));
        top.map_or(Complex64::ONE, |(_, _, eta)| *eta)
    };
    let strip = |&y: &f64| Strip { edges_nm: lines(0), eta: lines(0).iter().map(|&x| medium([x, y])).collect() };
    CrossedSlice {
        thickness_nm: random.within(30.0, 400.0),
        strip_edges_nm: lines(1),
        strips: lines(1).iter().map(strip).collect(),
    }
}

#[test]
fn error_bars_of_random_surfaces_are_true() {
    const SURFACES: usize = 20;
    // 95 %.
    const MIN_TRUE: usize = 19;
    let mut random = Random(5);
    let mut correct = 0;
    for case in 0..SURFACES {
        let media = [Media::Lossless, Media::Absorbing][case % 2];
        let period_nm = [random.within(200.0, 600.0), random.within(200.0, 600.0)];
        let slices = (0..=random.below(2)).map(|_| random_slice(&mut random, period_nm, media)).collect();
        let profile = CrossedProfile { period_nm, above: 1.0, below: media.index(&mut random), slices };
        let light = Light { wavelength_nm: random.within(400.0, 780.0), tangential: random.tangential(80.0) };
        let found = converged(&profile, &light, 5e-3, 5);
        let error = largest_change(&found.responses, &solve(&profile, &light, 7));
        correct += usize::from(error <= found.error_bar);
    }
    assert!(correct >= MIN_TRUE, "{correct} of {SURFACES}");
}

#[test]
fn levels_follow_the_periods_and_the_orders_that_travel() {
    assert_eq!(truncation([300.0, 300.0], 4), [4, 4]);
    assert_eq!(truncation([300.0, 1200.0], 4), [2, 8]);
    assert_eq!(truncation([30.0, 30e3], 4), [1, 126]);
    let surface = |period_nm| CrossedProfile { period_nm, above: 1.0, below: 1.5.into(), slices: vec![] };
    let light = Light { wavelength_nm: 500.0, tangential: [-0.5, 0.0] };
    assert_eq!(first_level(&surface([300.0, 300.0]), &light), 3);
    // (1.5 + 0.5) 1500/500 orders along x.
    assert_eq!(first_level(&surface([1500.0, 1500.0]), &light), 6);
    for period_nm in [[1500.0, 700.0], [400.0, 2500.0], [5e3, 100.0]] {
        let surface = surface(period_nm);
        let [m_x, m_y] = truncation(period_nm, first_level(&surface, &light));
        let travelling = |order: usize, axis: usize| {
            light.tangential[axis].abs() + 1.5 >= order as f64 * light.wavelength_nm / period_nm[axis]
        };
        assert!(!travelling(m_x + 1, 0) && !travelling(m_y + 1, 1), "{period_nm:?} {m_x} {m_y}");
    }
}
