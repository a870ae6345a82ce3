//! The command `goniochrome lookup`.

use std::path::Path;

use glam::DVec3;

use crate::colour::space_name;
use crate::commands::args::{DirectionArg, LookupArgs, finish_choice};
use crate::commands::csv_file::{number, write_csv};
use crate::commands::table_source::TableSource;
use crate::commands::thickness_option::one_surface;
use crate::export::{Delta, Deltas, LobeWidth, RGB, Reflection, ReflectionKind};
use crate::solve::precision::Precision;
use crate::support::error::{Error, Result};
use crate::support::input::read_bytes;
use crate::support::output;
use crate::support::progress::note;
use crate::support::text::one_line;
use crate::table::Table;
use crate::table::finish::is_finished;

/// The length of the longest file of pairs: 64 MiB.
const MAX_BYTES: u64 = 64 << 20;

/// A direction towards the light, and one towards the viewer if there is one.
type Pair = (DirectionArg, Option<DirectionArg>);

pub fn run(args: &LookupArgs) -> Result<()> {
    let source = TableSource::find(&args.table)?;
    let mut inputs = source.files();
    inputs.extend(args.pairs.clone());
    if let Some(csv) = &args.csv {
        output::check_destination(csv, &inputs)?;
    }
    let width = LobeWidth {
        finish: finish_choice(args.roughness, args.distribution, args.compensating.energy_compensation),
        spread_deg: args.spread,
    };
    let with_width = width != LobeWidth::default();
    let pairs = match (&args.pairs, args.wi) {
        (Some(path), _) => read_pairs(path)?,
        (None, wi) => wi.map(|wi| (wi, args.wo)).into_iter().collect(),
    };
    let to_viewer = pairs.iter().all(|(_, wo)| wo.is_some());
    if with_width && !to_viewer {
        return Err(Error::usage("--roughness, --spread: are for f, which needs --wo; give it, or leave them out"));
    }
    let table = one_surface(source.table(args.quiet)?, args.thickness)?;
    let deltas = Deltas::new(&table)?;
    let finished = is_finished(table.metadata());
    let has_f = with_width || matches!(table, Table::Scatter(_)) || finished;
    if finished && !to_viewer {
        return Err(Error::usage(
            "--wo is missing: the table has a finish, which reflects into all directions; give it, as --wo 45,180",
        ));
    }
    match deltas {
        _ if to_viewer && has_f => values(args, &table, &pairs, width, deltas.filter(|_| args.spread.is_none())),
        Some(deltas) => list(args, &table, &pairs, &deltas),
        None => {
            let what =
                "--wo is missing: the table has no exact directions, and f needs the direction towards the viewer";
            Err(Error::usage(format_args!("{what}; give it, as --wo 45,180")))
        }
    }
}

/// Reads a file of pairs.
fn read_pairs(path: &Path) -> Result<Vec<Pair>> {
    let label = path.display();
    let failed = |error| Error::failed(format_args!("cannot read {label}: {error}"));
    let bytes = read_bytes(path, MAX_BYTES, "a file of pairs", failed)?;
    let mut reader = csv::ReaderBuilder::new();
    let mut reader = reader.has_headers(false).flexible(true).trim(csv::Trim::All).from_reader(&bytes[..]);
    let mut pairs = Vec::new();
    for (i, record) in reader.records().enumerate() {
        let record = record.map_err(|error| Error::failed(format_args!("{label}: {error}")))?;
        let line = record.position().map_or(i as u64 + 1, csv::Position::line);
        let at = |what: &str| Error::failed(format_args!("{label}, line {line}: {what}"));
        let numbers: Vec<Option<f64>> = record.iter().map(|field| field.parse().ok()).collect();
        match numbers[..] {
            [Some(theta_i), Some(phi_i), Some(theta_o), Some(phi_o)] => {
                let direction = |theta, phi| DirectionArg::new(theta, phi).map_err(|what| at(&what));
                pairs.push((direction(theta_i, phi_i)?, Some(direction(theta_o, phi_o)?)));
            }
            // A header.
            [None, None, None, None] if i == 0 => {}
            _ => return Err(at("expected four numbers in degrees: theta_i,phi_i,theta_o,phi_o")),
        }
    }
    if pairs.is_empty() {
        return Err(Error::failed(format_args!(
            "{label}: holds no pairs; write theta_i,phi_i,theta_o,phi_o, one in a line"
        )));
    }
    Ok(pairs)
}

