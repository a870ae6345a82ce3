//! `goniochrome orders`.

use crate::args::OrdersArgs;
use crate::bumpy::Bumpy;
use crate::commands::{direction, remark_on_media, write_csv};
use crate::diffraction::{Request, default_hits, orders, unreliable};
use crate::error::{Error, Result};
use crate::grid::Wavelengths;
use crate::output;
use crate::progress::remark;
use crate::scene::load;

pub fn run(args: &OrdersArgs) -> Result<()> {
    let scene = load(&args.scene)?;
    output::check_destination(&args.csv, &scene.files)?;
    let bumpy = Bumpy::new(&scene)?;
    let Wavelengths::List(wavelengths) = &args.wavelengths else {
        return Err(Error::usage("--wavelengths auto: name the wavelengths of orders, or give start:end:step"));
    };
    let request = Request {
        rays: args.rays,
        seed: args.seed,
        most: args.most_order,
        hits: args.hits.unwrap_or_else(|| default_hits(&bumpy)),
        threads: args.threads.map_or_else(crate::parallel::available, usize::from),
    };
    remark_on_media(&scene, wavelengths, false);
    let found = orders(&bumpy, direction(args.theta, args.phi)?, wavelengths, &request)?;
    if let Some(warning) = unreliable(&bumpy, wavelengths) {
        remark(false, warning);
    }
    let rows = found.iter().map(|order| {
        let [m, n] = order.index;
        let mut row = vec![m.to_string(), n.to_string(), order.wavelength_nm.to_string()];
        row.push(format!("{:.6}", order.theta_deg));
        let (s, p) = (order.efficiency.s, order.efficiency.p);
        row.extend([s.value, p.value, s.std_error, p.std_error].map(|x| format!("{x:.9}")));
        row
    });
    let header = ["m", "n", "wavelength_nm", "theta_deg", "R_s", "R_p", "R_s_std_error", "R_p_std_error"];
    write_csv(&args.csv, &header, rows)
}
