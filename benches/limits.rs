//! `limits`: compares each stage with the most that this processor core can do, measured in the same run.
//!
//! Running the library's code with lanes that count gives the numbers of operations. "of peak" is operations per second
//! over those of fused multiply-adds in registers. The two shares after it are the least time that products and sums,
//! and that divisions, roots and exponentials, would take if none waited for another. Units work side by side (many
//! processors add while they multiply), so a stage is at its limit where one share is near 100 % or above. The rest of
//! the time goes to waiting for results, memory or branches, and to work that is not floating-point arithmetic.

use std::hint::black_box;
use std::time::Duration;

use goniochrome::simd::lanes::{F32, F64, Lanes};
use goniochrome::simd::ray_lanes::RayLanes;
use goniochrome_benches::clock::processor_time;
use goniochrome_benches::counted::{Counted, Counts, OPERATIONS, Operation, count};
use goniochrome_benches::stages::{Stage, Work, cell, coherence, interface, phase, planar, stack};

/// Number of independent chains of operations: two units of latency 4 need as many to be busy, and registers hold them
/// in either precision.
const CHAINS: usize = 8;
/// Number of repetitions, of which a measurement takes the least.
const REPEATS: usize = 5;
/// A repetition runs the work as often as this takes.
const MIN_TIME: Duration = Duration::from_millis(20);

/// Least seconds of one run of `work`.
fn seconds(work: &mut dyn FnMut()) -> f64 {
    let mut runs = 1u32;
    loop {
        let mut time = || processor_time(|| (0..runs).for_each(|_| work())).1;
        let first = time();
        if first >= MIN_TIME {
            let min = (1..REPEATS).map(|_| time()).fold(first, Duration::min);
            return min.as_secs_f64() / f64::from(runs);
        }
        runs *= 2;
    }
}

/// Least seconds of an operation on all lanes of a vector, where many vectors are computed side by side.
fn cost<V: Lanes>(operation: Operation) -> f64 {
    let m = black_box(V::splat(0.999_9));
    let a = black_box(V::splat(1e-4));
    match operation {
        Operation::Simple => chained::<V>(|x| x * m),
        Operation::Fused => chained::<V>(|x| x.mul_add(m, a)),
        Operation::Divide => chained::<V>(|x| x / m),
        Operation::Root => chained::<V>(|x| x.sqrt()),
        Operation::Exponential => chained::<V>(|x| (x * m).exp()),
    }
}

/// Least seconds of one call of `f` in several chains of calls.
#[inline(always)]
fn chained<V: Lanes>(f: impl Fn(V) -> V) -> f64 {
    const ROUNDS: usize = 1000;
    let mut chains: [V; CHAINS] = std::array::from_fn(|i| V::splat(1.0 + 1e-3 * i as f64));
    let time = seconds(&mut || {
        let mut running = chains;
        for _ in 0..ROUNDS {
            for x in &mut running {
                *x = f(*x);
            }
        }
        chains = black_box(running);
    });
    time / (ROUNDS * CHAINS) as f64
}

/// The [`cost`] of each operation for a vector of `V`, in working and in double precision.
fn costs<V: Lanes>() -> [[f64; 2]; OPERATIONS.len()] {
    OPERATIONS.map(|operation| [cost::<V>(operation), cost::<V::Precise>(operation)])
}

/// Number of operations, of which a fused multiply-add is two.
fn operations(counts: &Counts) -> f64 {
    let of = |operation: Operation| counts[operation as usize].iter().sum::<u64>() as f64;
    2.0 * of(Operation::Fused)
        + of(Operation::Simple)
        + of(Operation::Divide)
        + of(Operation::Root)
        + of(Operation::Exponential)
}

fn report<V: Lanes>(lanes: &str, stage: Stage, counting: Stage, costs: &[[f64; 2]]) {
    let mut counted: Vec<(Counts, f64)> = Vec::new();
    counting(&mut |work: &Work, run: &mut dyn FnMut()| counted.push((count(run), work.amount)));
    let mut counted = counted.into_iter();
    stage(&mut |work: &Work, run: &mut dyn FnMut()| {
        let (counts, amount) = counted.next().expect("the same pieces of work");
        // Lanes of a vector share one operation; the counting run has one lane.
        let vectors = work.amount / V::WIDTH as f64 / amount;
        let time = seconds(run);
        let per_unit = operations(&counts) / amount;
        let peak = 2.0 * V::WIDTH as f64 / costs[Operation::Fused as usize][0];
        let min_time = |operations: &[Operation]| -> f64 {
            let of =
                |&o: &Operation| counts[o as usize].iter().zip(costs[o as usize]).map(|(&n, cost)| n as f64 * cost);
            operations.iter().flat_map(of).sum::<f64>() * vectors
        };
        let products = min_time(&[Operation::Simple, Operation::Fused]);
        let slow = min_time(&[Operation::Divide, Operation::Root, Operation::Exponential]);
        println!(
            "{:13} {:13} {lanes:4} {:8.2} ns per {:18} {per_unit:7.0} op {:6.1} Gop/s {:5.1} % of peak \
             {:4.0} % of the time for products and sums, {:4.0} % for division and root",
            work.stage,
            work.name,
            time / work.amount * 1e9,
            work.unit,
            per_unit * work.amount / time * 1e-9,
            100.0 * per_unit * work.amount / time / peak,
            100.0 * products / time,
            100.0 * slow / time,
        );
    });
}

fn all<V: RayLanes, C: RayLanes>(lanes: &str) {
    let costs = costs::<V>();
    for (operation, [working, double]) in OPERATIONS.iter().zip(&costs) {
        println!("{lanes}: {operation:?} {:.2} ns a vector, in double precision {:.2}", working * 1e9, double * 1e9);
    }
    println!("{lanes}: peak {:.0} Gop/s", 2.0 * V::WIDTH as f64 / costs[Operation::Fused as usize][0] * 1e-9);
    for (stage, counting) in [
        (phase::<V> as Stage, phase::<C> as Stage),
        (interface::<V>, interface::<C>),
        (stack::<V>, stack::<C>),
        (planar::<V>, planar::<C>),
        (coherence::<V>, coherence::<C>),
        (cell::<V>, cell::<C>),
    ] {
        report::<V>(lanes, stage, counting, &costs);
    }
}

fn main() {
    all::<F32, Counted<false>>("f32");
    all::<F64, Counted<true>>("f64");
}
