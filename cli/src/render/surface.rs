//! A table made ready to shade by.

use glam::{DVec3, Vec3};
use goniochrome::table::{ScatterLayout, ScatterSampler, ScatterTable};

use super::channels::Channels;
use crate::support::error::{Error, Result};
use crate::support::memory::filled;
use crate::table::Table;

/// A reflectance for each channel.
#[derive(Clone, Debug, PartialEq)]
pub struct Surface {
    channels: Channels,
    kind: Kind,
}

#[derive(Clone, Debug, PartialEq)]
enum Kind {
    /// ρ, `[theta][channel]`.
    Mirror { theta_deg: Vec<f64>, values: Vec<f32> },
    /// f, `[incident][bin][channel]`.
    Scatter { layout: ScatterLayout, values: Vec<f32> },
}

/// [`Surface`] with its sampler.
#[derive(Clone, Copy)]
pub(super) enum Prepared<'a> {
    Mirror { theta_deg: &'a [f64], values: &'a [f32] },
    Scatter { table: ScatterTable<'a>, sampler: ScatterSampler<'a> },
}

impl Surface {
    /// The table's RGB, in linear sRGB whatever its own space; or with `spectral` its wavelengths.
    ///
    /// The paper's matrix is a display of its own and stays.
    ///
    /// # Errors
    /// If the table's wavelengths cannot tell colours apart.
    pub fn new(table: &Table, spectral: bool) -> Result<Self> {
        table.check()?;
        let metadata = table.metadata();
        let channels = if spectral {
            Channels::spectral(table.wavelength_nm(), metadata.illuminant(), metadata.screen_space())?
        } else {
            Channels::rgb()
        };
        let values = if spectral { table.spectra() } else { metadata.screen_rgb(table.rgb()?).as_flattened().to_vec() };
        let kind = match table {
            Table::Mirror(table) => Kind::Mirror { theta_deg: table.theta_deg.clone(), values },
            Table::Scatter(table) => Kind::Scatter { layout: table.layout, values },
        };
        Ok(Self { channels, kind })
    }

    /// In which numbers light is followed.
    #[must_use]
    pub fn channels(&self) -> &Channels {
        &self.channels
    }

    /// Refuses a surface that shows nothing: black in every channel.
    pub fn check_not_black(&self) -> Result<()> {
        let (Kind::Mirror { values, .. } | Kind::Scatter { values, .. }) = &self.kind;
        if values.iter().all(|&x| x == 0.0) {
            return Err(Error::failed("the table reflects nothing, the picture would be black; estimate it anew"));
        }
        Ok(())
    }

    /// Sums what sampling needs into `memory`.
    pub(super) fn prepare<'a>(&'a self, memory: &'a mut Vec<f32>) -> Result<Prepared<'a>> {
        match &self.kind {
            Kind::Mirror { theta_deg, values } => Ok(Prepared::Mirror { theta_deg, values }),
            Kind::Scatter { layout, values } => {
                let table = ScatterTable::new(values, *layout, self.channels.count()).map_err(Error::failed)?;
                *memory = filled(0.0, ScatterSampler::required_len(layout), "sampling the table")?;
                let sampler = ScatterSampler::new(&table, memory).map_err(Error::failed)?;
                Ok(Prepared::Scatter { table, sampler })
            }
        }
    }
}

/// Multiplies each channel by ρ(θ), linear between the table's angles and held beyond them.
pub(super) fn reflect(theta_deg: &[f64], values: &[f32], at_deg: f64, throughput: &mut [f32]) {
    let channels = throughput.len();
    let above = theta_deg.partition_point(|&theta| theta < at_deg);
    let (below, above) = (above.saturating_sub(1), above.min(theta_deg.len() - 1));
    let span = theta_deg[above] - theta_deg[below];
    let weight = if span > 0.0 { ((at_deg - theta_deg[below]) / span) as f32 } else { 0.0 };
    let (low, high) = (&values[below * channels..][..channels], &values[above * channels..][..channels]);
    for ((through, low), high) in throughput.iter_mut().zip(low).zip(high) {
        *through *= low + weight * (high - low);
    }
}

/// A direction of the surface frame as the core takes it.
pub(super) fn narrow(local: DVec3) -> Vec3 {
    local.as_vec3()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::table::mirror::MirrorTable;

    #[test]
    fn reflectance_is_that_of_the_table() {
        let table = MirrorTable {
            theta_deg: vec![0.0, 10.0, 45.0, 80.0],
            rgb: vec![[1.0, 0.5, -0.25], [0.0, 1.0, 0.5], [0.5, 0.5, 0.5], [0.9, 0.1, 0.3]],
            ..MirrorTable::default()
        };
        let values: Vec<f32> = table.rgb.iter().flatten().copied().collect();
        for at in [0.0, 2.5, 10.0, 33.0, 79.0, 80.0, 90.0] {
            let mut found = [2.0; 3];
            reflect(&table.theta_deg, &values, at, &mut found);
            let expected = table.rgb_at(at);
            assert!((0..3).all(|c| (found[c] - 2.0 * expected[c]).abs() < 1e-6), "{at}: {found:?} {expected:?}");
        }
    }
}
