//! Mirror-like surfaces with all that such a table may hold: transmittance, a thickness that varies, a finish.

use super::angle_axis::AngleAxis;
use super::angles::angle_of_cosine;
use super::error::{MAX_MAGNITUDE, TableError};
use super::mirror::MirrorTable;
use crate::microfacet::Finish;
use crate::values::Values;
use glam::Vec3;

/// Largest thickness of a table in nm.
const MAX_THICKNESS_NM: f32 = 1e9;

/// Arrays of a [`FilmTable`].
#[derive(Clone, Copy, Debug)]
pub struct FilmArrays<'a> {
    /// Reflectance ρ, `[thickness][angle][channel]`.
    pub reflectance: &'a [f32],
    /// Transmittance like the reflectance, or empty.
    pub transmittance: &'a [f32],
    /// Thicknesses in nm of the layer that varies, increasing. Any one number for a surface of which none does.
    pub thickness_nm: &'a [f32],
}

/// BRDF of a mirror-like surface, smooth or with a [`Finish`], and its transmittance.
///
/// A smooth surface reflects ρ(θ) into the mirror direction: f(wi, wo) = ρ(θ) δ(wo − mirror(wi))/cos θ. With a finish
/// f(wi, wo) = ρ(θ_d) D G₂/(4 cos θ_i cos θ_o), with θ_d the angle to the half vector, and the light that several
/// bounces return where the finish has a [`Compensation`](crate::microfacet::Compensation). f is in 1/sr, without the
/// cosine.
///
/// Angles are uniform from 0 to the largest, ends included. Values are linear between angles and between thicknesses,
/// and constant beyond the ends of either. A table with fewer than three channels repeats its last.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FilmTable<'a> {
    reflectance: Values<'a>,
    /// Empty where the table has none.
    transmittance: Values<'a>,
    thickness_nm: Values<'a>,
    axis: AngleAxis,
    channels: usize,
    finish: Option<Finish<'a>>,
    /// What several bounces return, `[thickness][channel]`; empty without compensation.
    returned: Values<'a>,
}

/// Direction that [`FilmTable::sample`] has drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FilmSample {
    /// Direction, a unit vector if wi is one.
    pub wo: Vec3,
    /// Density per solid angle; `None` for the mirror direction of a smooth surface, which has none.
    pub pdf: Option<f32>,
    /// RGB of f cos θ_o over the density; ρ of a smooth surface.
    pub weight: [f32; 3],
}

impl<'a> FilmTable<'a> {
    /// Checks a table; `theta_max` is the largest angle in radians.
    ///
    /// # Errors
    /// [`TableError::Shape`] for fewer than two angles, no channels, or arrays whose lengths do not fit together;
    /// [`TableError::Thickness`] unless thicknesses increase from 0 or more to 10⁹ nm or less;
    /// [`TableError::ThetaMax`] unless `theta_max` is in (0, π/2]; [`TableError::NotFinite`] for a value that is NaN or
    /// beyond [`MAX_MAGNITUDE`], by its index in the reflectance, or in the transmittance behind it.
    pub fn new(
        arrays: &FilmArrays<'a>,
        channels: usize,
        theta_max: f64,
        finish: Option<Finish<'a>>,
    ) -> Result<Self, TableError> {
        let values = [arrays.reflectance, arrays.transmittance].map(Values::Numbers);
        Self::of(values, Values::Numbers(arrays.thickness_nm), channels, theta_max, finish)
    }

