//! The command `goniochrome spectrum`.

use goniochrome::colour::Illuminant;

use crate::commands::args::SpectrumArgs;
use crate::commands::csv_file::{number, write_csv};
use crate::commands::planar_spectra::compute_spectra;
use crate::scene::load;
use crate::solve::planar_scene::PlanarScene;
use crate::support::error::Result;
use crate::support::output;

pub fn run(args: &SpectrumArgs) -> Result<()> {
    let scene = load(&args.scene)?;
    output::check_destination(&args.csv, &scene.files)?;
    let planar = PlanarScene::new(&scene)?;
    let spectra = compute_spectra(&planar, &args.theta.0, &args.wavelengths, Illuminant::D65, &args.computing)?;
    let rows = (0..spectra.theta_deg.len()).flat_map(|angle| {
        let spectra = &spectra;
        spectra.row(angle).iter().zip(&spectra.wavelength_nm).map(move |(sample, nm)| {
            let mut row = vec![spectra.theta_deg[angle].to_string(), nm.to_string()];
            row.extend(
                [
                    sample.reflectance.s,
                    sample.reflectance.p,
                    sample.transmittance.s,
                    sample.transmittance.p,
                    sample.truncated,
                ]
                .map(|x| number(x, args.computing.precision)),
            );
            row
        })
    });
    write_csv(&args.csv, &["theta_deg", "wavelength_nm", "R_s", "R_p", "T_s", "T_p", "truncated"], rows)
}
