//! The command `goniochrome orders`.

use crate::commands::args::OrdersArgs;
use crate::commands::cell_options::{light_direction, listed_wavelengths};
use crate::commands::csv_file::write_csv;
use crate::commands::notes::note_on_media;
use crate::scene::load;
use crate::solve::batches::BATCHES;
use crate::solve::diffraction::{Diffraction, OrdersRequest, default_hits, orders};
use crate::solve::groups::group_count;
use crate::solve::mesh_scene::MeshScene;
use crate::solve::order_error;
use crate::support::error::Result;
use crate::support::output;
use crate::support::progress::{bar, note};

pub fn run(args: &OrdersArgs) -> Result<()> {
    let scene = load(&args.scene)?;
    output::check_destination(&args.csv, &scene.files)?;
    let mesh_scene = MeshScene::new(&scene)?;
    let wavelengths = listed_wavelengths(&args.wavelengths, &scene)?;
    let request = OrdersRequest {
        rays: args.rays,
        seed: args.seed,
        max_order: args.max_order,
        hits: args.hits.unwrap_or_else(|| default_hits(&mesh_scene)),
        precision: args.precision,
        threads: args.running.threads(),
    };
    let quiet = args.running.quiet;
    note_on_media(&scene, wavelengths, quiet);
    let progress = bar(&scene.name, BATCHES as usize * group_count(wavelengths.len(), request.precision), quiet);
    let wi = light_direction(args.theta, args.phi)?;
    let found = orders(&mesh_scene, wi, wavelengths, &request, &|| progress.inc(1))?;
    progress.finish_and_clear();
    let off = order_error::warning(&mesh_scene, wi, wavelengths)?;
    for warning in [off, found.single_scattering_warning(request.hits)].into_iter().flatten() {
        note(quiet, format_args!("{}: {warning}", scene.name));
    }
    write(args, wavelengths, &found)
}

/// Writes one row for each order and wavelength. The last column belongs to the wavelength: light that was not traced
/// until it left.
fn write(args: &OrdersArgs, wavelengths: &[f64], found: &Diffraction) -> Result<()> {
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
