//! Notes on standard error about the data and the convergence of a computation.

use crate::scene::{NamedMedium, Scene};
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

/// Notes what was guessed or rounded in the data of media at these wavelengths.
pub(super) fn note_on_media(scene: &Scene, wavelength_nm: &[f64], quiet: bool) {
    for NamedMedium { name, medium } in &scene.media {
        if let Some(said) = medium.note(wavelength_nm) {
            note(quiet, format_args!("{}: material {name}: {said}", scene.name));
        }
    }
}