/// The angles of a direction as fields of CSV.
fn angles(direction: DirectionArg) -> [String; 2] {
    direction.0.map(|angle| angle.to_string())
}

/// The angles of a direction to read.
fn spelled(direction: DirectionArg) -> String {
    let [theta, phi] = direction.0;
    format!("θ = {theta}°, φ = {phi}°")
}

/// What stands above the numbers of a pair to read.
fn heading(table: &Table, (wi, wo): &Pair) -> String {
    let towards = wo.map_or_else(String::new, |wo| format!("; viewer {}", spelled(wo)));
    format!("{}: light {}{towards}", one_line(table.name()), spelled(*wi))
}

/// The line that names the colour space.
fn of_space(table: &Table) -> String {
    format!("R, G, B are linear, in the space {}\n", space_name(table.metadata().space()))
}

/// A number to read: six digits.
fn digits(x: f64) -> String {
    if x == 0.0 || (1e-3..1e5).contains(&x.abs()) {
        let whole = x.abs().max(1.0).log10().floor() as usize;
        format!("{x:.*}", 6 - whole)
    } else {
        format!("{x:.5e}")
    }
}

/// Writes f of each pair, and the exact directions that it leaves out.
fn values(
    args: &LookupArgs,
    table: &Table,
    pairs: &[Pair],
    width: LobeWidth,
    left_out: Option<Deltas<'_>>,
) -> Result<()> {
    let reflection = |rgb: bool| match table {
        Table::Scatter(table) if width == LobeWidth::default() => Reflection::scatter(table, None, rgb),
        _ => Reflection::new(table, width, rgb),
    };
    let spectral = reflection(false)?;
    // Only a table of invisible wavelengths has no colour.
    let rgb = reflection(true).ok();
    let error = Reflection::luminance_error(table)?;
    let mut columns: Vec<String> = spectral.wavelength_nm.iter().map(f64::to_string).collect();
    if rgb.is_some() {
        columns.extend(RGB.map(str::to_owned));
    }
    let reflections = [Some(&spectral), rgb.as_ref(), error.as_ref()];
    let mut evaluators: Vec<_> = reflections.into_iter().flatten().map(Reflection::evaluator).collect();
    let mut at = |wi: DVec3, wo: DVec3| {
        let mut found = Vec::with_capacity(columns.len() + 1);
        for evaluator in &mut evaluators {
            let from = found.len();
            found.resize(from + evaluator.reflection().channels, 0.0);
            evaluator.eval(wi, wo, &mut found[from..]);
        }
        found
    };
    let both = pairs.iter().filter_map(|(wi, wo)| Some((*wi, (*wo)?)));
    if let Some(path) = &args.csv {
        if left_out.is_some() && matches!(table, Table::Scatter(_)) {
            let said =
                "f leaves out exact lobes of flat facets: --spread gives them a width, without --wo they are listed";
            note(args.quiet, format_args!("{}: {said}", args.table.display()));
        }
        let mut header = ["theta_i_deg", "phi_i_deg", "theta_o_deg", "phi_o_deg"].map(str::to_owned).to_vec();
        header.extend(columns.iter().map(|column| format!("f_{column}")));
        header.extend(error.is_some().then(|| "luminance_std_error".to_owned()));
        let facets = match spectral.kind() {
            ReflectionKind::Lobe { finish, .. } => Some(finish.finish()),
            _ => None,
        };
        header.extend(facets.is_some().then(|| "pdf".to_owned()));
        let header: Vec<&str> = header.iter().map(String::as_str).collect();
        let rows = both.map(|(wi, wo)| {
            let mut row = [angles(wi), angles(wo)].concat();
            row.extend(at(wi.vector(), wo.vector()).into_iter().map(|f| number(f, Precision::F32)));
            if let Some(facets) = &facets {
                let lobe = facets.lobe(wi.vector().as_vec3(), wo.vector().as_vec3());
                row.push(number(lobe.map_or(0.0, |lobe| lobe.pdf.into()), Precision::F32));
            }
            row
        });
        return write_csv(path, &header, rows);
    }
    let mut text = String::new();
    for (wi, wo) in both {
        text += &format!("{}\n{:>10}  f in 1/sr\n", heading(table, &(wi, Some(wo))), "nm");
        let found = at(wi.vector(), wo.vector());
        for (column, f) in columns.iter().zip(&found) {
            text += &format!("{column:>10}  {}\n", digits(*f));
        }
        if error.is_some() {
            text += &format!("standard error of the luminance of f: {}\n", digits(found[columns.len()]));
        }
        if let (Some(left_out), Table::Scatter(_)) = (&left_out, table) {
            text += &text_of(&listed(left_out, &(wi, Some(wo)))?);
        }
    }
    text += &rgb.map_or_else(String::new, |_| of_space(table));
    output::write_text(Path::new("-"), &text)
}

