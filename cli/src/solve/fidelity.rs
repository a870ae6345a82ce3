//! The accuracy of the colours of sampled spectra, for notes to the user.

use goniochrome::colour::{Illuminant, Quadrature, VISIBLE_NM, xyz};

use crate::colour::difference::{delta_e, lab_of_xyz};
use crate::colour::visible_weights;
use crate::solve::integral::Integral;
use crate::solve::planar_scene::PlanarScene;
use crate::solve::spectra::{Spectra, SpectraRequest};
use crate::support::error::Result;

/// The largest ΔE2000 without a note.
const MAX_DELTA_E: f64 = 0.5;
/// The smallest share of X, Y and Z of white that a range holds without a note.
const MIN_SHARE: f64 = 0.99;

/// The largest ΔE2000 between the colours of samples and those of the integral, and its angle.
///
/// # Errors
/// None of the wavelengths is visible.
pub fn largest_error(spectra: &Spectra, exact: &[[f64; 3]], illuminant: Illuminant) -> Result<(f64, f64)> {
    let weights = visible_weights(&spectra.wavelength_nm, illuminant, Quadrature::Interpolated)?;
    let white = xyz(&weights, weights.iter().map(|_| 1.0));
    let errors = exact.iter().enumerate().map(|(angle, &exact)| {
        let found = xyz(&weights, spectra.row(angle).iter().map(|sample| sample.mean_reflectance()));
        (delta_e(lab_of_xyz(exact, white), lab_of_xyz(found, white)), spectra.theta_deg[angle])
    });
    Ok(errors.fold((0.0, 0.0), |worst, error| if error.0 > worst.0 { error } else { worst }))
}

/// A note if the wavelengths from which colours are made leave out a part of the visible range.
///
/// # Errors
/// None of the wavelengths is visible.
pub fn left_out(wavelength_nm: &[f64], illuminant: Illuminant) -> Result<Option<String>> {
    let &[first, .., last] = wavelength_nm else {
        return Ok(Some(
            "one wavelength has no colour; the colours are those of a reflectance that is the same at all".into(),
        ));
    };
    let [x, y, z] = share_of_white(first, last, illuminant)?;
    if x.min(y).min(z) >= MIN_SHARE {
        return Ok(None);
    }
    let [x, y, z] = [x, y, z].map(|share| 100.0 * share);
    Ok(Some(format!(
        "{first} to {last} nm hold {y:.0} % of white's Y, {x:.0} % of its X and {z:.0} % of its Z; beyond, the reflectance at \
         the ends is held"
    )))
}

/// A note if wavelengths are too few for the colours of a scene. They must increase, and some must be visible.
///
/// # Errors
/// A medium without data in the visible range; an optical path of more than some millimetres.
pub fn too_few(
    planar: &PlanarScene<'_>,
    spectra: &Spectra,
    illuminant: Illuminant,
    request: &SpectraRequest,
) -> Result<Option<String>> {
    let &[first, .., last] = spectra.wavelength_nm.as_slice() else { return Ok(None) };
    let range = [first.max(VISIBLE_NM[0].into()), last.min(VISIBLE_NM[1].into())];
    let exact = Integral::new(planar, range, illuminant, request)?.colours(&spectra.theta_deg)?;
    let (error, theta) = largest_error(spectra, &exact, illuminant)?;
    Ok((error > MAX_DELTA_E).then(|| {
        format!(
            "{} wavelengths are too few for this scene: its colours err by up to ΔE2000 {error:.1} (at {theta}°); give \
             --wavelengths auto",
            spectra.wavelength_nm.len()
        )
    }))
}

/// The shares of X, Y and Z of white that lie in a range.
fn share_of_white(first: f64, last: f64, illuminant: Illuminant) -> Result<[f64; 3]> {
    let every_nm: Vec<f64> = (VISIBLE_NM[0]..=VISIBLE_NM[1]).map(f64::from).collect();
    let weights = visible_weights(&every_nm, illuminant, Quadrature::Interpolated)?;
    let white = xyz(&weights, every_nm.iter().map(|_| 1.0));
    let inside = xyz(&weights, every_nm.iter().map(|nm| f64::from(u8::from((first..=last).contains(nm)))));
    Ok(std::array::from_fn(|c| inside[c] / white[c]))
}
