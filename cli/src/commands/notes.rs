//! Notes on standard error about the data and the convergence of a computation.

use crate::scene::{NamedMedium, Scene};
use crate::solve::waves::one_direction::WaveDiffraction;
use crate::solve::waves::{Accuracy, WaveCell};
use crate::support::error::Result;
use crate::support::progress::note;

/// Notes how many samples were computed with closed loops although `--method hits` was asked for.
pub(super) fn note_fall_backs(fell_back: usize, samples: usize, quiet: bool) {
    if fell_back > 0 {
        note(
            quiet,
            format_args!(
                "{fell_back} of {samples} samples do not converge hit by hit within the work allowed; \
                 their loops are closed, as by --method trace"
            ),
        );
    }
}

/// Notes what a scene says of its surface, and what was guessed or rounded in the data of media at these wavelengths.
pub(super) fn note_on_scene(scene: &Scene, wavelength_nm: &[f64], quiet: bool) {
    scene.notes.iter().for_each(|said| note(quiet, format_args!("{}: {said}", scene.name)));
    for NamedMedium { name, medium } in &scene.media {
        if let Some(said) = medium.note(wavelength_nm) {
            note(quiet, format_args!("{}: material {name}: {said}", scene.name));
        }
    }
}

/// Notes that rays start below a plate's front face.
pub(super) fn note_on_front(scene: &Scene, quiet: bool) {
    if scene.front.is_some() {
        note(
            quiet,
            format_args!("{}: rays leave the plate's front face out: angles are those in the plate", scene.name),
        );
    }
}

/// Notes how orders were computed by waves, and how well.
pub(super) fn note_on_waves(
    cell: &WaveCell<'_>,
    found: &[WaveDiffraction],
    accuracy: Accuracy,
    quiet: bool,
) -> Result<()> {
    let Some(worst) = found.iter().max_by(|a, b| a.error.total_cmp(&b.error)) else { return Ok(()) };
    let name = &cell.scene().name;
    let (method, error) = (cell.method(worst.wavelength_nm)?, worst.error);
    let orders = found.iter().map(|found| found.max_order).max().unwrap_or_default();
    note(quiet, format_args!("{name}: by waves ({method}, orders to ±{orders}), error bar {error:.1e}"));
    if let Some(missed) = found.iter().find(|found| !found.met) {
        let target = accuracy.target;
        note(
            quiet,
            format_args!(
                "{name}: {} nm: the error bar is {:.1e} with orders to ±{}, more than {target:.0e}; a larger \
                 --max-harmonic may lower it",
                missed.wavelength_nm, missed.error, missed.max_order
            ),
        );
    }
    Ok(())
}