    pub(super) fn of(
        [reflectance, transmittance]: [Values<'a>; 2],
        thickness_nm: Values<'a>,
        channels: usize,
        theta_max: f64,
        finish: Option<Finish<'a>>,
    ) -> Result<Self, TableError> {
        let count = reflectance.len();
        let rows = channels.checked_mul(thickness_nm.len()).and_then(|of_angle| count.checked_div(of_angle));
        let rows = rows.unwrap_or(0);
        // The product is at most the length.
        let fits = rows * channels * thickness_nm.len() == count;
        if !fits || !(transmittance.len() == 0 || transmittance.len() == count) {
            return Err(TableError::Shape);
        }
        let axis = AngleAxis::new(rows, theta_max)?;
        let mut least = 0.0;
        for (index, nm) in thickness_nm.iter().enumerate() {
            if !(least..=MAX_THICKNESS_NM).contains(&nm) || (index > 0 && nm <= least) {
                return Err(TableError::Thickness);
            }
            least = nm;
        }
        let second = transmittance.first_beyond(MAX_MAGNITUDE).map(|index| count + index);
        match reflectance.first_beyond(MAX_MAGNITUDE).or(second) {
            Some(index) => Err(TableError::NotFinite { index }),
            None => {
                let returned = Values::Numbers(&[]);
                Ok(Self { reflectance, transmittance, thickness_nm, axis, channels, finish, returned })
            }
        }
    }

    /// The table of a finish with compensation, with what its facets return in each channel, `[thickness][channel]`, by
    /// [`Compensation::returned`](crate::microfacet::Compensation::returned). Without it nothing is returned.
    ///
    /// # Errors
    /// [`TableError::Finish`] for a surface without compensation, [`TableError::Shape`] unless there is a number for
    /// each thickness and channel, [`TableError::NotFinite`] for a number that is NaN or beyond [`MAX_MAGNITUDE`].
    pub fn with_returned(mut self, returned: &'a [f32]) -> Result<Self, TableError> {
        self.set_returned(Values::Numbers(returned))?;
        Ok(self)
    }

    pub(super) fn set_returned(&mut self, returned: Values<'a>) -> Result<(), TableError> {
        if !self.finish.as_ref().is_some_and(Finish::is_compensated) {
            return Err(TableError::Finish);
        }
        if returned.len() != self.channels * self.thicknesses() {
            return Err(TableError::Shape);
        }
        match returned.first_beyond(MAX_MAGNITUDE) {
            Some(index) => Err(TableError::NotFinite { index }),
            None => {
                self.returned = returned;
                Ok(())
            }
        }
    }

    /// Number of angles.
    #[must_use]
    pub fn angles(&self) -> usize {
        self.axis.rows()
    }

    /// Largest angle, in radians.
    #[must_use]
    pub fn theta_max(&self) -> f64 {
        self.axis.theta_max()
    }

    /// Number of channels.
    #[must_use]
    pub fn channels(&self) -> usize {
        self.channels
    }

    /// Number of thicknesses; 1 where none varies.
    #[must_use]
    pub fn thicknesses(&self) -> usize {
        self.thickness_nm.len()
    }

    /// First and last thickness in nm.
    #[must_use]
    pub fn range_nm(&self) -> [f32; 2] {
        [0, self.thicknesses() - 1].map(|index| self.thickness_nm.at(index))
    }

    /// Whether the table holds transmittance.
    #[must_use]
    pub fn is_transparent(&self) -> bool {
        self.transmittance.len() > 0
    }

    /// Finish; `None` for a smooth surface.
    #[must_use]
    pub fn finish(&self) -> Option<Finish<'a>> {
        self.finish
    }

    /// Looks up RGB of the reflectance ρ(θ) at a cosine, for a thickness in nm. Cosines are clamped to [0, 1]; NaN
    /// counts as 0.
    #[must_use]
    pub fn reflectance(&self, cos_theta: f32, thickness_nm: f32) -> [f32; 3] {
        self.rgb(self.reflectance, angle(cos_theta), thickness_nm)
    }

    /// Looks up RGB of the transmittance at a cosine, for a thickness in nm; 0 where the table has none. It is that of
    /// the smooth surface: a finish is one of reflected light.
    #[must_use]
    pub fn transmittance(&self, cos_theta: f32, thickness_nm: f32) -> [f32; 3] {
        self.rgb(self.transmittance, angle(cos_theta), thickness_nm)
    }

    /// Looks up RGB of f in 1/sr, without the cosine, for unit vectors and a thickness in nm. It is 0 if either is
    /// below the surface, and for a smooth surface.
    #[must_use]
    #[inline]
    pub fn eval(&self, wi: Vec3, wo: Vec3, thickness_nm: f32) -> [f32; 3] {
        self.eval_and_pdf(wi, wo, thickness_nm).0
    }

