//! The command `goniochrome orders`.

use glam::DVec3;

use crate::commands::args::OrdersArgs;
use crate::commands::cell_options::{light_direction, listed_wavelengths};
use crate::commands::csv_file::write_csv;
use crate::commands::notes::{note_on_front, note_on_scene, note_on_waves};
use crate::commands::wave_choice::{RAYS, first_given, wave_cell};
use crate::scene::{Scene, load};
use crate::solve::batches::BATCHES;
use crate::solve::diffraction::{Diffraction, OrdersRequest, default_hits, orders};
use crate::solve::groups::group_count;
use crate::solve::mesh_scene::MeshScene;
use crate::solve::order_error;
use crate::solve::waves::WaveCell;
use crate::solve::waves::one_direction::{WaveDiffraction, WaveOrder, wave_orders};
use crate::support::error::{Error, Result};
use crate::support::output;
use crate::support::progress::{bar, note};

pub fn run(args: &OrdersArgs) -> Result<()> {
    let scene = load(&args.scene)?;
    output::check_destination(&args.csv, &scene.files)?;
    let wavelengths = listed_wavelengths(&args.wavelengths, &scene)?;
    let wi = light_direction(args.theta, args.phi)?;
    let accuracy = args.diffracting.accuracy(args.target_error);
    let cell = wave_cell(&scene, args.diffracting.method, ray_option(args), wavelengths, accuracy, args.running.quiet)?;
    note_on_scene(&scene, wavelengths, args.running.quiet);
    match cell {
        Some(cell) => by_waves(args, &cell, wi, wavelengths),
        None => by_rays(args, &scene, wi, wavelengths),
    }
}

/// The first option of rays that the user gave.
fn ray_option(args: &OrdersArgs) -> Option<&'static str> {
    first_given(&[
        ("--rays", args.rays.is_some()),
        ("--hits", args.hits.is_some()),
        ("--precision", args.precision.is_some()),
        ("--seed", args.seed.is_some()),
    ])
}

fn by_waves(args: &OrdersArgs, cell: &WaveCell<'_>, wi: DVec3, wavelengths: &[f64]) -> Result<()> {
    let name = &cell.scene().name;
    let accuracy = args.diffracting.accuracy(args.target_error);
    let progress = bar(name, wavelengths.len(), args.running.quiet);
    let found = wave_orders(cell, wi, wavelengths, accuracy, args.running.threads(), &|| progress.inc(1))?;
    progress.finish_and_clear();
    note_on_waves(cell, &found, accuracy, args.running.quiet)?;
    write_waves(args, &found)
}

/// Writes one row for each order and wavelength. Columns of a side on which the order does not travel are empty.
fn write_waves(args: &OrdersArgs, found: &[WaveDiffraction]) -> Result<()> {
    let mut rows = Vec::new();
    for WaveDiffraction { wavelength_nm, reflected, transmitted, error, .. } in found {
        let mut indices: Vec<[i32; 2]> = reflected.iter().chain(transmitted).map(|order| order.index).collect();
        indices.sort_unstable();
        indices.dedup();
        let shown = |[m, n]: &[i32; 2]| args.max_order.is_none_or(|max| m.abs() <= max && n.abs() <= max);
        for [m, n] in indices.into_iter().filter(shown) {
            let mut row = vec![m.to_string(), n.to_string(), wavelength_nm.to_string()];
            for orders in [reflected, transmitted] {
                match orders.iter().find(|order| order.index == [m, n]) {
                    Some(WaveOrder { direction, efficiency, .. }) => {
                        let theta = direction.x.hypot(direction.y).atan2(direction.z.abs()).to_degrees();
                        row.push(format!("{theta:.6}"));
                        row.extend([efficiency.s, efficiency.p].map(|e| format!("{e:.9}")));
                    }
                    None => row.extend([const { String::new() }; 3]),
                }
            }
            row.push(format!("{error:.2e}"));
            rows.push(([m, n], row));
        }
    }
    rows.sort_by_key(|(index, _)| *index);
    let header = ["m", "n", "wavelength_nm", "theta_deg", "R_s", "R_p", "transmitted_theta_deg", "T_s", "T_p", "error"];
    write_csv(&args.csv, &header, rows.into_iter().map(|(_, row)| row))
}

fn by_rays(args: &OrdersArgs, scene: &Scene, wi: DVec3, wavelengths: &[f64]) -> Result<()> {
    if args.target_error.is_some() || args.diffracting.max_harmonic.is_some() {
        return Err(Error::usage("--target-error, --max-harmonic: are of waves; give rays --rays"));
    }
    let mesh_scene = MeshScene::new(scene)?;
    note_on_front(scene, args.running.quiet);
    let request = OrdersRequest {
        rays: args.rays.unwrap_or(RAYS),
        seed: args.seed.unwrap_or(0),
        max_order: args.max_order,
        hits: args.hits.unwrap_or_else(|| default_hits(&mesh_scene)),
        precision: args.precision.unwrap_or_default(),
        threads: args.running.threads(),
    };
    let quiet = args.running.quiet;
    let progress = bar(&scene.name, BATCHES as usize * group_count(wavelengths.len(), request.precision), quiet);
    let found = orders(&mesh_scene, wi, wavelengths, &request, &|| progress.inc(1))?;
    progress.finish_and_clear();
    let off = order_error::warning(&mesh_scene, wi, wavelengths)?;
    for warning in [off, found.single_scattering_warning(request.hits)].into_iter().flatten() {
        note(quiet, format_args!("{}: {warning}", scene.name));
    }
    write_rays(args, wavelengths, &found)
}

/// Writes one row for each order and wavelength. The last column belongs to the wavelength: light that was not traced
/// until it left.
fn write_rays(args: &OrdersArgs, wavelengths: &[f64], found: &Diffraction) -> Result<()> {
    let left_out = |nm: f64| {
        let place = wavelengths.iter().position(|known| *known == nm).unwrap_or_default();
        let left_out = found.left_out[place];
        left_out.lost + left_out.in_flight
    };
    let rows = found.orders.iter().map(|order| {
        let [m, n] = order.index;
        let mut row = vec![m.to_string(), n.to_string(), order.wavelength_nm.to_string()];
        row.push(format!("{:.6}", order.theta_deg));
        let (s, p) = (order.efficiency.s, order.efficiency.p);
        row.extend([s.value, p.value, s.std_error, p.std_error].map(|x| format!("{x:.9}")));
        row.push(format!("{:.2e}", left_out(order.wavelength_nm)));
        row
    });
    let header =
        ["m", "n", "wavelength_nm", "theta_deg", "R_s", "R_p", "R_s_std_error", "R_p_std_error", "not_followed"];
    write_csv(&args.csv, &header, rows)
}
