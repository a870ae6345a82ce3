//! The media of a scene at every group of wavelengths that fits the lanes.

use goniochrome::optics::medium::{MediaLanes, Medium, MediumIndex};
use goniochrome::simd::complex::ComplexLanes;
use goniochrome::simd::lanes::Lanes;

use crate::scene::Scene;
use crate::solve::precision::{Precision, in_lanes};
use crate::support::error::Result;

/// Media at one group of wavelengths, and those wavelengths. Lanes beyond the last wavelength repeat it.
pub type Group<'g, V> = (MediaLanes<'g, V>, &'g [f64]);

/// Memory for the groups of a list of wavelengths.
#[derive(Debug)]
pub struct Groups<V: Lanes>(Vec<Vec<ComplexLanes<V::Precise>>>);

impl<V: Lanes> Groups<V> {
    /// Allocates memory for the media of a scene at these wavelengths.
    #[must_use]
    pub fn new(scene: &Scene, wavelength_nm: &[f64]) -> Self {
        Self(wavelength_nm.chunks(V::WIDTH).map(|_| vec![ComplexLanes::zero(); scene.media.len()]).collect())
    }

    /// Evaluates the media of a scene. Light arrives in the medium `ambient`. Every computation evaluates its media
    /// here, so that all refuse the same ambient media.
    ///
    /// # Errors
    /// An ambient medium that absorbs too much; a medium without data at one of the wavelengths.
    pub fn evaluate<'g>(
        &'g mut self,
        scene: &Scene,
        ambient: MediumIndex,
        wavelength_nm: &'g [f64],
    ) -> Result<Vec<Group<'g, V>>> {
        let media = media_of(scene);
        let place = usize::from(ambient);
        for &nm in wavelength_nm {
            media[place].ambient_eta(nm).map_err(|error| scene.medium_error(place, &error))?;
        }
        let groups = wavelength_nm.chunks(V::WIDTH).zip(&mut self.0);
        groups
            .map(|(own, eta)| {
                let media = MediaLanes::evaluate(&media, own, eta);
                Ok((media.map_err(|(index, error)| scene.medium_error(index, &error))?, own))
            })
            .collect()
    }
}

/// The media of a scene as the core takes them, in the scene's order.
pub(crate) fn media_of(scene: &Scene) -> Vec<Medium<'_>> {
    scene.media.iter().map(|named| named.medium.borrow()).collect()
}

/// The number of groups into which so many wavelengths are divided.
#[must_use]
pub fn group_count(wavelengths: usize, precision: Precision) -> usize {
    wavelengths.div_ceil(in_lanes!(precision, V => V::WIDTH))
}
