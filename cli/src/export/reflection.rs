//! The BRDF f(wi, wo) of any kind of table, in each of its channels.

use glam::{DVec3, Vec3};
use goniochrome::table::ScatterTable as Lookup;

use super::gaussian::Gaussian;
use super::order_lobes::{LobesAt, OrderLobes};
use crate::scene::OwnedFinish;
use crate::support::error::{Error, Result};
use crate::table::Table;
use crate::table::finish::{FinishChoice, returned};
use crate::table::mirror::neighbours;
use crate::table::scatter::{ScatterLookup, ScatterTable};

/// A BRDF to export: in RGB, or in a channel for each wavelength.
#[derive(Clone, Debug)]
pub struct Reflection {
    /// Number of channels.
    pub channels: usize,
    /// Wavelengths in nm; empty for RGB.
    pub wavelength_nm: Vec<f64>,
    values: Vec<f32>,
    kind: ReflectionKind,
}

/// The form of a [`Reflection`].
#[derive(Clone, Debug)]
pub enum ReflectionKind {
    /// The reflectance of a mirror-like table, spread by a lobe.
    Lobe {
        /// The facets that make the lobe.
        finish: OwnedFinish,
        /// The table's angles in radians.
        theta: Vec<f64>,
        /// What several bounces return in each channel; empty without energy compensation.
        returned: Vec<f32>,
    },
    /// A table of tilted facets, and the width of the lobes of its flat ones; without it they are left out.
    Scatter(ScatterLookup, Option<Gaussian>),
    /// Diffraction orders, spread by lobes.
    Orders(OrderLobes),
}

/// Widths of lobes that the user gives.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LobeWidth {
    /// The facets of a mirror-like table, in place of its own finish.
    pub finish: FinishChoice,
    /// Standard deviation of the Gaussian lobe of a diffraction order or of flat facets, in degrees.
    pub spread_deg: Option<f64>,
}

impl Reflection {
    /// The BRDF of a table. A mirror-like table needs a finish; diffraction orders and exact lobes of flat facets
    /// need a spread; other tables have neither.
    ///
    /// # Errors
    /// A width that is missing or has no use; RGB of a table without colours.
    pub fn new(table: &Table, width: LobeWidth, rgb: bool) -> Result<Self> {
        let wavelength_nm = if rgb { Vec::new() } else { table.wavelength_nm().to_vec() };
        let exact = match table {
            Table::Mirror(_) => false,
            Table::Scatter(table) => table.layout.lobes() > 0,
            Table::Orders(_) => true,
        };
        if width.spread_deg.is_some() && !exact {
            return Err(Error::usage(
                "--spread is for tables of diffraction orders or with exact lobes of flat facets, and this one holds none: \
                 leave it out",
            ));
        }
        let spread = || {
            let what =
                if matches!(table, Table::Orders(_)) { "diffraction orders" } else { "its lobes of flat facets" };
            width.spread_deg.map(f64::to_radians).ok_or_else(|| {
                Error::usage(format_args!(
                    "--spread is missing: {what} are deltas in direction, which this format cannot hold; give the standard \
                     deviation in degrees of the lobes that shall stand in for them, as --spread 2"
                ))
            })
        };
        let channels = if rgb { 3 } else { wavelength_nm.len() };
        let values;
        let kind = match (table, width.finish.is_given()) {
            (Table::Mirror(mirror), _) => {
                let Some(finish) = width.finish.of(&mirror.metadata)? else {
                    return Err(Error::usage(
                        "--roughness is missing: the table is mirror-like, a delta in direction, which this format cannot hold; \
                         give the width of the GGX lobe that shall stand in for it, as --roughness 0.1",
                    ));
                };
                values = if rgb { table.rgb()?.as_flattened().to_vec() } else { table.spectra()? };
                let returned = returned(&finish.finish(), &mirror.theta_deg, &values, channels);
                let theta = mirror.theta_deg.iter().map(|theta| theta.to_radians()).collect();
                ReflectionKind::Lobe { finish, theta, returned }
            }
            (Table::Scatter(_), true) => {
                return Err(Error::usage(
                    "--roughness, --energy-compensation: are for mirror-like tables; this one holds the scattering of tilted facets as it is: leave it out",
                ));
            }
            (Table::Orders(_), true) => {
                return Err(Error::usage(
                    "--roughness, --energy-compensation: are for mirror-like tables; this one holds diffraction orders: give their width, as --spread 2",
                ));
            }
            (Table::Scatter(table), false) => {
                let gaussian = exact.then(spread).transpose()?.map(|spread| Gaussian { spread });
                return Self::scatter(table, gaussian, rgb);
            }
            (Table::Orders(table), false) => {
                let lobes = OrderLobes::new(table, spread()?, rgb)?;
                let channels = lobes.channels();
                return Ok(Self { channels, wavelength_nm, values: Vec::new(), kind: ReflectionKind::Orders(lobes) });
            }
        };
        Ok(Self { channels, wavelength_nm, values, kind })
    }

