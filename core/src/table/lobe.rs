//! Lobes of flat facets, which reflect light into exact directions.

use glam::{Mat3, Vec3};

/// Direction into which flat facets reflect, as a function of the direction of the light.
///
/// Light enters a medium of index n, relative to the one above, through horizontal planes: the tangential part of its
/// unit direction becomes −wi_t/n. There the orthogonal matrix M, a product of reflections by facets, acts. It leaves
/// through horizontal planes again, with n times the tangential part. With n = 1 the light never enters: wo = −M wi.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FacetLobe {
    /// Index n of the medium in which the facets lie, over that of the medium above.
    pub index: f32,
    /// Orthogonal matrix M, by columns.
    pub matrix: Mat3,
}

impl FacetLobe {
    /// Number of numbers of a lobe.
    pub const LEN: usize = 10;

    /// Numbers of the lobe: n, then the columns of M.
    #[must_use]
    pub fn to_numbers(&self) -> [f32; Self::LEN] {
        let [a, b, c, d, e, f, g, h, i] = self.matrix.to_cols_array();
        [self.index, a, b, c, d, e, f, g, h, i]
    }

    /// Lobe of the numbers that [`FacetLobe::to_numbers`] gives.
    #[must_use]
    pub fn from_numbers([index, a, b, c, d, e, f, g, h, i]: [f32; Self::LEN]) -> Self {
        Self { index, matrix: Mat3::from_cols_array(&[a, b, c, d, e, f, g, h, i]) }
    }

    /// Whether n is positive and M orthogonal, to single precision.
    pub(super) fn is_sound(&self) -> bool {
        const ROUNDING: f32 = 1e-4;
        let product = self.matrix * self.matrix.transpose();
        let errors = (product - Mat3::IDENTITY).to_cols_array();
        (1e-3..=1e3).contains(&self.index) && errors.iter().all(|error| error.abs() <= ROUNDING)
    }

    /// Direction into which light from the unit vector `wi` above the surface is reflected; `None` if that is not above
    /// the surface, by a cosine of 1e-6 at least.
    #[must_use]
    #[inline]
    pub fn direction(&self, wi: Vec3) -> Option<Vec3> {
        let inside = completed(-wi.x / self.index, -wi.y / self.index)?;
        let turned = self.matrix * Vec3::new(inside.x, inside.y, -inside.z);
        let up = turned.z > 0.0;
        let out = completed(turned.x * self.index, turned.y * self.index)?;
        (wi.z > 0.0 && up && out.z > 1e-6).then_some(out)
    }
}

/// Unit vector with z ≥ 0 of this tangential part; `None` if the part is longer than 1.
#[inline]
fn completed(x: f32, y: f32) -> Option<Vec3> {
    let square = 1.0 - x * x - y * y;
    (square >= 0.0).then(|| Vec3::new(x, y, libm::sqrtf(square)))
}
