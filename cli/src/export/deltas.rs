//! Light that a table sends into exact directions, where f is a delta.

use glam::DVec3;
use goniochrome::table::{OrderTable as Lookup, ScatterTable as Scatter};

use super::reflection::between_angles;
use crate::support::error::Result;
use crate::table::Table;
use crate::table::metadata::MetadataKey;
use crate::table::mirror::MirrorTable;
use crate::table::orders::LookupArrays;
use crate::table::scatter::ScatterLookup;

/// Names of the components of a colour, in the order of [`Delta::power`] and of channels of RGB.
pub const RGB: [&str; 3] = ["R", "G", "B"];

/// Light of one channel that leaves in an exact direction.
#[derive(Clone, Debug, PartialEq)]
pub struct Delta {
    /// What sends it: `mirror`, `straight` through a sheet, flat facets as `facet 1`, or an order as `order 1 0`.
    pub name: String,
    /// Wavelength in nm, or one of [`RGB`].
    pub channel: String,
    /// Direction in which the light leaves.
    pub direction: DVec3,
    /// Its power over that of the incident light, or what it adds to a component of the colour.
    pub power: f64,
}

/// The exact directions of a table.
#[derive(Debug)]
pub enum Deltas<'t> {
    /// The mirror direction, and through a sheet the direction straight on.
    Mirror(&'t MirrorTable),
    /// Lobes of flat facets: the look-ups of spectra and of RGB, and the wavelengths.
    Facets(ScatterLookup, ScatterLookup, &'t [f64]),
    /// Diffraction orders: their numbers, the wavelengths, and what the library looks up.
    Orders(&'t [[i32; 2]], &'t [f64], LookupArrays),
}

impl<'t> Deltas<'t> {
    /// The exact directions of a table; `None` if it has none.
    ///
    /// # Errors
    /// A table that did not pass its check, or too little memory.
    pub fn new(table: &'t Table) -> Result<Option<Self>> {
        Ok(match table {
            Table::Mirror(table) => Some(Self::Mirror(table)),
            Table::Scatter(table) if table.layout.lobes() == 0 => None,
            Table::Scatter(table) => {
                Some(Self::Facets(table.spectral_lookup()?, table.rgb_lookup()?, &table.wavelength_nm))
            }
            Table::Orders(table) => {
                let weights = table.wavelength_nm.iter().map(|_| [0.0; 3]);
                Some(Self::Orders(&table.orders, &table.wavelength_nm, table.arrays(weights)))
            }
        })
    }

    /// Light that leaves in exact directions, for light from `wi` above the horizon. What reflects nothing is
    /// left out.
    ///
    /// # Errors
    /// A table that the library refuses.
    pub fn at(&self, wi: DVec3) -> Result<Vec<Delta>> {
        match self {
            Self::Mirror(table) => Ok(mirror(table, wi)),
            Self::Facets(spectra, rgb, wavelength_nm) => {
                Ok(facets(&spectra.table()?, &rgb.table()?, wavelength_nm, wi))
            }
            Self::Orders(orders, wavelength_nm, arrays) => {
                let table = arrays.table()?;
                Ok(orders.iter().enumerate().flat_map(|order| leaving(&table, wavelength_nm, order, wi)).collect())
            }
        }
    }
}

/// ρ(θ) in the mirror direction, spectral and RGB; of a sheet also what goes straight on.
fn mirror(table: &MirrorTable, wi: DVec3) -> Vec<Delta> {
    let reflected: Vec<f32> = table.unpolarised().map(|power| power as f32).collect();
    let mirrored = DVec3::new(-wi.x, -wi.y, wi.z);
    let mut deltas = of_power(table, &reflected, &table.rgb, "mirror", wi.z, mirrored);
    // Into another medium light is refracted, by an index that the table does not hold.
    if table.is_transparent() && table.metadata.get(MetadataKey::Backing) == Some("ambient") {
        let passed: Vec<f32> = table.unpolarised_transmittance().map(|power| power as f32).collect();
        deltas.extend(of_power(table, &passed, &table.rgb_transmitted, "straight", wi.z, -wi));
    }
    deltas
}

/// A power and its colour at an angle, as light that leaves in a direction.
fn of_power(
    table: &MirrorTable,
    spectra: &[f32],
    rgb: &[[f32; 3]],
    name: &str,
    cos_theta: f64,
    direction: DVec3,
) -> Vec<Delta> {
    let theta: Vec<f64> = table.theta_deg.iter().map(|theta| theta.to_radians()).collect();
    let channels = table.wavelength_nm.iter().map(f64::to_string);
    let channels = channels.chain(RGB.into_iter().filter(|_| !rgb.is_empty()).map(str::to_owned));
    let mut power = vec![0.0; table.wavelength_nm.len() + 3];
    let (spectral, colour) = power.split_at_mut(table.wavelength_nm.len());
    between_angles(&theta, spectra, cos_theta.acos(), spectral);
    if !rgb.is_empty() {
        between_angles(&theta, rgb.as_flattened(), cos_theta.acos(), colour);
    }
    let delta = |(channel, power)| Delta { name: name.to_owned(), channel, direction, power };
    channels.zip(power).map(delta).collect()
}

/// Light of each lobe of flat facets, spectral and RGB.
fn facets(spectra: &Scatter<'_>, rgb: &Scatter<'_>, wavelength_nm: &[f64], wi: DVec3) -> Vec<Delta> {
    let mut deltas = Vec::new();
    let mut power = vec![0.0; wavelength_nm.len() + RGB.len()];
    for lobe in 0..spectra.layout().lobes() {
        let (spectral, colour) = power.split_at_mut(wavelength_nm.len());
        let Some(direction) = spectra.reflected(wi.as_vec3(), lobe, spectral) else { continue };
        rgb.reflected(wi.as_vec3(), lobe, colour);
        if power.iter().all(|power| *power == 0.0) {
            continue;
        }
        let channels = wavelength_nm.iter().map(f64::to_string).chain(RGB.map(str::to_owned));
        deltas.extend(channels.zip(&power).map(|(channel, power)| Delta {
            name: format!("facet {}", lobe + 1),
            channel,
            direction: direction.as_dvec3(),
            power: f64::from(*power),
        }));
    }
    deltas
}

/// Light of each wavelength in an order, which is given by its place in the table and its numbers.
fn leaving(table: &Lookup<'_>, wavelength_nm: &[f64], (place, [m, n]): (usize, &[i32; 2]), wi: DVec3) -> Vec<Delta> {
    let view = table.view(wi.as_vec3());
    let delta = |(wavelength, nm): (usize, &f64)| {
        let light = view.as_ref()?.light(wavelength, place)?;
        (light.efficiency > 0.0).then(|| Delta {
            name: format!("order {m} {n}"),
            channel: nm.to_string(),
            direction: light.direction.as_dvec3(),
            power: f64::from(light.efficiency),
        })
    };
    wavelength_nm.iter().enumerate().filter_map(delta).collect()
}
