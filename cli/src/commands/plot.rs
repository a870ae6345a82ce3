//! The command `goniochrome plot`.

use goniochrome::table::Periodicity;

use crate::commands::args::{OrderArg, PlotArgs, PlotKind, finish_choice};
use crate::commands::pictures::save_picture;
use crate::commands::table_source::TableSource;
use crate::commands::thickness_option::one_surface;
use crate::plot::{Picture, PictureFormat, tables};
use crate::support::error::{Error, Result};
use crate::support::output;
use crate::table::Table;
use crate::table::orders::OrderTable;
use crate::table::scatter::ScatterTable;

/// The default angles marked on the path of the colour.
const MARKED: [f64; 6] = [0.0, 15.0, 30.0, 45.0, 60.0, 75.0];

/// The default angle of the light in spectra of orders.
const LIGHT_ON_ORDERS: f64 = 30.0;

/// The default angles of the light on a cell.
const LIGHTS: [f64; 3] = [15.0, 45.0, 75.0];

pub fn run(args: &PlotArgs) -> Result<()> {
    PictureFormat::of(&args.output)?;
    let source = TableSource::find(&args.table)?;
    output::check_destination(&args.output, &source.files())?;
    if !args.phi.is_finite() {
        return Err(Error::usage(format_args!("--phi {}: the azimuth must be finite", args.phi)));
    }
    let table = one_surface(source.table(args.quiet)?, args.thickness)?;
    let name = table.name();
    let theta = args.theta.as_ref().map(|angles| angles.0.as_slice());
    let of_cells = args.theta_out.is_some() || args.phi_out.is_some();
    if of_cells && !(args.kind == PlotKind::Spectrum && matches!(table, Table::Scatter(_))) {
        return Err(Error::usage(format_args!(
            "{}: --theta-out and --phi-out are for the spectra of cells of tilted facets; leave them out",
            args.table.display()
        )));
    }
    if !matches!(table, Table::Orders(_)) {
        let given = [(!args.orders.is_empty(), "order"), (args.wavelength.is_some(), "wavelength")];
        if let Some((_, option)) = given.into_iter().find(|(given, _)| *given) {
            return Err(Error::usage(format_args!(
                "{}: --{option} is for tables of diffraction orders; leave it out",
                args.table.display()
            )));
        }
    }
    let finish = finish_choice(args.roughness, args.distribution, args.compensating.energy_compensation);
    if finish.is_given() && !(args.kind == PlotKind::Lobes && matches!(table, Table::Mirror(_))) {
        return Err(Error::usage(format_args!(
            "{}: --roughness, --distribution and --energy-compensation are for --kind lobes of a mirror-like table; leave them out",
            args.table.display()
        )));
    }
    let unused = match (&table, args.kind) {
        (_, PlotKind::Map | PlotKind::Angles) if theta.is_some() => Some("--theta: this picture shows every angle"),
        (Table::Orders(_), kind) if args.wavelength.is_some() && kind != PlotKind::Angles => {
            Some("--wavelength is for --kind angles")
        }
        (Table::Orders(_), PlotKind::Disc | PlotKind::Chromaticity) if !args.orders.is_empty() => {
            Some("--order: this picture shows every order")
        }
        (Table::Mirror(_), PlotKind::Disc) if theta.is_some() => {
            Some("--theta: the disc of a planar scene shows every angle")
        }
        (Table::Mirror(_), kind) if args.phi != 0.0 && kind != PlotKind::Lobes => {
            Some("--phi: a planar scene is the same in every azimuth")
        }
        _ => None,
    };
    if let Some(unused) = unused {
        return Err(Error::usage(format_args!("{}: {unused}; leave it out", args.table.display())));
    }
    if let (Table::Mirror(mirror), PlotKind::Disc | PlotKind::Chromaticity) = (&table, args.kind) {
        mirror.colours().map_err(|error| Error::failed(format_args!("{}: {error}", args.table.display())))?;
    }
    let picture = match &table {
        Table::Mirror(mirror) => match args.kind {
            PlotKind::Disc => tables::disc(&table, theta, args.phi)?,
            PlotKind::Spectrum => tables::mirror::spectra(mirror, name, theta.unwrap_or(&[0.0, 45.0, 75.0])),
            PlotKind::Map => tables::mirror::map(mirror, name)?,
            PlotKind::Chromaticity => tables::mirror::colour_path(mirror, name, theta.unwrap_or(&MARKED))?,
            PlotKind::Lobes => {
                let finish = finish.of(&mirror.metadata)?.ok_or_else(|| {
                    Error::usage(format_args!(
                        "{}: a planar scene without a finish has no lobes; give --roughness, or draw its disc, spectrum, \
                         map or chromaticity",
                        args.table.display()
                    ))
                })?;
                tables::facets::lobes(mirror, &finish.finish(), name, theta.unwrap_or(&LIGHTS), args.phi)?
            }
            PlotKind::Angles => {
                return Err(Error::usage(format_args!(
                    "{}: a planar scene has no orders; draw its disc, spectrum, map, chromaticity, or lobes with a finish",
                    args.table.display()
                )));
            }
        },
        Table::Scatter(scatter) => match args.kind {
            PlotKind::Disc => tables::disc(&table, theta, args.phi)?,
            PlotKind::Lobes => tables::lobes::lobes(scatter, name, theta.unwrap_or(&LIGHTS), args.phi)?,
            PlotKind::Spectrum => cell_spectra(scatter, name, theta.unwrap_or(&LIGHTS), args)?,
            PlotKind::Map => tables::scatter::map(scatter, name, args.phi)?,
            PlotKind::Chromaticity => tables::scatter::colour_path(scatter, name, theta.unwrap_or(&MARKED), args.phi)?,
            PlotKind::Angles => {
                return Err(Error::usage(format_args!(
                    "{}: the table has no diffraction orders; draw its disc, lobes, spectrum, map or chromaticity",
                    args.table.display()
                )));
            }
        },
        Table::Orders(orders) => match args.kind {
            PlotKind::Disc => tables::disc(&table, theta, args.phi)?,
            PlotKind::Chromaticity => tables::orders::colour_path(orders, name, theta.unwrap_or(&MARKED), args.phi)?,
            kind => charts_of_orders(orders, name, kind, args)?,
        },
    };
    save_picture(&picture, &args.output, args.quiet)
}

