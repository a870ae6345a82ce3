//! What lies behind a planar scene, for the light that it transmits.

use goniochrome::optics::interface::Below;
use num_complex::Complex64;

use crate::solve::planar_scene::PlanarScene;
use crate::support::error::Result;

/// The medium behind a planar scene.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Backing {
    /// A mirror, or a medium that swallows the light: nothing is seen behind the surface.
    Opaque,
    /// The medium in front of the surface: a sheet, such as the film of a soap bubble, which light crosses straight.
    Ambient,
    /// Another medium that light crosses, such as glass: a body that refracts.
    Body,
}

/// Depth that half of the light must reach in a transparent medium.
const CLEAR_NM: f64 = 1e6;
/// Largest difference of two indices that are one medium: air has 1.0003.
const MAX_DIFFERENCE: f64 = 1e-3;

impl Backing {
    /// The medium behind a scene at some wavelengths in nm.
    ///
    /// # Errors
    /// A medium without data at a wavelength.
    pub fn of(planar: &PlanarScene<'_>, wavelength_nm: &[f64]) -> Result<Self> {
        let mut buffer = planar.buffer();
        let stack = planar.stack(&mut buffer)?;
        let Below::Medium(substrate) = stack.substrate() else { return Ok(Self::Opaque) };
        let media = planar.media();
        let eta = |medium: u16, nm: f64| -> Result<Complex64> {
            let medium = usize::from(medium);
            media[medium].eta(nm).map_err(|error| planar.scene().medium_error(medium, &error))
        };
        let mut is_ambient = true;
        for &nm in wavelength_nm {
            let (above, below) = (eta(stack.ambient(), nm)?, eta(substrate, nm)?);
            let reaches = (-4.0 * std::f64::consts::PI * below.im * CLEAR_NM / nm).exp();
            if reaches < 0.5 {
                return Ok(Self::Opaque);
            }
            is_ambient &= (above - below).norm() <= MAX_DIFFERENCE;
        }
        Ok(if is_ambient { Self::Ambient } else { Self::Body })
    }
}