    /// The BRDF of a table of tilted facets, with lobes of flat ones if they have a width.
    ///
    /// # Errors
    /// A table that did not pass its check, or too little memory.
    pub fn scatter(table: &ScatterTable, gaussian: Option<Gaussian>, rgb: bool) -> Result<Self> {
        let lookup = if rgb { table.rgb_lookup()? } else { table.spectral_lookup()? };
        let wavelength_nm = if rgb { Vec::new() } else { table.wavelength_nm.clone() };
        let (channels, kind) = (lookup.channels(), ReflectionKind::Scatter(lookup, gaussian));
        Ok(Self { channels, wavelength_nm, values: Vec::new(), kind })
    }

    /// The BRDF whose negative components, of colours out of gamut, are 0.
    #[must_use]
    pub fn clipped(mut self) -> Self {
        let clip = |values: &mut [f32]| values.iter_mut().for_each(|value| *value = value.max(0.0));
        match &mut self.kind {
            ReflectionKind::Lobe { .. } => clip(&mut self.values),
            ReflectionKind::Scatter(lookup, _) => clip(lookup.values_mut()),
            ReflectionKind::Orders(lobes) => lobes.clip(),
        }
        self
    }

    /// Bound of the standard error of the luminance of f, as a BRDF of one channel; `None` for tables without one. It
    /// interpolates the errors of the table's values as if these were wrong together.
    ///
    /// # Errors
    /// A table that did not pass its check.
    pub fn luminance_error(table: &Table) -> Result<Option<Self>> {
        let Table::Scatter(table) = table else { return Ok(None) };
        let kind = ReflectionKind::Scatter(table.lookup(table.luminance_error.clone(), 1)?, None);
        Ok(Some(Self { channels: 1, wavelength_nm: Vec::new(), values: Vec::new(), kind }))
    }

    /// Refuses facets that are not equally rough in all directions, for a format that holds no others.
    ///
    /// # Errors
    /// A mirror-like table whose finish has two roughnesses.
    pub fn check_isotropic(&self) -> Result<()> {
        match &self.kind {
            ReflectionKind::Lobe { finish, .. } if !finish.finish().is_isotropic() => {
                let what = match finish.finish().alpha() {
                    Some([x, y]) => format!("a finish of roughness {x} along x and {y} along y"),
                    None => "a finish of tabulated facets that depend on the azimuth".to_owned(),
                };
                Err(Error::usage(format_args!("{what}: this format takes one roughness; give it, as --roughness 0.1")))
            }
            _ => Ok(()),
        }
    }

    /// The form of the BRDF.
    #[must_use]
    pub fn kind(&self) -> &ReflectionKind {
        &self.kind
    }

    /// An evaluator of the BRDF, with working memory of its own.
    ///
    /// # Panics
    /// If the table did not pass its check, so that its values do not fit its layout.
    #[must_use]
    pub fn evaluator(&self) -> Evaluator<'_> {
        let lookup = match &self.kind {
            ReflectionKind::Lobe { .. } | ReflectionKind::Orders(_) => None,
            ReflectionKind::Scatter(lookup, _) => Some(lookup.table().expect("a checked table fits its layout")),
        };
        Evaluator { reflection: self, lookup, values: vec![0.0; self.channels], lobes: LobesAt::default() }
    }

    /// ρ of a mirror-like table in each channel, at the angle to the half vector.
    pub(super) fn reflectance(&self, cos_d: f64, out: &mut [f64]) {
        if let ReflectionKind::Lobe { theta, .. } = &self.kind {
            between_angles(theta, &self.values, cos_d.clamp(0.0, 1.0).acos(), out);
        }
    }
}

