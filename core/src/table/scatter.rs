//! f(wi, wo) of surfaces that reflect into every direction.

use super::angles::MIN_COS;
use super::error::{MAX_MAGNITUDE, TableError};
use super::layout::ScatterLayout;
use super::lobe::FacetLobe;
use super::tents::tent_solid_angles;
use super::warp::HalfVectorWarp;
use crate::values::Values;
use glam::Vec3;

/// BRDF on a grid of directions, for each channel.
///
/// The table holds s = f(wi, wo) cos θ_i cos θ_o in 1/sr for each incident direction and each node of the warped square
/// of half vectors ([`HalfVectorWarp`]). Along a fixed half vector s varies slowly with the light: for facets it is
/// F D G/4 (Cook & Torrance 1982). So lobes move with the light instead of fading one into another.
///
/// Flat facets reflect into exact directions: [`FacetLobe`]. The table holds the fraction ρ of the light that each such
/// lobe reflects. f leaves them out; the albedo holds them.
///
/// Channels are RGB, whose components are negative out of gamut, or wavelengths. Directions are unit vectors in the
/// surface frame; both leave the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScatterTable<'a> {
    layout: ScatterLayout,
    warp: HalfVectorWarp<'a>,
    lobes: Values<'a>,
    values: Values<'a>,
    channels: usize,
}

impl<'a> ScatterTable<'a> {
    /// Checks a table of `values[(incident * places + place) * channels + channel]`: s at the nodes of the square, then
    /// ρ of the lobes. `lobes` holds [`FacetLobe::to_numbers`] of each lobe.
    ///
    /// # Errors
    /// [`TableError::Shape`] if there are no channels, [`TableError::Length`] unless `values` has as many elements as
    /// the layout has values, times channels, [`TableError::Lobe`] unless the lobes are as many as the layout says,
    /// with positive indices and orthogonal matrices, and [`TableError::NotFinite`] for a value that is NaN or beyond
    /// [`MAX_MAGNITUDE`].
    pub fn new(
        values: &'a [f32],
        layout: ScatterLayout,
        warp: HalfVectorWarp<'a>,
        lobes: &'a [[f32; FacetLobe::LEN]],
        channels: usize,
    ) -> Result<Self, TableError> {
        Self::of(Values::Numbers(values), layout, warp, Values::Numbers(lobes.as_flattened()), channels)
    }

    pub(super) fn of(
        values: Values<'a>,
        layout: ScatterLayout,
        warp: HalfVectorWarp<'a>,
        lobes: Values<'a>,
        channels: usize,
    ) -> Result<Self, TableError> {
        if channels == 0 {
            return Err(TableError::Shape);
        }
        let required = layout.count().saturating_mul(channels);
        if values.len() != required {
            return Err(TableError::Length { required });
        }
        let table = Self { layout, warp, lobes, values, channels };
        if lobes.len() != FacetLobe::LEN * layout.lobes() || !(0..layout.lobes()).all(|i| table.lobe(i).is_sound()) {
            return Err(TableError::Lobe);
        }
        match values.first_beyond(MAX_MAGNITUDE) {
            Some(index) => Err(TableError::NotFinite { index }),
            None => Ok(table),
        }
    }

    /// Grid of directions.
    #[must_use]
    pub fn layout(&self) -> ScatterLayout {
        self.layout
    }