/// The angle in degrees from the direction towards the viewer, if there is one, and light in an exact direction.
type Listed = (Option<f64>, Delta);

/// The exact directions of a pair, those near the viewer first.
fn listed(deltas: &Deltas<'_>, (wi, wo): &Pair) -> Result<Vec<Listed>> {
    let away = |delta: &Delta| wo.map(|wo| delta.direction.angle_between(wo.vector()).to_degrees());
    let mut listed: Vec<Listed> = deltas.at(wi.vector())?.into_iter().map(|delta| (away(&delta), delta)).collect();
    listed.sort_by(|(a, _), (b, _)| a.unwrap_or(0.0).total_cmp(&b.unwrap_or(0.0)));
    Ok(listed)
}

/// Polar angle and azimuth in degrees.
fn polar(direction: DVec3) -> [f64; 2] {
    let theta = direction.x.hypot(direction.y).atan2(direction.z);
    // −180° and 180° are one azimuth.
    let phi = direction.y.atan2(direction.x).to_degrees();
    [theta.to_degrees(), if phi <= -180.0 + 1e-9 { 180.0 } else { phi }]
}

/// Light in exact directions to read.
fn text_of(listed: &[Listed]) -> String {
    let mut text = "light leaves in exact directions, where f is a delta:\n".to_owned();
    text += &format!("{:<14} {:>10} {:>8} {:>8}  power\n", "lobe", "nm", "θ", "φ");
    for (away, delta) in listed {
        let [theta, phi] = polar(delta.direction);
        let away = away.map_or_else(String::new, |away| format!("  {away:.2}° from the viewer"));
        let (name, channel, power) = (&delta.name, &delta.channel, digits(delta.power));
        text += &format!("{name:<14} {channel:>10} {theta:>7.2}° {phi:>7.2}°  {power}{away}\n");
    }
    text
}

/// Writes light that leaves in exact directions.
fn list(args: &LookupArgs, table: &Table, pairs: &[Pair], deltas: &Deltas<'_>) -> Result<()> {
    let to_viewer = pairs.iter().all(|(_, wo)| wo.is_some());
    let found = pairs.iter().map(|pair| listed(deltas, pair)).collect::<Result<Vec<_>>>()?;
    if let Some(path) = &args.csv {
        let mut header = vec!["theta_i_deg", "phi_i_deg", "lobe", "channel", "theta_o_deg", "phi_o_deg", "power"];
        header.extend(to_viewer.then_some("from_viewer_deg"));
        let rows = pairs.iter().zip(&found).flat_map(|((wi, _), listed)| {
            listed.iter().map(move |(away, delta)| {
                let mut row = angles(*wi).to_vec();
                row.extend([delta.name.clone(), delta.channel.clone()]);
                row.extend(polar(delta.direction).map(|angle| format!("{angle:.6}")));
                row.push(number(delta.power, Precision::F32));
                row.extend(away.map(|away| format!("{away:.6}")));
                row
            })
        });
        return write_csv(path, &header, rows);
    }
    let mut text = String::new();
    for (pair, listed) in pairs.iter().zip(&found) {
        text += &format!("{}\n", heading(table, pair));
        text += &text_of(listed);
    }
    if !matches!(table, Table::Orders(_)) {
        text += &of_space(table);
    }
    output::write_text(Path::new("-"), &text)
}
