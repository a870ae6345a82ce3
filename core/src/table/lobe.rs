//! Lobes of flat facets, which reflect light into exact directions.

use super::angles::MIN_COS;
use crate::simd::lanes::sqrtf;
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

    /// Lobe of facets with this unit normal, which light meets from above.
    #[must_use]
    pub fn reflection(normal: Vec3) -> Self {
        let outer = Mat3::from_cols(normal * normal.x, normal * normal.y, normal * normal.z);
        Self { index: 1.0, matrix: Mat3::IDENTITY - 2.0 * outer }
    }

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
    /// the surface, by a cosine of [`MIN_COS`] at least.
    #[must_use]
    #[inline]
    pub fn direction(&self, wi: Vec3) -> Option<Vec3> {
        let above = wi.z > 0.0;
        // Snell's law for the squares of the normal components, which for n = 1 is exact at grazing angles too:
        // 1 − z² = n² (1 − z'²).
        let n = self.index;
        let excess = (n - 1.0) * (n + 1.0);
        let inside = Vec3::new(-wi.x / n, -wi.y / n, -root((wi.z * wi.z + excess) / (n * n))?);
        let turned = self.matrix * inside;
        let out = Vec3::new(turned.x * n, turned.y * n, root(turned.z * turned.z * n * n - excess)?);
        (above && turned.z > 0.0 && out.z >= MIN_COS).then_some(out)
    }
}

/// Square root; `None` of a negative number or NaN.
#[inline]
fn root(square: f32) -> Option<f32> {
    (square >= 0.0).then(|| sqrtf(square))
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    fn unit(theta: f64, phi: f64) -> Vec3 {
        let ((sin, cos), (sin_phi, cos_phi)) = (libm::sincos(theta), libm::sincos(phi));
        DVec3::new(sin * cos_phi, sin * sin_phi, cos).as_vec3()
    }

    #[test]
    fn a_level_mirror_reflects_exactly_at_any_angle_and_index() {
        for index in [0.7, 1.0, 1.5, 4.0] {
            let lobe = FacetLobe { index, ..FacetLobe::reflection(Vec3::Z) };
            for theta in [0.0, 0.3, 1.0, 1.5, 1.57] {
                let wi = unit(theta, 2.0);
                let mirror = Vec3::new(-wi.x, -wi.y, wi.z);
                match lobe.direction(wi) {
                    // The root of what is left of n² after it was added and taken away.
                    Some(wo) if index != 1.0 => {
                        let rounding = 4.0 * f32::EPSILON * index * index / wi.z;
                        assert!((wo - mirror).length() < rounding, "{index} {theta}: {wo}");
                    }
                    Some(wo) => assert!((wo - mirror).length() < 2.0 * f32::EPSILON, "{theta}: {wo}"),
                    // Total reflection; and rounding of n² as large as the square of the cosine.
                    None => assert!(index < 1.0 && libm::sin(theta) > 0.7 || index > 1.0 && wi.z < 1e-3, "{theta}"),
                }
            }
        }
    }

    #[test]
    fn facets_reflect_by_the_law_of_reflection() {
        let normal = unit(0.4, 1.0).as_dvec3();
        let lobe = FacetLobe::reflection(normal.as_vec3());
        for [theta, phi] in [[0.0, 0.0], [0.5, 1.0], [0.9, -2.0], [1.3, 3.0]] {
            let wi = unit(theta, phi);
            let expected = 2.0 * wi.as_dvec3().dot(normal) * normal - wi.as_dvec3();
            match lobe.direction(wi) {
                Some(wo) => assert!((wo.as_dvec3() - expected).length() < 1e-6, "{theta} {phi}: {wo}"),
                None => assert!(expected.z < 2e-6, "{theta} {phi}: {expected}"),
            }
        }
        assert_eq!(lobe.direction(-Vec3::Z), None);
    }

    #[test]
    fn a_lobe_is_reversible() {
        let by = |x, y| FacetLobe::reflection(Vec3::new(x, y, 1.0).normalize()).matrix;
        let matrix = by(0.1, 0.2) * by(-0.3, 0.1) * by(0.0, 0.0);
        let (there, back) = (FacetLobe { index: 1.4, matrix }, FacetLobe { index: 1.4, matrix: matrix.transpose() });
        let mut count = 0;
        for i in 0..100u8 {
            let wi = unit(f64::from(i) * 0.014, f64::from(i) * 2.4);
            if let Some(wo) = there.direction(wi) {
                let returned = back.direction(wo).expect("the way back");
                assert!((returned - wi).length() < 1e-5 / wo.z.min(wi.z), "{wi}: {returned}");
                count += 1;
            }
        }
        assert!(count > 40, "{count}");
    }

    #[test]
    fn what_is_no_lobe_is_not_sound() {
        let FacetLobe { matrix, .. } = FacetLobe::reflection(unit(0.4, 0.6));
        assert!(FacetLobe { index: 1.5, matrix }.is_sound());
        for index in [0.0, -1.0, f32::NAN, f32::INFINITY, 2e3] {
            assert!(!FacetLobe { index, matrix }.is_sound());
        }
        for matrix in [Mat3::ZERO, matrix * 1.001, Mat3::from_diagonal(Vec3::new(1.0, f32::NAN, 1.0))] {
            assert!(!FacetLobe { index: 1.0, matrix }.is_sound());
        }
        let lobe = FacetLobe { index: 1.5, matrix };
        assert_eq!(FacetLobe::from_numbers(lobe.to_numbers()), lobe);
    }
}
