//! Spectra and colours of planar scenes, with a progress bar and notes.

use goniochrome::colour::Illuminant;

use crate::commands::args::Computing;
use crate::commands::notes::{note_fall_backs, note_on_scene};
use crate::solve::fidelity;
use crate::solve::grid::Wavelengths;
use crate::solve::planar_scene::PlanarScene;
use crate::solve::refine::{Choice, max_wavelengths};
use crate::solve::spectra::{Spectra, spectra};
use crate::support::error::Result;
use crate::support::progress::{bar, note};

/// Computes spectra over a grid with a progress bar. Notes how many wavelengths `auto` has chosen, and how accurate
/// their colours are.
pub(super) fn compute_spectra(
    planar: &PlanarScene<'_>,
    theta_deg: &[f64],
    wavelengths: &Wavelengths,
    illuminant: Illuminant,
    computing: &Computing,
) -> Result<Spectra> {
    let request = computing.request();
    let quiet = computing.running.quiet;
    let Choice { wavelength_nm, xyz } = wavelengths.resolve(planar, theta_deg, illuminant, &request)?;
    note_on_scene(planar.scene(), &wavelength_nm, quiet);
    let progress = bar(&planar.scene().name, theta_deg.len(), quiet);
    let spectra = spectra(planar, theta_deg, &wavelength_nm, &request, &|| progress.inc(1))?;
    progress.finish_and_clear();
    note_fall_backs(spectra.fell_back, spectra.samples.len(), quiet);
    if let (Wavelengths::Auto(_), [first, .., last]) = (wavelengths, wavelength_nm.as_slice()) {
        let mut said = format!("{} wavelengths from {first} to {last} nm", wavelength_nm.len());
        if wavelength_nm.len() == max_wavelengths(theta_deg.len()) {
            said += ", the most that a table holds";
        }
        /// The smallest error that is shown: errors below the last digit are not shown as 0.
        const MIN_SHOWN: f64 = 0.01;
        // Invisible wavelengths have no colour.
        if let Ok((error, theta)) = fidelity::largest_error(&spectra, &xyz, illuminant) {
            let error = error.max(MIN_SHOWN);
            said += &format!("; their colours are within ΔE2000 {error:.2} of the integral's (at {theta}°)");
        }
        note(quiet, said);
    }
    Ok(spectra)
}

/// Notes what is wrong with the wavelengths from which colours are made.
pub(super) fn note_on_colours(
    planar: &PlanarScene<'_>,
    spectra: &Spectra,
    wavelengths: &Wavelengths,
    illuminant: Illuminant,
    computing: &Computing,
) -> Result<()> {
    if computing.running.quiet {
        return Ok(());
    }
    let left_out = fidelity::left_out(&spectra.wavelength_nm, illuminant)?;
    left_out.into_iter().for_each(|said| note(false, said));
    if matches!(wavelengths, Wavelengths::List(_)) {
        match fidelity::too_few(planar, spectra, illuminant, &computing.request()) {
            Ok(too_few) => too_few.into_iter().for_each(|said| note(false, said)),
            Err(error) => note(false, format_args!("whether the wavelengths are enough is not known: {error}")),
        }
    }
    Ok(())
}
