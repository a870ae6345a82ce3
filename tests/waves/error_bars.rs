//! Error bars against four times the orders.

use goniochrome_waves::WaveError;
use goniochrome_waves::convergence::{Goal, converge, largest_change};
use goniochrome_waves::lamellar::Modes;
use goniochrome_waves::response::Response;

use crate::random::{Media, Random, profile};

const PROFILES: usize = 200;
/// Share of error bars that must be true.
const MIN_TRUE: f64 = 0.95;
/// Truncations from 4 to 9 orders on each side: the reference needs 73 orders at most.
const GOAL: Goal = Goal { target: 5e-3, first: 4, limit: 9 };

#[test]
fn error_bars_of_random_profiles_are_true() {
    let mut random = Random(11);
    let mut correct = [0; 3];
    let mut met = [0; 3];
    for case in 0..PROFILES {
        let kind = case % 3;
        let profile = profile(&mut random, [Media::Lossless, Media::Absorbing, Media::Metal][kind]);
        let wavelength = random.within(380.0, 780.0);
        let [kx, ky] = random.tangential(80.0);
        let ky = if case % 5 == 0 { 0.0 } else { ky };
        let solve =
            |max_order: usize| Ok::<_, WaveError>(vec![Modes::new(&profile, wavelength, kx, max_order)?.response(ky)?]);
        let found = converge(GOAL, solve).expect("a response");
        let reference = solve(4 * found.max_order).expect("a response");
        let error = largest_change(&found.responses, &reference);
        correct[kind] += usize::from(error <= found.error_bar);
        met[kind] += usize::from(found.met);
    }
    let share = correct.iter().sum::<usize>() as f64 / PROFILES as f64;
    println!("true: {share:.3}; lossless, absorbing, metal: {correct:?}; target met: {met:?}");
    assert!(share >= MIN_TRUE, "{share}");
}

/// Responses whose only efficiency has the error M^−2.
fn response(max_order: usize) -> Vec<Response> {
    use goniochrome_waves::Complex64;
    use goniochrome_waves::response::Order;
    let error = (max_order as f64).powi(-2);
    let amplitude = Complex64::from((0.5 - error).sqrt());
    let jones = [[amplitude, Complex64::ZERO], [Complex64::ZERO, amplitude]];
    let order = Order { index: [0, 0], vertical: Complex64::ONE, jones };
    let half_spaces = [Complex64::ONE; 2];
    vec![Response { incident_vertical: 1.0, half_spaces, reflected: vec![order], transmitted: vec![] }]
}

#[test]
fn truncation_grows_until_the_target_or_the_limit() {
    let met = converge(Goal { target: 1e-3, first: 4, limit: 1000 }, |m| Ok::<_, WaveError>(response(m)))
        .expect("a response");
    assert!(met.met && met.error_bar <= 1e-3 && met.max_order < 1000, "{met:?}");
    assert!((met.max_order as f64).powi(-2) <= met.error_bar, "{met:?}");
    let limited =
        converge(Goal { target: 1e-6, first: 4, limit: 20 }, |m| Ok::<_, WaveError>(response(m))).expect("a response");
    assert!(!limited.met && limited.max_order == 20, "{limited:?}");
    assert!(20_f64.powi(-2) <= limited.error_bar, "{limited:?}");
    let alone =
        converge(Goal { target: 1e-6, first: 4, limit: 4 }, |m| Ok::<_, WaveError>(response(m))).expect("a response");
    assert!(!alone.met && alone.error_bar.is_infinite(), "{alone:?}");
}
