//! A table prepared for shading.

use goniochrome::microfacet::Finish;

use super::channels::Channels;
use super::glossy::{FinishedMirror, Glossy};
use super::orders::{OrderShading, OrderSurface};
use super::viewed::SampledTable;
use crate::support::error::{Error, Result};
use crate::table::Table;
use crate::table::scatter::ScatterLookup;

/// The reflection of a surface, for each channel in which light is traced.
#[derive(Clone, Debug, PartialEq)]
pub struct Surface {
    channels: Channels,
    reflectance: Reflectance,
}

#[derive(Clone, Debug, PartialEq)]
enum Reflectance {
    /// ρ(θ), `[theta][channel]`, of the surface or, with a finish, of its facets.
    Mirror { theta_deg: Vec<f64>, values: Vec<f32>, finish: Option<Finish> },
    /// s and lobes.
    Scatter(ScatterLookup),
    /// Diffraction orders.
    Orders(OrderSurface),
}

/// A [`Surface`] that is ready to be looked up and sampled.
pub(super) enum Prepared<'a> {
    Mirror { theta_deg: &'a [f64], values: &'a [f32] },
    Glossy(Glossy<'a>),
    Orders(OrderShading<'a>),
}

impl Surface {
    /// The surface of a table: by its RGB, converted to linear sRGB, or by its wavelengths with `spectral`. A finish is
    /// for mirror-like tables.
    ///
    /// Colours by the paper's matrix, which is a display of its own, are not converted. Diffraction orders are traced
    /// in RGB, which their quadrature over the wavelengths makes.
    ///
    /// # Errors
    /// A damaged table, a table without colours, or wavelengths that cannot tell colours apart.
    pub fn new(table: &Table, spectral: bool, finish: Option<Finish>) -> Result<Self> {
        table.check()?;
        match table {
            Table::Mirror(mirror) => {
                let (channels, values) = channels_and_values(table, spectral)?;
                let theta_deg = mirror.theta_deg.clone();
                Ok(Self { channels, reflectance: Reflectance::Mirror { theta_deg, values, finish } })
            }
            Table::Scatter(scatter) => {
                let (channels, values) = channels_and_values(table, spectral)?;
                let lookup = scatter.lookup(values, channels.count())?;
                Ok(Self { channels, reflectance: Reflectance::Scatter(lookup) })
            }
            Table::Orders(orders) => {
                let reflectance = Reflectance::Orders(OrderSurface::new(orders, spectral)?);
                Ok(Self { channels: Channels::rgb(), reflectance })
            }
        }
    }

    /// The channels in which light is traced.
    #[must_use]
    pub fn channels(&self) -> &Channels {
        &self.channels
    }

    /// Refuses a surface that reflects nothing.
    ///
    /// # Errors
    /// A surface that is black in every channel.
    pub fn check_not_black(&self) -> Result<()> {
        let black = match &self.reflectance {
            Reflectance::Mirror { values, .. } => values.iter().all(|&x| x == 0.0),
            Reflectance::Scatter(lookup) => lookup.values().iter().all(|&x| x == 0.0),
            Reflectance::Orders(orders) => orders.is_black(),
        };
        if black {
            return Err(Error::failed("the table reflects nothing, the picture would be black; estimate it anew"));
        }
        Ok(())
    }

    /// Prepares look-up and sampling.
    pub(super) fn prepare(&self) -> Result<Prepared<'_>> {
        match &self.reflectance {
            Reflectance::Mirror { theta_deg, values, finish: None } => Ok(Prepared::Mirror { theta_deg, values }),
            &Reflectance::Mirror { ref theta_deg, ref values, finish: Some(finish) } => {
                Ok(Prepared::Glossy(Glossy::Finish(FinishedMirror { finish, theta_deg, values })))
            }
            Reflectance::Scatter(lookup) => {
                Ok(Prepared::Glossy(Glossy::Table(SampledTable::new(lookup.table()?, lookup.values())?)))
            }
            Reflectance::Orders(orders) => Ok(Prepared::Orders(orders.shading()?)),
        }
    }
}

/// The channels of a table, and its values in each of them.
fn channels_and_values(table: &Table, spectral: bool) -> Result<(Channels, Vec<f32>)> {
    let metadata = table.metadata();
    if spectral {
        let channels = Channels::spectral(table.wavelength_nm(), metadata.illuminant(), metadata.screen_space())?;
        Ok((channels, table.spectra()?))
    } else {
        Ok((Channels::rgb(), metadata.screen_rgb(table.rgb()?).into_flattened()))
    }
}

#[cfg(test)]
mod tests {
    use super::super::glossy::reflect;
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