/// ρ(θ) in each channel, linear between a mirror-like table's angles and constant beyond them;
/// `values[angle][channel]`.
pub(super) fn between_angles(theta: &[f64], values: &[f32], at: f64, out: &mut [f64]) {
    let (below, above, weight) = neighbours(theta, at);
    let channels = out.len();
    for (c, out) in out.iter_mut().enumerate() {
        let at = |row: usize| f64::from(values[row * channels + c]);
        *out = at(below) + weight * (at(above) - at(below));
    }
}

/// Evaluator of a [`Reflection`].
#[derive(Debug)]
pub struct Evaluator<'r> {
    reflection: &'r Reflection,
    /// The look-up of a [`ReflectionKind::Scatter`].
    lookup: Option<Lookup<'r>>,
    values: Vec<f32>,
    /// The lobes of a [`ReflectionKind::Orders`].
    lobes: LobesAt,
}

impl<'r> Evaluator<'r> {
    /// The BRDF.
    #[must_use]
    pub fn reflection(&self) -> &'r Reflection {
        self.reflection
    }

    /// f in each channel, in 1/sr. Both directions lie above the horizon.
    pub fn eval(&mut self, wi: DVec3, wo: DVec3, out: &mut [f64]) {
        if let ReflectionKind::Orders(orders) = &self.reflection.kind {
            orders.projected(wi, wo, &mut self.lobes, out);
            out.iter_mut().for_each(|value| *value /= wo.z);
        } else if let Some(lookup) = &self.lookup {
            let single = |w: DVec3| Vec3::new(w.x as f32, w.y as f32, w.z as f32);
            lookup.eval(single(wi), single(wo), &mut self.values);
            out.iter_mut().zip(&self.values).for_each(|(out, value)| *out = f64::from(*value));
            self.add_facets(wi, wo, 1.0 / wo.z, out);
        } else if let ReflectionKind::Lobe { finish, returned, .. } = &self.reflection.kind {
            let lobe = finish.finish().lobe(wi.as_vec3(), wo.as_vec3());
            let [value, multiple] = lobe.map_or([0.0; 2], |lobe| [lobe.value, lobe.multiple].map(f64::from));
            self.reflection.reflectance(wi.dot((wi + wo).normalize()), out);
            out.iter_mut().for_each(|rho| *rho *= value);
            out.iter_mut().zip(returned).for_each(|(f, returned)| *f += multiple * f64::from(*returned));
        }
    }

    /// Adds f cos θ_o of the lobes of flat facets, times `scale`, to each channel. Below the horizon, the lobes go on.
    pub(super) fn add_facets(&mut self, wi: DVec3, wo: DVec3, scale: f64, out: &mut [f64]) {
        let (Some(lookup), ReflectionKind::Scatter(_, Some(gaussian))) = (&self.lookup, &self.reflection.kind) else {
            return;
        };
        for lobe in 0..lookup.layout().lobes() {
            let Some(direction) = lookup.reflected(wi.as_vec3(), lobe, &mut self.values) else { continue };
            let direction = direction.as_dvec3().normalize();
            let share = gaussian.at(direction.dot(wo));
            if share > 0.0 {
                let scale = scale * share * gaussian.peak(direction);
                out.iter_mut().zip(&self.values).for_each(|(out, power)| *out += scale * f64::from(*power));
            }
        }
    }

    /// f cos θ_o of diffraction orders in each channel, continued below the horizon. `false` for other tables.
    pub(super) fn projected_orders(&mut self, wi: DVec3, wo: DVec3, out: &mut [f64]) -> bool {
        let ReflectionKind::Orders(orders) = &self.reflection.kind else { return false };
        orders.projected(wi, wo, &mut self.lobes, out);
        true
    }

    /// ∫ f cos θ_o dω_o of diffraction orders in each channel; `None` for other tables.
    pub(super) fn albedo_of_orders(&mut self, wi: DVec3) -> Option<Vec<f64>> {
        let ReflectionKind::Orders(orders) = &self.reflection.kind else { return None };
        Some(orders.albedo(wi, &mut self.lobes))
    }
}
