//! `goniochrome plot`.

use goniochrome::colour::{Quadrature, xyz};

use crate::colour::{illuminant_of, visible_weights};
use crate::commands::args::{PlotArgs, PlotKind};
use crate::commands::source::Source;
use crate::commands::{cell_plots, lobes, save};
use crate::plot::{
    ColourAt, Disc, Format, HeatAxis, LineOptions, PALETTE, Picture, Series, chromaticity, disc, heat_map, line_chart,
};
use crate::support::error::{Error, Result};
use crate::support::output;
use crate::table::file::Table;
use crate::table::mirror::MirrorTable;

/// Angles marked on the path of the colour.
const MARKED: [f64; 6] = [0.0, 15.0, 30.0, 45.0, 60.0, 75.0];

/// Angles of the light on a cell.
const LIGHTS: [f64; 3] = [15.0, 45.0, 75.0];

pub fn run(args: &PlotArgs) -> Result<()> {
    Format::of(&args.output)?;
    let source = Source::find(&args.table)?;
    output::check_destination(&args.output, &source.files())?;
    if !args.phi.is_finite() {
        return Err(Error::usage(format_args!("--phi {}: the azimuth must be finite", args.phi)));
    }
    let table = source.table(args.quiet)?;
    let name = table.name();
    let theta = args.theta.as_ref().map(|angles| angles.0.as_slice());
    let of_cells = args.theta_out.is_some() || args.phi_out.is_some();
    if of_cells && !(args.kind == PlotKind::Spectrum && matches!(table, Table::Scatter(_))) {
        return Err(Error::usage(format_args!(
            "{}: --theta-out and --phi-out are for the spectra of cells of tilted facets; leave them out",
            args.table.display()
        )));
    }
    if let (Table::Mirror(mirror), PlotKind::Disc | PlotKind::Chromaticity) = (&table, args.kind) {
        mirror.colours().map_err(|error| Error::failed(format_args!("{}: {error}", args.table.display())))?;
    }
    let picture = match &table {
        Table::Mirror(mirror) => match args.kind {
            PlotKind::Disc => disc_of(&table, theta, args.phi)?,
            PlotKind::Spectrum => spectra_of(mirror, name, theta.unwrap_or(&[0.0, 45.0, 75.0])),
            PlotKind::Map => map_of(mirror, name)?,
            PlotKind::Chromaticity => path_of(mirror, name, theta.unwrap_or(&MARKED))?,
            PlotKind::Lobes => {
                return Err(Error::usage(format_args!(
                    "{}: a planar scene has no lobes; draw its disc, spectrum, map or chromaticity",
                    args.table.display()
                )));
            }
        },
        Table::Scatter(scatter) => match args.kind {
            PlotKind::Disc => disc_of(&table, theta, args.phi)?,
            PlotKind::Lobes => lobes::lobes(scatter, name, theta.unwrap_or(&LIGHTS), args.phi)?,
            PlotKind::Spectrum => cell_plots::spectra(scatter, name, theta.unwrap_or(&LIGHTS), args)?,
            PlotKind::Map => cell_plots::map(scatter, name, args.phi)?,
            PlotKind::Chromaticity => cell_plots::path(scatter, name, theta.unwrap_or(&MARKED), args.phi)?,
        },
    };
    save(&picture, &args.output, args.quiet)
}

/// Every direction of the table's hemisphere: figures 3 and 4; of a cell, where the light of one direction goes.
pub fn disc_of(table: &Table, theta_deg: Option<&[f64]>, phi_deg: f64) -> Result<Picture> {
    let mirror = match table {
        Table::Mirror(mirror) => mirror,
        Table::Scatter(scatter) => return lobes::outgoing(scatter, table.name(), theta_deg, phi_deg),
    };
    mirror.colours()?;
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

fn map_of(table: &MirrorTable, name: &str) -> Result<Picture> {
    if table.wavelength_nm.len() < 2 || table.theta_deg.len() < 2 {
        return Err(Error::usage("--kind map: a map needs two angles and two wavelengths or more"));
    }
    let mean: Vec<f64> = table
        .reflectance_s
        .iter()
        .zip(&table.reflectance_p)
        .map(|(s, p)| 0.5 * (f64::from(*s) + f64::from(*p)))
        .collect();
    Ok(heat_map(
        &format!("{name}: unpolarised reflectance"),
        HeatAxis { label: "Wavelength (nm)", coordinates: &table.wavelength_nm },
        HeatAxis { label: "Angle of incidence (°)", coordinates: &table.theta_deg },
        &mean,
        "Reflectance",
        None,
    ))
}

/// The path of the colour of unpolarised light over the angle.
fn path_of(table: &MirrorTable, name: &str, theta_deg: &[f64]) -> Result<Picture> {
    let light = illuminant_of(&table.metadata);
    let weights = visible_weights(&table.wavelength_nm, light, Quadrature::Interpolated)?;
    let width = weights.len();
    let row = |angle: usize| -> Vec<f64> {
        let at = angle * width..(angle + 1) * width;
        let both = table.reflectance_s[at.clone()].iter().zip(&table.reflectance_p[at]);
        both.map(|(s, p)| 0.5 * (f64::from(*s) + f64::from(*p))).collect()
    };
    let path: Vec<_> = (0..table.theta_deg.len())
        .map(|angle| ColourAt { theta_deg: table.theta_deg[angle], xyz: xyz(&weights, row(angle)) })
        .collect();
    let marked: Vec<_> = theta_deg.iter().map(|&theta| between(&path, theta)).collect();
    Ok(chromaticity(&format!("{name}: colour over the angle from the normal"), light, &path, &marked))
}

/// The colour between the two neighbours of an angle, held at the ends.
fn between(path: &[ColourAt], theta_deg: f64) -> ColourAt {
    let above = path.partition_point(|place| place.theta_deg < theta_deg).min(path.len() - 1);
    let (a, b) = (path[above.saturating_sub(1)], path[above]);
    let span = b.theta_deg - a.theta_deg;
    let weight = if span > 0.0 { ((theta_deg - a.theta_deg) / span).clamp(0.0, 1.0) } else { 0.0 };
    ColourAt { theta_deg, xyz: std::array::from_fn(|c| a.xyz[c] + weight * (b.xyz[c] - a.xyz[c])) }
}
