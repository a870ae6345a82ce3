//! `goniochrome estimate`.

use std::collections::BTreeMap;

use goniochrome::colour::{Quadrature, RgbSpace};

use crate::args::{EstimateArgs, spelled};
use crate::colours::colours;
use crate::commands::compute;
use crate::commands::plot::disc_of;
use crate::error::{Error, Result};
use crate::estimate::Spectra;
use crate::output;
use crate::planar::Planar;
use crate::progress::remark;
use crate::scene::{Scene, load};
use crate::table::MirrorTable;
use crate::table_file;

pub fn run(args: &EstimateArgs) -> Result<()> {
    if args.output.extension().is_none_or(|extension| !extension.eq_ignore_ascii_case("exr")) {
        return Err(Error::usage(format_args!("{}: a table is written as .exr; name it so", args.output.display())));
    }
    let scene = load(&args.scene)?;
    for path in [Some(&args.output), args.plot.as_ref()].into_iter().flatten() {
        output::check_destination(path, &scene.files)?;
    }
    let planar = Planar::new(&scene)?;
    let theta_deg: Vec<f64> = (0..args.angles).map(|i| 90.0 * f64::from(i) / f64::from(args.angles)).collect();
    let spectra = compute(&planar, &theta_deg, &args.wavelengths, &args.computing)?;
    let colours = colours(
        &spectra,
        args.colouring.illuminant.into(),
        RgbSpace::from(args.colouring.space),
        Quadrature::Interpolated,
    )?;
    let reflectance = |of: fn(&crate::estimate::Sample) -> f64| spectra.samples.iter().map(|s| of(s) as f32).collect();
    let table = MirrorTable {
        reflectance_s: reflectance(|sample| sample.reflectance.s),
        reflectance_p: reflectance(|sample| sample.reflectance.p),
        rgb: colours.iter().map(|colour| colour.rgb.map(|c| c as f32)).collect(),
        metadata: metadata(args, &scene, &spectra),
        theta_deg,
        wavelength_nm: spectra.wavelength_nm.clone(),
    };
    table_file::write(&args.output, &table)?;
    if let Some(path) = &args.plot {
        disc_of(&table).save(path)?;
    }
    remark(
        args.computing.quiet,
        format_args!(
            "{}: {} angles × {} wavelengths; truncated ≤ {:.1e}, imbalance ≤ {:.1e}",
            args.output.display(),
            table.theta_deg.len(),
            table.wavelength_nm.len(),
            spectra.worst(|sample| sample.truncated),
            spectra.worst(|sample| sample.imbalance)
        ),
    );
    Ok(())
}

/// How the table was made. Nothing here depends on when or where, so equal runs give equal files.
fn metadata(args: &EstimateArgs, scene: &Scene, spectra: &Spectra) -> BTreeMap<String, String> {
    [
        ("generator", format!("goniochrome {}", env!("CARGO_PKG_VERSION"))),
        ("scene", scene.name.clone()),
        ("scene_toml", scene.toml.clone()),
        ("model", spelled(args.computing.model)),
        ("method", spelled(args.computing.method)),
        ("precision", spelled(args.computing.precision)),
        ("illuminant", spelled(args.colouring.illuminant)),
        ("colour_space", spelled(args.colouring.space)),
        ("observer", "CIE 1931 2 degree".into()),
        ("truncated_max", format!("{:e}", spectra.worst(|sample| sample.truncated))),
        ("imbalance_max", format!("{:e}", spectra.worst(|sample| sample.imbalance))),
    ]
    .map(|(key, value)| (key.to_owned(), value))
    .into()
}
