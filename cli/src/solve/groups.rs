//! The media of a scene at every group of wavelengths that fits the lanes.

use goniochrome::optics::medium::{MediaLanes, Medium, MediumError, MediumIndex};
use goniochrome::simd::complex::ComplexLanes;
use goniochrome::simd::lanes::Lanes;

/// Media at one group of wavelengths, and the wavelengths that are its own: lanes beyond the last repeat it.
pub type Group<'g, V> = (MediaLanes<'g, V>, &'g [f64]);

/// Memory for the groups of a list of wavelengths.
#[derive(Debug)]
pub struct Groups<V: Lanes>(Vec<Vec<ComplexLanes<V::Precise>>>);

impl<V: Lanes> Groups<V> {
    /// Memory for so many media at these wavelengths.
    #[must_use]
    pub fn new(media: usize, wavelength_nm: &[f64]) -> Self {
        Self(wavelength_nm.chunks(V::WIDTH).map(|_| vec![ComplexLanes::zero(); media]).collect())
    }

    /// Evaluates the media. Light arrives in the medium `ambient`: every computation passes here, so that none accepts
    /// an ambient medium that another refuses.
    ///
    /// # Errors
    /// The index of a medium and what it said: [`MediumError::Opaque`] of the ambient one, or no data.
    pub fn evaluate<'g>(
        &'g mut self,
        media: &[Medium<'_>],
        ambient: MediumIndex,
        wavelength_nm: &'g [f64],
    ) -> Result<Vec<Group<'g, V>>, (usize, MediumError)> {
        let place = usize::from(ambient);
        for &nm in wavelength_nm {
            media[place].ambient_eta(nm).map_err(|error| (place, error))?;
        }
        let groups = wavelength_nm.chunks(V::WIDTH).zip(&mut self.0);
        groups.map(|(own, eta)| Ok((MediaLanes::evaluate(media, own, eta)?, own))).collect()
    }
}
