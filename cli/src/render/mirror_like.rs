//! Mirror-like tables in the channels in which light is traced.

use super::body::{Body, SurfaceHit};
use super::thickness::ThicknessMap;
use crate::table::mirror::neighbours;

/// Reflectance and transmittance of a mirror-like surface.
#[derive(Clone, Debug)]
pub(super) struct MirrorLike {
    /// Angles in degrees.
    pub theta_deg: Vec<f64>,
    /// ρ(θ), `[thickness][theta][channel]`.
    pub reflected: Vec<f32>,
    /// The transmittance like ρ, or empty: no light goes through.
    pub transmitted: Vec<f32>,
    /// What several bounces among facets return, `[thickness][channel]`, or empty.
    pub returned: Vec<f32>,
    /// Thicknesses in nm of a table over them, and where on a body the film has which.
    pub thickness: Option<(Vec<f64>, ThicknessMap)>,
}

/// Thickness at a place of a body, between two of a table.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Between {
    below: usize,
    above: usize,
    weight: f32,
}

impl MirrorLike {
    /// The thickness at a hit.
    pub fn at(&self, body: &Body<'_>, hit: &SurfaceHit) -> Between {
        let Some((thickness_nm, map)) = &self.thickness else { return Between::default() };
        let [first, last] = [thickness_nm[0], thickness_nm[thickness_nm.len() - 1]];
        let (below, above, weight) =
            neighbours(thickness_nm, first + map.at(body, hit.triangle, hit.point) * (last - first));
        Between { below, above, weight: weight as f32 }
    }

    /// Multiplies each channel by ρ(θ): linear between the table's angles and constant beyond them.
    pub fn reflect(&self, between: Between, at_deg: f64, throughput: &mut [f32]) {
        self.multiply(&self.reflected, between, at_deg, throughput);
    }

    /// Adds what several bounces return, times `multiple`, to each channel.
    pub fn add_returned(&self, Between { below, above, weight }: Between, multiple: f32, out: &mut [f32]) {
        let channels = out.len();
        let row = |thickness: usize| self.returned.get(thickness * channels..).unwrap_or_default();
        for ((f, thin), thick) in out.iter_mut().zip(row(below)).zip(row(above)) {
            *f += multiple * (thin + weight * (thick - thin));
        }
    }

    /// Multiplies each channel by the transmittance, as [`MirrorLike::reflect`].
    pub fn transmit(&self, between: Between, at_deg: f64, throughput: &mut [f32]) {
        self.multiply(&self.transmitted, between, at_deg, throughput);
    }

    /// Whether light goes through.
    pub fn is_sheet(&self) -> bool {
        !self.transmitted.is_empty()
    }

    fn multiply(
        &self,
        values: &[f32],
        Between { below, above, weight: of_thickness }: Between,
        at_deg: f64,
        throughput: &mut [f32],
    ) {
        let (channels, angles) = (throughput.len(), self.theta_deg.len());
        let (low, high, of_angle) = neighbours(&self.theta_deg, at_deg);
        let of_angle = of_angle as f32;
        let row = |thickness: usize, angle: usize| &values[(thickness * angles + angle) * channels..][..channels];
        let at = |thickness: usize, c: usize| {
            let (low, high) = (row(thickness, low)[c], row(thickness, high)[c]);
            low + of_angle * (high - low)
        };
        if of_thickness == 0.0 {
            throughput.iter_mut().enumerate().for_each(|(c, through)| *through *= at(below, c));
        } else {
            throughput.iter_mut().enumerate().for_each(|(c, through)| {
                let (thin, thick) = (at(below, c), at(above, c));
                *through *= thin + of_thickness * (thick - thin);
            });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::body::{BodyShape, BvhMemory};
    use super::*;
    use crate::table::mirror::{MirrorTable, ThicknessAxis};

    #[test]
    fn reflectance_is_that_of_the_table() {
        let mut table = MirrorTable {
            theta_deg: vec![0.0, 10.0, 45.0, 80.0],
            rgb: vec![[1.0, 0.5, -0.25], [0.0, 1.0, 0.5], [0.5, 0.5, 0.5], [0.9, 0.1, 0.3]],
            ..MirrorTable::default()
        };
        table.rgb.extend([[0.0, 0.25, 0.5]; 4]);
        table.thickness = Some(ThicknessAxis { layer: 1, nm: vec![100.0, 200.0] });
        let mut memory = BvhMemory::default();
        let body = Body::new(&BodyShape::Sphere, &mut memory).unwrap();
        let hit = body.intersect(glam::DVec3::new(3.0, 0.0, 0.0), glam::DVec3::NEG_X).unwrap();
        for share in [0.0, 0.3, 1.0] {
            let mirror = MirrorLike {
                theta_deg: table.theta_deg.clone(),
                reflected: table.rgb.iter().flatten().copied().collect(),
                transmitted: Vec::new(),
                returned: Vec::new(),
                thickness: Some((vec![100.0, 200.0], ThicknessMap::Even(share))),
            };
            let one = table.at_thickness(100.0 + 100.0 * share);
            for at in [0.0, 2.5, 10.0, 33.0, 79.0, 80.0, 90.0] {
                let mut found = [2.0; 3];
                mirror.reflect(mirror.at(&body, &hit), at, &mut found);
                let expected = one.rgb_at(at);
                assert!((0..3).all(|c| (found[c] - 2.0 * expected[c]).abs() < 1e-6), "{at}: {found:?} {expected:?}");
            }
        }
    }
}
