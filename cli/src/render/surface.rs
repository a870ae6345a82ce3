//! A table prepared for shading.

use super::channels::Channels;
use super::glossy::{FinishedMirror, Glossy};
use super::mirror_like::MirrorLike;
use super::orders::{OrderShading, OrderSurface};
use super::thickness::ThicknessMap;
use super::viewed::SampledTable;
use crate::scene::OwnedFinish;
use crate::support::error::{Error, Result};
use crate::table::Table;
use crate::table::finish::returned;
use crate::table::mirror::MirrorTable;
use crate::table::scatter::ScatterLookup;

/// The reflection of a surface, for each channel in which light is traced.
#[derive(Clone, Debug)]
pub struct Surface {
    channels: Channels,
    reflectance: Reflectance,
}

#[derive(Clone, Debug)]
enum Reflectance {
    /// ρ(θ) of the surface or, with a finish, of its facets.
    Mirror(MirrorLike, Option<OwnedFinish>),
    /// s and lobes.
    Scatter(ScatterLookup),
    /// Diffraction orders.
    Orders(OrderSurface),
}

/// A [`Surface`] that is ready to be looked up and sampled.
pub(super) enum Prepared<'a> {
    Mirror(&'a MirrorLike),
    Glossy(Glossy<'a>),
    Orders(OrderShading<'a>),
}

/// What a mirror-like table leaves open.
#[derive(Clone, Debug, Default)]
pub struct MirrorChoice {
    /// The finish of the surface; without one it is smooth.
    pub finish: Option<OwnedFinish>,
    /// Whether light goes straight through the surface, in a table that holds transmitted light.
    pub is_sheet: bool,
    /// Where the film is how thick, for a table over a thickness.
    pub thickness: Option<ThicknessMap>,
}

impl Surface {
    /// The surface of a table: by its RGB, converted to linear sRGB, or by its wavelengths with `spectral`. `choice` is
    /// for mirror-like tables.
    ///
    /// Colours by the paper's matrix, which is a display of its own, are not converted. Diffraction orders are traced
    /// in RGB, which their quadrature over the wavelengths makes.
    ///
    /// # Errors
    /// A damaged table, a table without colours, or wavelengths that cannot tell colours apart.
    pub fn new(table: &Table, spectral: bool, choice: MirrorChoice) -> Result<Self> {
        table.check()?;
        match table {
            Table::Mirror(mirror) => {
                let (channels, values) = channels_and_values(table, spectral)?;
                let transmitted = if choice.is_sheet { transmitted(mirror, spectral) } else { Vec::new() };
                let returned = choice.finish.as_ref().map_or(Vec::new(), |finish| {
                    returned(&finish.finish(), &mirror.theta_deg, &values, channels.count())
                });
                let axis = mirror.thickness.as_ref();
                let mirror_like = MirrorLike {
                    theta_deg: mirror.theta_deg.clone(),
                    reflected: values,
                    transmitted,
                    returned,
                    thickness: axis.map(|axis| axis.nm.clone()).zip(choice.thickness),
                };
                Ok(Self { channels, reflectance: Reflectance::Mirror(mirror_like, choice.finish) })
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
            Reflectance::Mirror(mirror, _) => !mirror.is_sheet() && mirror.reflected.iter().all(|&x| x == 0.0),
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
            Reflectance::Mirror(mirror, None) => Ok(Prepared::Mirror(mirror)),
            Reflectance::Mirror(mirror, Some(finish)) => {
                let finish = finish.finish();
                Ok(Prepared::Glossy(Glossy::Finish(FinishedMirror { finish, mirror })))
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

/// The transmittance of a table in the channels of its reflectance.
fn transmitted(table: &MirrorTable, spectral: bool) -> Vec<f32> {
    if spectral {
        table.unpolarised_transmittance().map(|power| power as f32).collect()
    } else {
        table.metadata.screen_rgb(&table.rgb_transmitted).into_flattened()
    }
}