    /// Density per solid angle with which [`FilmTable::sample`] draws `wo` for `wi`; 0 if either is below the surface,
    /// and for a smooth surface.
    #[must_use]
    #[inline]
    pub fn pdf(&self, wi: Vec3, wo: Vec3) -> f32 {
        self.finish.as_ref().and_then(|finish| finish.lobe(wi, wo)).map_or(0.0, |lobe| lobe.pdf)
    }

    /// [`FilmTable::eval`] and [`FilmTable::pdf`] for the price of one.
    #[must_use]
    #[inline]
    pub fn eval_and_pdf(&self, wi: Vec3, wo: Vec3, thickness_nm: f32) -> ([f32; 3], f32) {
        if self.finish.as_ref().is_some_and(Finish::is_compensated) {
            return self.look_up_several(wi.x, wi.y, wi.z, wo.x, wo.y, wo.z, thickness_nm);
        }
        self.look_up(wi.x, wi.y, wi.z, wo.x, wo.y, wo.z, thickness_nm)
    }

    /// RGB and density of facets alone, of numbers, which come in registers. Vectors come in memory, just written, and
    /// two components that are read at once wait until both have arrived there: 30 ns.
    #[inline(never)]
    #[allow(clippy::too_many_arguments, reason = "two vectors, number by number")]
    fn look_up(&self, xi: f32, yi: f32, zi: f32, xo: f32, yo: f32, zo: f32, thickness_nm: f32) -> ([f32; 3], f32) {
        let (wi, wo) = (Vec3::new(xi, yi, zi), Vec3::new(xo, yo, zo));
        let lobe = self.finish.as_ref().and_then(|finish| finish.lobe_of_facets(wi, wo));
        let Some(lobe) = lobe else { return ([0.0; 3], 0.0) };
        let rho = self.rgb(self.reflectance, angle_of_cosine(lobe.cos_d), thickness_nm);
        // Directions near the horizon may reflect more than single precision holds.
        (rho.map(|rho| (rho * lobe.value).clamp(f32::MIN, f32::MAX)), lobe.pdf)
    }

    /// [`FilmTable::look_up`] with what several bounces return.
    #[inline(never)]
    #[allow(clippy::too_many_arguments, reason = "two vectors, number by number")]
    fn look_up_several(&self, xi: f32, yi: f32, zi: f32, xo: f32, yo: f32, zo: f32, nm: f32) -> ([f32; 3], f32) {
        let (rgb, pdf) = self.look_up(xi, yi, zi, xo, yo, zo, nm);
        let Some(finish) = &self.finish else { return (rgb, pdf) };
        let (multiple, pdf) = finish.several(zi, zo, pdf);
        let returned = self.returned_at(nm);
        (core::array::from_fn(|c| (rgb[c] + returned[c] * multiple).clamp(f32::MIN, f32::MAX)), pdf)
    }

    /// RGB of what several bounces return, for a thickness in nm.
    fn returned_at(&self, thickness_nm: f32) -> [f32; 3] {
        let at = |thickness: usize| self.returned.three(self.channels * thickness, self.channels);
        if self.thicknesses() == 1 {
            return at(0);
        }
        let (below, across) = self.locate_thickness(thickness_nm);
        mixed([below, below + 1].map(at), across)
    }

    /// Draws wo for the unit vector `wi` and a thickness in nm: by a finish among the facets that `wi` sees, with `u`
    /// in [0, 1)², else the mirror direction. `None` if `wi` is below the surface, or a facet reflects below it: that
    /// is a sample without light, and counts.
    #[must_use]
    pub fn sample(&self, wi: Vec3, u: [f32; 2], thickness_nm: f32) -> Option<FilmSample> {
        let Some(finish) = &self.finish else {
            let above = wi.z > 0.0;
            let wo = Vec3::new(-wi.x, -wi.y, wi.z);
            return above.then(|| FilmSample { wo, pdf: None, weight: self.reflectance(wi.z, thickness_nm) });
        };
        let wo = finish.sample(wi, u)?;
        if finish.is_compensated() {
            let (f, pdf) = self.eval_and_pdf(wi, wo, thickness_nm);
            let weight = f.map(|f| f * (wo.z / pdf));
            return (pdf > 0.0).then_some(FilmSample { wo, pdf: Some(pdf), weight });
        }
        let lobe = finish.lobe(wi, wo)?;
        let pdf = lobe.pdf;
        // f cos θ_o over the density; where it is that of visible normals without D, as both may be too small for
        // single precision.
        let share = match finish.distribution() {
            Some(_) => 4.0 * finish.visible_area(wi) * finish.shadowing(wi, wo) * wo.z,
            None => lobe.value * wo.z / pdf,
        };
        let weight = self.rgb(self.reflectance, angle_of_cosine(lobe.cos_d), thickness_nm).map(|rho| rho * share);
        (pdf > 0.0).then_some(FilmSample { wo, pdf: Some(pdf), weight })
    }

