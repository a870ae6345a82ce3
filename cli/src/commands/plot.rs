//! `goniochrome plot`.

use std::slice;

use crate::args::{PlotArgs, PlotKind, spelled};
use crate::commands::lobes;
use crate::error::{Error, Result};
use crate::output;
use crate::picture::{Disc, Format, HeatAxis, LineOptions, PALETTE, Picture, Series, disc, heat_map, line_chart};
use crate::table::MirrorTable;
use crate::table_file::{self, Table};

pub fn run(args: &PlotArgs) -> Result<()> {
    Format::of(&args.output)?;
    output::check_destination(&args.output, slice::from_ref(&args.table))?;
    if !args.phi.is_finite() {
        return Err(Error::usage(format_args!("--phi {}: the azimuth must be finite", args.phi)));
    }
    let table = table_file::read(&args.table)?;
    let name = table.name();
    let theta = args.theta.as_ref().map(|angles| angles.0.as_slice());
    let picture = match (args.kind, &table) {
        (PlotKind::Disc, _) => disc_of(&table, theta, args.phi)?,
        (PlotKind::Spectrum, Table::Mirror(mirror)) => spectra_of(mirror, name, theta.unwrap_or(&[0.0, 45.0, 75.0])),
        (PlotKind::Map, Table::Mirror(mirror)) => map_of(mirror, name),
        (PlotKind::Lobes, Table::Scatter(scatter)) => {
            lobes::lobes(scatter, name, theta.unwrap_or(&[15.0, 45.0, 75.0]), args.phi)?
        }
        (kind, Table::Mirror(_)) => {
            return Err(Error::usage(format_args!(
                "{}: a planar scene has no {}; draw its disc, spectrum or map",
                args.table.display(),
                spelled(kind)
            )));
        }
        (kind, Table::Scatter(_)) => {
            return Err(Error::usage(format_args!(
                "{}: a cell of tilted facets has no {}; draw its disc or lobes",
                args.table.display(),
                spelled(kind)
            )));
        }
    };
    picture.save(&args.output)
}

/// Every direction of the table's hemisphere: figures 3 and 4; of a cell, where the light of one direction goes.
pub fn disc_of(table: &Table, theta_deg: Option<&[f64]>, phi_deg: f64) -> Result<Picture> {
    let mirror = match table {
        Table::Mirror(mirror) => mirror,
        Table::Scatter(scatter) => return lobes::outgoing(scatter, table.name(), theta_deg, phi_deg),
    };
    let rgb = |theta_deg: f64, _phi_deg: f64| mirror.rgb_at(theta_deg);
    Ok(disc(&Disc { label: table.name(), rgb: &rgb, theta_max_deg: 90.0, azimuthal: false }))
}

fn spectra_of(table: &MirrorTable, name: &str, theta_deg: &[f64]) -> Picture {
    let width = table.wavelength_nm.len();
    let series = theta_deg.iter().zip(PALETTE.iter().cycle()).flat_map(|(&wanted, colour)| {
        let distance = |angle: &usize| (table.theta_deg[*angle] - wanted).abs();
        let angle = (0..table.theta_deg.len())
            .min_by(|a, b| distance(a).total_cmp(&distance(b)))
            .expect("a table has at least one angle");
        let theta = table.theta_deg[angle];
        let curve = |label: String, dashed, of: &dyn Fn(usize) -> f32| Series {
            label,
            colour: (*colour).to_owned(),
            points: (0..width).map(|i| (table.wavelength_nm[i], f64::from(of(angle * width + i)))).collect(),
            dashed,
        };
        let (s, p) = (&table.reflectance_s, &table.reflectance_p);
        let mean = curve(format!("{theta:.0}°"), false, &|i| 0.5 * (s[i] + p[i]));
        // s and p coincide at normal incidence.
        let parts = (theta > 0.0).then(|| {
            [curve(format!("{theta:.0}° s"), true, &|i| s[i]), curve(format!("{theta:.0}° p"), true, &|i| p[i])]
        });
        [mean].into_iter().chain(parts.into_iter().flatten()).collect::<Vec<_>>()
    });
    let series: Vec<Series> = series.collect();
    line_chart(&format!("{name}: reflectance"), "Wavelength (nm)", "Reflectance", &series, LineOptions::default())
}

fn map_of(table: &MirrorTable, name: &str) -> Picture {
    let mean: Vec<f64> = table
        .reflectance_s
        .iter()
        .zip(&table.reflectance_p)
        .map(|(s, p)| 0.5 * (f64::from(*s) + f64::from(*p)))
        .collect();
    heat_map(
        &format!("{name}: unpolarised reflectance"),
        HeatAxis { label: "Wavelength (nm)", coordinates: &table.wavelength_nm },
        HeatAxis { label: "Angle of incidence (°)", coordinates: &table.theta_deg },
        &mean,
        "Reflectance",
        None,
    )
}
