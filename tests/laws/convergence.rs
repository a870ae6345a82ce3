//! A workspace that is too small costs accuracy, which the ledger accounts for; one that fits costs none.

use goniochrome::layers::TraceMemory;

use super::*;

#[test]
fn a_larger_workspace_converges_to_the_sum_of_all_rays() {
    let limits = Limits { in_flight: 1e-16, generations: 2_000 };
    let mut worst = Worst::of("few slots, within what they truncate");
    let (mut full, mut cramped) = (0u32, 0u32);
    each(16, |random| {
        let case = Case::random(random, true, true);
        // Evanescent waves may gain in a loop; then nothing bounds what a dropped ray would have done.
        if case.stack.eta.iter().any(|eta| eta.re <= case.stack.eta[0].re * case.sin_theta()) {
            return;
        }
        let states = 2 * (case.stack.thickness_nm.len() + 1);
        let twins = case.twins();
        // Half of the states, all, and more than there are.
        for slots in [states / 2, states, states + 8] {
            let mut workspace = Box::new(Workspace::<F64, 32>::new());
            let (ledger, generations) =
                case.stack.with_optics::<F64, _>(case.theta_deg, &case.wavelengths_nm, Model::Physical, |optics| {
                    let memory = workspace.memory();
                    let memory = TraceMemory { totals: memory.totals, slots: &mut memory.slots[..slots] };
                    let traced = trace_layers(optics, Summation::Generations(limits), memory).expect("the stack fits");
                    (traced.ledger, f64::from(traced.trace.generations))
                });
            let enough = slots >= states;
            for (lane, twins) in twins.iter().enumerate() {
                let truncated = ledger.truncated.lane(lane);
                assert!(
                    !enough || truncated <= limits.in_flight || generations >= f64::from(limits.generations),
                    "{slots} slots for {states} states: {truncated}"
                );
                full += u32::from(enough);
                cramped += u32::from(truncated > limits.in_flight);
                for (pol, twin) in twins.iter().enumerate() {
                    let what = || format!("{slots} slots for {states} states: {:?}", case.stack.eta);
                    let [dr, dt] = twin.rounding(F64::UNIT_ROUNDOFF * generations.max(1.0).sqrt());
                    // Each generation may drop rays that would have met again.
                    let [lost_r, lost_t] = twin.truncation(truncated, if enough { 1.0 } else { generations + 1.0 });
                    worst.see(lanes(ledger.reflected, lane)[pol] - twin.reflectance, dr + lost_r, what);
                    worst.see(lanes(ledger.transmitted, lane)[pol] - twin.transmittance, dt + lost_t, what);
                }
            }
        }
    });
    println!("{full} sums in full, {cramped} truncated");
    assert!(full > 0 && cramped > 0);
    // A third of the sums has half the slots it needs, and may lose more than any bound tells.
    worst.report(0.4);
}
