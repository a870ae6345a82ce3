//! f(wi, wo) of a surface that reflects into every direction.

use super::layout::{azimuth, polar};
use super::{LARGEST, Node, ScatterLayout, TableError, Values};
use glam::Vec3;

/// A BRDF on a grid of directions, in 1/sr, for each channel: RGB (components may be negative, out of gamut) or wavelengths.
///
/// Directions are unit vectors in the surface frame; both leave the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScatterTable<'a> {
    layout: ScatterLayout,
    values: Values<'a>,
    channels: usize,
}

impl<'a> ScatterTable<'a> {
    /// Checks a table: `values[(incident * bins + bin) * channels + channel]`, the mean of f over each bin.
    ///
    /// # Errors
    /// [`TableError::Shape`] without channels, [`TableError::Length`], [`TableError::NotFinite`].
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
        match values.iter().position(|x| !(-LARGEST..=LARGEST).contains(&x)) {
            Some(index) => Err(TableError::NotFinite { index }),
            None => Ok(Self { layout, values, channels }),
        }
    }

    /// The grid of directions.
    #[must_use]
    pub fn layout(&self) -> ScatterLayout {
        self.layout
    }

    /// Channels of one pair of directions.
    #[must_use]
    pub fn channels(&self) -> usize {
        self.channels
    }

    /// Where the channels of one pair begin.
    #[inline]
    fn place(&self, incident: usize, bin: usize) -> usize {
        (incident * self.layout.bins().count() + bin) * self.channels
    }

    /// All channels of one pair.
    pub(super) fn pair(&self, incident: usize, bin: usize) -> impl Iterator<Item = f32> + use<'a> {
        self.values.part(self.place(incident, bin), self.channels).iter()
    }

    pub(super) fn values(&self) -> Values<'a> {
        self.values
    }

    /// Adds a share of one pair.
    #[inline]
    fn add(&self, out: &mut [f32], incident: usize, bin: usize, weight: f32) {
        let place = self.place(incident, bin);
        for (channel, out) in out.iter_mut().enumerate().take(self.channels) {
            *out += weight * self.values.at(place + channel);
        }
    }

    /// f(wi, wo) into `out`, in 1/sr, without the cosine; 0 below the horizon. Linear between the grid's directions
    /// ([`ScatterLayout`]). Channels beyond the shorter of `out` and the table are left out.
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

    /// The first three channels of f(wi, wo); a table of fewer repeats its last.
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

    /// ∫ f(wi, wo) cos θ_o dω_o into `out`: the fraction of the light from `wi` that is reflected, for each channel. Exactly the
    /// integral of [`ScatterTable::eval`]; 0 for `wi` below the horizon.
    ///
    /// It differs from the power that was counted in the bins by the holding of f at the horizon and at the normal,
    /// (f_first − f_last) 2π/(24 rows²). Takes a sum over all bins: keep the result.
    pub fn albedo(&self, wi: Vec3, out: &mut [f32]) {
        out.fill(0.0);
        let above = wi.z > 0.0;
        if !above {
            return;
        }
        for Node { index, weight } in self.layout.incident_nodes(polar(wi), azimuth(wi)) {
            for bin in 0..self.layout.bins().count() {
                self.add(out, index, bin, weight * self.layout.projected_share(bin));
            }
        }
    }
}
