//! Tests that different descriptions of one stack give equal results.

use super::*;

#[test]
fn only_lengths_in_wavelengths_matter() {
    let mut worst = Worst::of("scaling");
    each(6, |random| {
        let case = Case::random(random, false, true);
        let scale = 10f64.powf(random.between(-1.0, 2.0));
        let mut scaled = case.with(case.stack.eta.clone(), case.stack.thickness_nm.clone());
        scaled.stack.thickness_nm.iter_mut().for_each(|d| *d *= scale);
        scaled.wavelengths_nm.iter_mut().for_each(|nm| *nm *= scale);
        equal(&mut worst, &case, &scaled, 0.0);
    });
    worst.report(0.0);
}

#[test]
fn two_halves_are_a_whole() {
    let mut worst = Worst::of("splitting");
    each(7, |random| {
        let case = Case::random(random, false, true);
        let Layered { mut eta, mut thickness_nm } =
            case.with(case.stack.eta.clone(), case.stack.thickness_nm.clone()).stack;
        if thickness_nm.is_empty() {
            return;
        }
        let layer = random.below(thickness_nm.len() as u64) as usize;
        let part = thickness_nm[layer] * random.between(0.0, 1.0);
        thickness_nm[layer] -= part;
        thickness_nm.insert(layer, part);
        eta.insert(layer + 1, eta[layer + 1]);
        equal(&mut worst, &case, &case.with(eta, thickness_nm), 0.0);
    });
    worst.report(0.0);
}

#[test]
fn a_layer_of_no_thickness_changes_nothing() {
    let mut worst = Worst::of("no thickness");
    each(8, |random| {
        let case = Case::random(random, false, true);
        let (mut eta, mut thickness_nm) = (case.stack.eta.clone(), case.stack.thickness_nm.clone());
        let layer = random.below(thickness_nm.len() as u64 + 1) as usize;
        thickness_nm.insert(layer, 0.0);
        eta.insert(layer + 1, random.medium(false));
        equal(&mut worst, &case, &case.with(eta, thickness_nm), 0.0);
    });
    worst.report(0.0);
}

#[test]
fn a_plane_between_equal_media_changes_nothing() {
    let mut worst = Worst::of("index-matched");
    each(9, |random| {
        // A layer of the ambient medium on top, and one of the substrate below. Equal indices share a medium; two media
        // of equal index would give the same, since equal κ make r = 0.
        let mut case = Case::random(random, false, false);
        let last = case.stack.eta.len() - 1;
        case.stack.eta[last] = random.dielectric();
        let (mut eta, mut thickness_nm) = (case.stack.eta.clone(), case.stack.thickness_nm.clone());
        eta.insert(0, eta[0]);
        thickness_nm.insert(0, random.between(0.0, 1000.0));
        if case.sin_theta() * case.stack.eta[0].re < case.stack.eta[last].re {
            eta.push(eta[last + 1]);
            thickness_nm.push(random.between(0.0, 1000.0));
        }
        equal(&mut worst, &case, &case.with(eta, thickness_nm), 0.0);
    });
    worst.report(0.0);
}
