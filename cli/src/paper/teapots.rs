//! The teapots of the paper's figures 3, 4 and 5, for `goniochrome figures`.

use std::path::Path;

use goniochrome::colour::RgbSpace;

use crate::paper::html::Section;
use crate::render::body::{Body, BodyShape, BvhMemory};
use crate::render::camera::{Camera, View};
use crate::render::environment::{Environment, EnvironmentLight};
use crate::render::mesh::{DEFAULT_LEVEL, TriangleMesh};
use crate::render::noise::Display;
use crate::render::surface::{MirrorChoice, Surface};
use crate::render::tone::ToneMap;
use crate::render::{Background, Quality, Sampling, Stage, render};
use crate::solve::colours::Colour;
use crate::support::error::Result;
use crate::support::output;
use crate::table::mirror::MirrorTable;

/// Width and height of a picture in pixels.
const SIZE: [u32; 2] = [640, 480];
/// Rays through each pixel.
const SAMPLES: u32 = 8;
/// Distance of the eye in radii of the body: the pot, twice as wide as high, then fills the picture.
const DISTANCE: f64 = 3.1;

/// A table of the colours at every degree, as a screen shows them.
pub(super) fn table(colours: &[Colour], space: RgbSpace) -> MirrorTable {
    let count = colours.len();
    MirrorTable {
        theta_deg: (0..count).map(|degree| degree as f64).collect(),
        wavelength_nm: vec![550.0],
        // Only the colours are shown.
        reflectance_s: vec![0.0; count],
        reflectance_p: vec![0.0; count],
        rgb: colours.iter().map(|colour| colour.display(space)).collect(),
        ..MirrorTable::default()
    }
}

/// Draws the pot in each light, and writes the pictures to files of the folder.
pub(super) fn draw(
    folder: &Path,
    table: MirrorTable,
    lights: Vec<(&str, EnvironmentLight)>,
    threads: usize,
) -> Result<Vec<String>> {
    let surface = Surface::new(&table.into(), false, MirrorChoice::default())?;
    let shape = BodyShape::Mesh(TriangleMesh::teapot(DEFAULT_LEVEL));
    let mut memory = BvhMemory::default();
    let body = Body::new(&shape, &mut memory)?;
    let (centre, radius) = body.bounds();
    let view = View { size: SIZE, distance: Some(DISTANCE), ..View::default() };
    let camera = Camera::new(&view, centre, radius)?;
    let quality = Quality { sampling: Sampling::Fixed(SAMPLES), reflections: 3, display: Display::default(), threads };
    lights
        .into_iter()
        .map(|(file, light)| {
            // White surroundings are shown grey, so that white edges are visible.
            let white = matches!(light, EnvironmentLight::White);
            let background = if white { Background::Colour([0.2; 3]) } else { Background::Environment };
            let environment = Environment::new(light, 0.0);
            let stage = Stage {
                body: &body,
                surface: &surface,
                environment: &environment,
                widened: &environment,
                camera: &camera,
                background,
            };
            let picture = render(&stage, &quality, &|_| ())?;
            output::write_file(&folder.join(file), &picture.png(0.0, ToneMap::None).0)?;
            Ok(file.to_owned())
        })
        .collect()
}

/// Draws figure 5: one surface in the studio and in white light.
pub(super) fn figure_5(folder: &Path, table: MirrorTable, threads: usize) -> Result<Section> {
    let lights = vec![
        ("figure-5-studio.png", EnvironmentLight::Studio(Box::default())),
        ("figure-5-white.png", EnvironmentLight::White),
    ];
    Ok(Section {
        heading: "Figure 5: an environment against white light".into(),
        images: draw(folder, table, lights, threads)?,
        caption_html: "<p>The three films of figure 4 on Newell’s teapot, exact physics, D65 and sRGB. Left the built-in \
                       studio, looked up in the mirror direction and multiplied by the table; right light of radiance 1 from \
                       everywhere, in which each point has the colour of its angle of view. Light is followed over three \
                       reflections by the pot.</p>"
            .into(),
    })
}
