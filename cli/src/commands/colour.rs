//! The command `goniochrome colour`.

use std::io::IsTerminal;
use std::path::Path;

use goniochrome::colour::{Quadrature, RgbSpace};

use crate::commands::args::ColourArgs;
use crate::commands::csv_file::write_csv;
use crate::commands::planar_spectra::{compute_spectra, note_on_colours};
use crate::plot::{OutOfGamut, hex, srgb8};
use crate::scene::load;
use crate::solve::colours::{Colour, colours};
use crate::solve::planar_scene::PlanarScene;
use crate::support::error::Result;
use crate::support::output;
use crate::support::progress::note;

pub fn run(args: &ColourArgs) -> Result<()> {
    let scene = load(&args.scene)?;
    if let Some(csv) = &args.csv {
        output::check_destination(csv, &scene.files)?;
    }
    let planar = PlanarScene::new(&scene)?;
    let (wavelengths, illuminant) = (args.wavelengths.increasing(), args.colouring.illuminant.into());
    let spectra = compute_spectra(&planar, &args.theta.0, &wavelengths, illuminant, &args.computing)?;
    let space = RgbSpace::from(args.colouring.space);
    let colours = colours(&spectra, illuminant, space, Quadrature::Interpolated)?;
    note_on_colours(&planar, &spectra, &wavelengths, illuminant, &args.computing)?;
    let of_gamut = |all: OutOfGamut, colour: &Colour| all + OutOfGamut::of(colour.display(space));
    if let Some(said) = colours.iter().fold(OutOfGamut::default(), of_gamut).note() {
        note(args.computing.running.quiet, said);
    }
    match &args.csv {
        Some(path) => {
            let rows = colours.iter().zip(&spectra.theta_deg).map(|(colour, theta)| {
                let mut row = vec![theta.to_string()];
                row.extend(colour.xyz.iter().chain(&colour.rgb).map(|x| format!("{x:.6}")));
                row.push(hex(colour.display(space)));
                row
            });
            write_csv(path, &["theta_deg", "X", "Y", "Z", "R", "G", "B", "hex"], rows)
        }
        None => output::write_text(Path::new("-"), &table(&spectra.theta_deg, &colours, space)),
    }
}

/// The colours as a table to read, with a swatch in each row if the terminal can show one.
fn table(theta_deg: &[f64], colours: &[Colour], space: RgbSpace) -> String {
    let coloured = std::io::stdout().is_terminal();
    let mut text = String::from(" theta       R       G       B  on a screen\n");
    for (theta, colour) in theta_deg.iter().zip(colours) {
        let display = colour.display(space);
        let [r, g, b] = srgb8(display);
        let swatch = if coloured { format!("\x1b[48;2;{r};{g};{b}m        \x1b[0m ") } else { String::new() };
        let [red, green, blue] = colour.rgb;
        let mark = OutOfGamut::of(display).note().map_or("", |_| " out of gamut");
        text += &format!("{theta:5.1}° {red:7.3} {green:7.3} {blue:7.3}  {swatch}{}{mark}\n", hex(display));
    }
    text
}