/// The spectra of a cell between the light and the direction that the options name.
fn cell_spectra(table: &ScatterTable, name: &str, theta_deg: &[f64], args: &PlotArgs) -> Result<Picture> {
    let phi_out = args.phi_out.unwrap_or(args.phi + 180.0);
    if !phi_out.is_finite() {
        return Err(Error::usage(format_args!("--phi-out {phi_out}: the azimuth must be finite")));
    }
    if let Some(theta) = args.theta_out.filter(|theta| !(0.0..90.0).contains(theta)) {
        return Err(Error::usage(format_args!("--theta-out {theta}: the angle must lie in [0, 90) degrees")));
    }
    tables::scatter::spectra(table, name, theta_deg, args.theta_out, [args.phi, phi_out])
}

/// The charts of chosen orders.
fn charts_of_orders(table: &OrderTable, name: &str, kind: PlotKind, args: &PlotArgs) -> Result<Picture> {
    let numbers = |order: &OrderArg| match (*order, table.layout.periodicity()) {
        (OrderArg::Crossed(order), _) => Ok(order),
        (OrderArg::Line(m), Periodicity::X) => Ok([m, 0]),
        (OrderArg::Line(n), Periodicity::Y) => Ok([0, n]),
        (OrderArg::Line(m), Periodicity::Both) => {
            Err(Error::usage(format_args!("--order {m}: orders of crossed periods have two numbers; name it {m},0")))
        }
    };
    let chosen = args.orders.iter().map(numbers).collect::<Result<Vec<_>>>()?;
    match kind {
        PlotKind::Spectrum => {
            let theta = args.theta.as_ref().map_or(&[LIGHT_ON_ORDERS][..], |angles| &angles.0);
            let &[theta] = theta else {
                return Err(Error::usage(
                    "--theta: spectra of orders are for the light of one direction; name one angle",
                ));
            };
            tables::orders::spectra(table, name, theta, args.phi, &chosen)
        }
        PlotKind::Angles => tables::orders::over_angle(table, name, args.wavelength, args.phi, &chosen),
        PlotKind::Map => tables::orders::map(table, name, args.phi, &chosen),
        PlotKind::Disc | PlotKind::Chromaticity | PlotKind::Lobes => Err(Error::usage(format_args!(
            "{}: diffraction orders have no lobes; draw their disc, spectrum, angles, map or chromaticity",
            args.table.display()
        ))),
    }
}
