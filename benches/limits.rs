//! `limits`: each stage against what this core can do at most, measured in the same run.
//!
//! Operations come from running the core's code with lanes that count. "of peak" is operations per second over those of fused
//! products in registers. "of the units" adds up the least time that the kinds of operations take one by one when nothing waits
//! for another (division and square root are slow), so 100 % is the limit of this mix; the rest waits for results, memory or
//! branches, or does what is no floating-point arithmetic.

use std::hint::black_box;
use std::time::Duration;

use goniochrome::lanes::{F32, F64, Lanes};
use goniochrome_benches::clock::processor_time;
use goniochrome_benches::counted::{Counted, Counts, OPERATIONS, Operation, count};
use goniochrome_benches::stages::{Stage, Work, cell, coherence, interface, planar, stack, turns};

/// Independent chains: more than any unit's latency holds.
const CHAINS: usize = 16;
/// Each measurement is the least of so many.
const REPEATS: usize = 5;
const LEAST_TIME: Duration = Duration::from_millis(20);

/// Least seconds of one run of `work`.
fn seconds(work: &mut dyn FnMut()) -> f64 {
    let mut runs = 1u32;
    loop {
        let mut time = || processor_time(|| (0..runs).for_each(|_| work())).1;
        let first = time();
        if first >= LEAST_TIME {
            let least = (1..REPEATS).map(|_| time()).fold(first, Duration::min);
            return least.as_secs_f64() / f64::from(runs);
        }
        runs *= 2;
    }
}

/// Least seconds of an operation on all lanes of one vector.
fn cost<V: Lanes>(operation: Operation) -> f64 {
    const ROUNDS: usize = 1000;
    let mut chains: [V; CHAINS] = std::array::from_fn(|i| V::splat(1.0 + 1e-3 * i as f64));
    let (m, a) = (black_box(V::splat(0.999_9)), black_box(V::splat(1e-4)));
    let mut run = |f: fn(V, V, V) -> V| {
        seconds(&mut || {
            for _ in 0..ROUNDS {
                chains = chains.map(|x| f(x, m, a));
            }
            chains = black_box(chains);
        }) / (ROUNDS * CHAINS) as f64
    };
    match operation {
        Operation::Simple => run(|x, m, _| x * m),
        Operation::Fused => run(|x, m, a| x.mul_add(m, a)),
        Operation::Divide => run(|x, m, _| x / m),
        Operation::Root => run(|x, _, _| x.sqrt()),
        Operation::Exponential => run(|x, _, _| x.exp()) - run(|x, _, _| -x),
    }
}

/// Costs of each operation, in working and in double precision, for a vector of `V`.
fn costs<V: Lanes>() -> [[f64; 2]; OPERATIONS.len()] {
    OPERATIONS.map(|operation| [cost::<V>(operation), cost::<V::Precise>(operation)])
}

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
        // Lanes of a vector share one operation; a visit of the counting run is one lane.
        let vectors = work.amount / V::WIDTH as f64 / amount;
        let time = seconds(run);
        let per_unit = operations(&counts) / amount;
        let peak = 2.0 * V::WIDTH as f64 / costs[Operation::Fused as usize][0];
        let least: f64 = counts
            .iter()
            .zip(costs)
            .flat_map(|(n, cost)| n.iter().zip(cost))
            .map(|(&n, cost)| n as f64 * cost * vectors)
            .sum();
        let slow: f64 = [Operation::Divide, Operation::Root, Operation::Exponential]
            .iter()
            .map(|&o| {
                (counts[o as usize][0] as f64 * costs[o as usize][0]
                    + counts[o as usize][1] as f64 * costs[o as usize][1])
                    * vectors
            })
            .sum();
        println!(
            "{:13} {:13} {lanes:4} {:8.2} ns per {:18} {per_unit:7.0} op {:6.1} Gop/s {:5.1} % of peak {:5.1} % of the units ({:3.0} % division, root, exp)",
            work.stage,
            work.name,
            time / work.amount * 1e9,
            work.unit,
            per_unit * work.amount / time * 1e-9,
            100.0 * per_unit * work.amount / time / peak,
            100.0 * least / time,
            100.0 * slow / least,
        );
    });
}

fn all<V: Lanes, C: Lanes>(lanes: &str) {
    let costs = costs::<V>();
    for (operation, [working, double]) in OPERATIONS.iter().zip(&costs) {
        println!("{lanes}: {operation:?} {:.2} ns a vector, in double precision {:.2}", working * 1e9, double * 1e9);
    }
    println!("{lanes}: peak {:.0} Gop/s", 2.0 * V::WIDTH as f64 / costs[Operation::Fused as usize][0] * 1e-9);
    for (stage, counting) in [
        (turns::<V> as Stage, turns::<C> as Stage),
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
