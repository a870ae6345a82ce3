//! f(wi, wo) of surfaces that reflect into every direction.

use super::error::{MAX_MAGNITUDE, TableError};
use super::layout::{GridNode, ScatterLayout, azimuth, polar};
use super::values::Values;
use glam::Vec3;

/// BRDF on a grid of directions, in 1/sr, for each channel.
///
/// Channels are RGB, whose components are negative out of gamut, or wavelengths. Directions are unit vectors in the
/// surface frame; both leave the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScatterTable<'a> {
    layout: ScatterLayout,
    values: Values<'a>,
    channels: usize,
}

impl<'a> ScatterTable<'a> {
    /// Checks a table of `values[(incident * bins + bin) * channels + channel]`, each the mean of f over a bin.
    ///
    /// # Errors
    /// [`TableError::Shape`] if there are no channels, [`TableError::Length`] unless `values` has as many elements as
    /// the layout has pairs of directions, times channels, and [`TableError::NotFinite`] for a value that is NaN or
    /// beyond [`MAX_MAGNITUDE`].
    pub fn new(values: &'a [f32], layout: ScatterLayout, channels: usize) -> Result<Self, TableError> {
        Self::of(Values::Numbers(values), layout, channels)
    }

    pub(super) fn of(values: Values<'a>, layout: ScatterLayout, channels: usize) -> Result<Self, TableError> {
        if channels == 0 {
            return Err(TableError::Shape);
        }
        let required = layout.count().saturating_mul(channels);
        if values.len() != required {
            return Err(TableError::Length { required });
        }
        match values.iter().position(|x| !(-MAX_MAGNITUDE..=MAX_MAGNITUDE).contains(&x)) {
            Some(index) => Err(TableError::NotFinite { index }),
            None => Ok(Self { layout, values, channels }),
        }
    }

    /// Grid of directions.
    #[must_use]
    pub fn layout(&self) -> ScatterLayout {
        self.layout
    }

    /// Number of channels of each pair of directions.
    #[must_use]
    pub fn channels(&self) -> usize {
        self.channels
    }

    /// Index of the first channel of a pair of directions.
    #[inline]
    fn index(&self, incident: usize, bin: usize) -> usize {
        (incident * self.layout.bins().count() + bin) * self.channels
    }

    /// All channels of a pair of directions.
    pub(super) fn pair(&self, incident: usize, bin: usize) -> impl Iterator<Item = f32> + use<'a> {
        self.values.part(self.index(incident, bin), self.channels).iter()
    }

    pub(super) fn values(&self) -> Values<'a> {
        self.values
    }

    /// Adds the channels of a pair of directions, times `weight`, to `out`.
    #[inline]
    fn add(&self, out: &mut [f32], incident: usize, bin: usize, weight: f32) {
        let first = self.index(incident, bin);
        for (channel, out) in out.iter_mut().enumerate().take(self.channels) {
            *out += weight * self.values.at(first + channel);
        }
    }

    /// Writes f(wi, wo) to `out`, in 1/sr, without the cosine; 0 if either direction is below the horizon.
    ///
    /// f is linear between the grid's directions ([`ScatterLayout`]). `out` receives as many channels as it has
    /// elements; elements beyond the table's channels become 0.
    #[inline]
    pub fn eval(&self, wi: Vec3, wo: Vec3, out: &mut [f32]) {
        out.fill(0.0);
        let Some((incident, outgoing)) = self.layout.nodes(wi, wo) else { return };
        for i in incident {
            for o in outgoing {
                self.add(out, i.index, o.index, i.weight * o.weight);
            }
        }
    }

    /// First three channels of f(wi, wo), as [`ScatterTable::eval`] gives them. A table with fewer channels repeats its
    /// last.
    #[must_use]
    #[inline]
    pub fn rgb(&self, wi: Vec3, wo: Vec3) -> [f32; 3] {
        let mut rgb = [0.0; 3];
        self.eval(wi, wo, &mut rgb);
        let [r, g, b] = rgb;
        match self.channels {
            1 => [r; 3],
            2 => [r, g, g],
            _ => [r, g, b],
        }
    }

    /// Writes the albedo ∫ f(wi, wo) cos θ_o dω_o to `out`: the fraction of the light from `wi` that is reflected, for
    /// each channel. It is the exact integral of [`ScatterTable::eval`]; 0 for `wi` below the horizon.
    ///
    /// It differs from the power that was counted in the bins by (f_first − f_last) 2π/(24 rows²), since f is constant
    /// beyond the middles of the first and the last row. Each call sums over all bins: keep the result.
    pub fn albedo(&self, wi: Vec3, out: &mut [f32]) {
        out.fill(0.0);
        let above = wi.z > 0.0;
        if !above {
            return;
        }
        for GridNode { index, weight } in self.layout.incident_nodes(polar(wi), azimuth(wi)) {
            for bin in 0..self.layout.bins().count() {
                self.add(out, index, bin, weight * self.layout.projected_share(bin));
            }
        }
    }
}