    /// Warp of the square of half vectors.
    #[must_use]
    pub fn warp(&self) -> HalfVectorWarp<'a> {
        self.warp
    }

    /// Number of channels of each pair of directions.
    #[must_use]
    pub fn channels(&self) -> usize {
        self.channels
    }

    pub(super) fn values(&self) -> Values<'a> {
        self.values
    }

    pub(super) fn lobe_numbers(&self) -> Values<'a> {
        self.lobes
    }

    /// Index of the first channel of a value.
    #[inline]
    fn index(&self, incident: usize, place: usize) -> usize {
        (incident * self.layout.places() + place) * self.channels
    }

    /// All channels of a value.
    pub(super) fn at(&self, incident: usize, place: usize) -> impl Iterator<Item = f32> + use<'a> {
        self.values.part(self.index(incident, place), self.channels).iter()
    }

    /// Adds the channels of a value, times `weight`, to `out`.
    #[inline]
    fn add(&self, out: &mut [f32], incident: usize, place: usize, weight: f32) {
        let first = self.index(incident, place);
        for (channel, out) in out.iter_mut().enumerate().take(self.channels) {
            *out += weight * self.values.at(first + channel);
        }
    }

    /// Calls `add(incident, node, weight)` for all values between which f(wi, wo) is interpolated; the weights include
    /// 1/(cos θ_i cos θ_o).
    #[inline]
    fn between(&self, wi: Vec3, wo: Vec3, mut add: impl FnMut(usize, usize, f32)) {
        let above = wi.z > 0.0 && wo.z > 0.0;
        if !above {
            return;
        }
        let [x, y] = self.warp.warped(wi, wo, self.layout.origin(wi)).place;
        let (incident, nodes) = (self.layout.incident_nodes(wi), self.layout.square_nodes(x, y));
        let scale = 1.0 / (divisor(wi) * wo.z.max(MIN_COS));
        for i in incident.iter().filter(|i| i.weight > 0.0) {
            for node in nodes {
                add(i.index, node.index, i.weight * node.weight * scale);
            }
        }
    }

    /// Writes f(wi, wo) to `out`, in 1/sr, without the cosine and without lobes; 0 if either direction is below the
    /// horizon.
    ///
    /// f = s/(cos θ_i cos θ_o), with s linear between the grid's directions ([`ScatterLayout`]). Beyond the largest
    /// incident angle of the grid, s/cos θ_i is held. For θ_o at the horizon f grows as 1/cos θ_o; cos θ_o is held at
    /// [`MIN_COS`], so that f stays finite. `out` receives as many channels as it has elements; elements beyond the
    /// table's channels become 0.
    #[inline]
    pub fn eval(&self, wi: Vec3, wo: Vec3, out: &mut [f32]) {
        out.fill(0.0);
        self.between(wi, wo, |incident, node, weight| self.add(out, incident, node, weight));
    }

    /// First three channels of f(wi, wo), as [`ScatterTable::eval`] gives them. A table with fewer channels repeats its
    /// last.
    #[must_use]
    #[inline]
    pub fn rgb(&self, wi: Vec3, wo: Vec3) -> [f32; 3] {
        let mut rgb = [0.0; 3];
        self.between(wi, wo, |incident, node, weight| {
            let [r, g, b] = self.values.three(self.index(incident, node), self.channels);
            rgb = [rgb[0] + weight * r, rgb[1] + weight * g, rgb[2] + weight * b];
        });
        rgb
    }

    /// Lobe by its index, below [`ScatterLayout::lobes`].
    #[must_use]
    pub fn lobe(&self, index: usize) -> FacetLobe {
        let first = index * FacetLobe::LEN;
        FacetLobe::from_numbers(core::array::from_fn(|i| self.lobes.at(first + i)))
    }

    /// Writes the fraction ρ of the light from `wi` that a lobe reflects to `out`, for each channel, and returns the
    /// direction of the lobe; `None`, with zeros, if it is not above the horizon.
    pub fn reflected(&self, wi: Vec3, lobe: usize, out: &mut [f32]) -> Option<Vec3> {
        out.fill(0.0);
        if lobe >= self.layout.lobes() {
            return None;
        }
        let direction = self.lobe(lobe).direction(wi)?;
        for node in self.layout.incident_nodes(wi) {
            self.add(out, node.index, self.layout.node_count() + lobe, node.weight);
        }
        Some(direction)
    }

    /// Writes the albedo ∫ f(wi, wo) cos θ_o dω_o, lobes included, to `out`: the fraction of the light from `wi` that
    /// is reflected, for each channel; 0 for `wi` below the horizon.
    ///
    /// The integral is that of [`tent_solid_angles`]. Each call sums over all nodes: keep the result.
    pub fn albedo(&self, wi: Vec3, out: &mut [f32]) {
        out.fill(0.0);
        let above = wi.z > 0.0;
        if !above {
            return;
        }
        let incident = self.layout.incident_nodes(wi);
        let scale = 1.0 / divisor(wi);
        tent_solid_angles(&self.layout, &self.warp, wi, self.layout.origin(wi), |node, solid_angle| {
            for i in incident {
                self.add(out, i.index, node, i.weight * solid_angle * scale);
            }
        });
        for lobe in 0..self.layout.lobes() {
            if self.lobe(lobe).direction(wi).is_some() {
                for i in incident {
                    self.add(out, i.index, self.layout.node_count() + lobe, i.weight);
                }
            }
        }
    }
}

/// cos θ_i, held beyond the largest angle of the grid.
#[inline]
pub(super) fn divisor(wi: Vec3) -> f32 {
    /// Cosine of [`ScatterLayout::THETA_MAX`].
    const COS_MAX: f32 = 0.017_452_406;
    wi.z.max(COS_MAX)
}