    /// RGB of one of the quantities at θ in radians.
    #[inline]
    fn rgb(&self, quantity: Values<'a>, theta: f32, thickness_nm: f32) -> [f32; 3] {
        let (row, along) = self.axis.locate(theta);
        // The common case in memory, with one check of the bounds.
        if let (Values::Numbers(numbers), 3, 1) = (quantity, self.channels, self.thicknesses())
            && let Some(&[a, b, c, d, e, f]) = numbers.get(3 * row..).and_then(<[f32]>::first_chunk)
        {
            return [a + along * (d - a), b + along * (e - b), c + along * (f - c)];
        }
        let at = |thickness: usize| {
            let from = self.channels * (thickness * self.axis.rows() + row);
            let [low, high] = [from, from + self.channels].map(|from| quantity.three(from, self.channels));
            core::array::from_fn(|c| low[c] + along * (high[c] - low[c]))
        };
        if self.thicknesses() == 1 {
            return at(0);
        }
        let (below, across) = self.locate_thickness(thickness_nm);
        mixed([below, below + 1].map(at), across)
    }

    /// Thickness before one in nm, of two or more, and the position between it and the next, in [0, 1]. NaN counts as
    /// 0.
    fn locate_thickness(&self, nm: f32) -> (usize, f32) {
        // The thickness lies between those of these indices, or beyond the ends.
        let (mut below, mut above) = (0, self.thicknesses() - 1);
        while above - below > 1 {
            let middle = usize::midpoint(below, above);
            if self.thickness_nm.at(middle) <= nm { below = middle } else { above = middle }
        }
        let [thin, thick] = [below, above].map(|index| self.thickness_nm.at(index));
        (below, clamped((nm - thin) / (thick - thin)))
    }

    /// Reflectance and transmittance.
    pub(super) fn values(&self) -> [Values<'a>; 2] {
        [self.reflectance, self.transmittance]
    }

    pub(super) fn thickness_values(&self) -> Values<'a> {
        self.thickness_nm
    }

    pub(super) fn returned_values(&self) -> Values<'a> {
        self.returned
    }
}

/// A smooth surface of one thickness.
impl<'a> From<MirrorTable<'a>> for FilmTable<'a> {
    fn from(mirror: MirrorTable<'a>) -> Self {
        Self {
            reflectance: mirror.values(),
            transmittance: Values::Numbers(&[]),
            thickness_nm: Values::Numbers(&[0.0]),
            axis: mirror.axis(),
            channels: mirror.channels(),
            finish: None,
            returned: Values::Numbers(&[]),
        }
    }
}

/// Colour between two.
#[inline]
fn mixed([thin, thick]: [[f32; 3]; 2], across: f32) -> [f32; 3] {
    core::array::from_fn(|c| thin[c] + across * (thick[c] - thin[c]))
}

/// Number clamped to [0, 1]; NaN counts as 0.
#[inline]
fn clamped(x: f32) -> f32 {
    let positive = x.max(0.0);
    positive.min(1.0)
}

/// Angle θ of a cosine, which is clamped to [0, 1]; that of NaN is π/2.
#[inline]
fn angle(cos_theta: f32) -> f32 {
    angle_of_cosine(clamped(cos_theta))
}

#[cfg(test)]
#[path = "film_tests.rs"]
mod tests;
