//! Truncation of the orders: answers with an error bar.
//!
//! An answer is found at growing numbers of orders, M = first, 3/2 first, … Where the error falls as a power M^−p, each
//! change is q = (2/3)^p of the change before, and what remains after a change c is c (q + q² + …) = c q/(1 − q).
//! Changes are irregular, above all where fields are singular at edges of metal, so that the error bar takes q from a
//! narrow range and does not trust a change that happens to be small. `tests/waves/error_bars.rs` measures how often it
//! is true.

use crate::response::{Order, Response};

/// Least ratio q of two changes: p = 1, as at edges for the p polarisation. Dielectrics converge faster, and are true
/// too.
const MIN_RATIO: f64 = 2.0 / 3.0;
/// Largest ratio q, p = 0.7: beyond it the sum of the series depends on the noise of the ratio.
const MAX_RATIO: f64 = 0.75;
/// Least change that is believed, as a share of the change before.
const MIN_CHANGE: f64 = 0.5;

/// What [`converge`] is to reach.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Goal {
    /// Error bar of any efficiency to stop at.
    pub target: f64,
    /// Truncation to begin with: orders −M…M. At least 1.
    pub first: usize,
    /// Largest truncation to use.
    pub limit: usize,
}

/// Answer at the largest truncation that was used, with what is known of its error.
#[derive(Clone, Debug, PartialEq)]
pub struct Converged<T = Vec<Response>> {
    /// Responses, in the sequence in which the solver gave them, or what was made of them.
    pub responses: T,
    /// Truncation M of the responses.
    pub max_order: usize,
    /// Largest change of any efficiency in the last step of the truncation; infinite if there was no step.
    pub change: f64,
    /// Error bar of any efficiency: an estimate of what changes up to an infinite truncation.
    pub error_bar: f64,
    /// Whether the error bar is at most the target.
    pub met: bool,
}

/// Calls `solve` with growing truncations until the error bar of every efficiency is at most the target, or the limit
/// is reached. `solve` returns the responses for any number of plane waves, as many each time.
///
/// # Errors
/// What `solve` returns.
pub fn converge<E>(goal: Goal, solve: impl Fn(usize) -> Result<Vec<Response>, E>) -> Result<Converged, E> {
    converge_by(goal, solve, |coarse, fine| largest_change(coarse, fine))
}

/// As [`converge`], of any answer, of which `change` gives the largest change of an efficiency between two truncations.
///
/// # Errors
/// What `solve` returns.
pub fn converge_by<T, E>(
    goal: Goal,
    solve: impl Fn(usize) -> Result<T, E>,
    largest_change: impl Fn(&T, &T) -> f64,
) -> Result<Converged<T>, E> {
    let mut max_order = goal.first.max(1).min(goal.limit.max(1));
    let mut responses = solve(max_order)?;
    let (mut change, mut error_bar) = (f64::INFINITY, f64::INFINITY);
    while error_bar > goal.target && max_order < goal.limit {
        let next = max_order + max_order.div_ceil(2);
        // No short last step, whose change would be small.
        max_order = if next + next / 4 >= goal.limit { goal.limit } else { next };
        let finer = solve(max_order)?;
        let found = largest_change(&responses, &finer);
        error_bar = if change.is_finite() && change > 0.0 {
            remaining(found.max(MIN_CHANGE * change), found / change)
        } else {
            remaining(found, MAX_RATIO)
        };
        change = found;
        responses = finer;
    }
    Ok(Converged { responses, max_order, change, error_bar, met: error_bar <= goal.target })
}

/// Sum of all changes after `change`, each `ratio` times the one before.
fn remaining(change: f64, ratio: f64) -> f64 {
    let ratio = ratio.clamp(MIN_RATIO, MAX_RATIO);
    change * ratio / (1.0 - ratio)
}

/// Largest change of any efficiency between two truncations. An order that the coarser lacks counts wholly.
#[must_use]
pub fn largest_change(coarse: &[Response], fine: &[Response]) -> f64 {
    type Efficiency = fn(&Response, &Order) -> [f64; 2];
    let side = |coarse: (&Response, &[Order]), fine: (&Response, &[Order]), efficiency: Efficiency| {
        let mut largest = 0.0_f64;
        for order in fine.1.iter().filter(|order| order.vertical.re > 0.0) {
            let now = efficiency(fine.0, order);
            let known = coarse.1.iter().find(|known| known.index == order.index);
            let before = known.map_or([0.0; 2], |known| efficiency(coarse.0, known));
            largest = largest.max((now[0] - before[0]).abs()).max((now[1] - before[1]).abs());
        }
        largest
    };
    let changes = coarse.iter().zip(fine).map(|(coarse, fine)| {
        let reflected = side((coarse, &coarse.reflected), (fine, &fine.reflected), Response::reflected_efficiency);
        let transmitted =
            side((coarse, &coarse.transmitted), (fine, &fine.transmitted), Response::transmitted_efficiency);
        reflected.max(transmitted)
    });
    changes.fold(0.0, f64::max)
}
