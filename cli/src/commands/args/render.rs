//! Arguments of `render`.

use std::path::PathBuf;
use std::str::FromStr;

use clap::Args;
use goniochrome::microfacet::Distribution;

use crate::commands::args::shared::{Compensating, Running};
use crate::commands::args::values::{BodyArg, RoughnessArg, distribution, roughness_or_mirror};
use crate::render::Background;
use crate::render::camera::View;
use crate::render::mesh::{Axes, DEFAULT_LEVEL};
use crate::render::tone::ToneMap;

/// Arguments of `render`.
#[derive(Debug, Args)]
pub struct RenderArgs {
    /// A table made by `estimate`, or a scene file or preset, whose table is made in memory
    #[arg(value_name = "TABLE|SCENE")]
    pub table: PathBuf,
    /// The picture: .exr (scene-linear R, G, B, A) or .png
    #[arg(long, short, value_name = "FILE")]
    pub output: PathBuf,
    /// The light: white (1 from everywhere), studio (built in, neutral), lamp (small and round; lamp:ELEVATION,AZIMUTH,
    /// DIAMETER in degrees), or a lat-long image (.exr or Radiance .hdr)
    #[arg(long, value_name = "white|studio|lamp|FILE", default_value = "studio")]
    pub env: String,
    /// Turn the light about the vertical, in degrees, counter-clockwise as seen from above
    #[arg(long, default_value_t = 0.0, allow_negative_numbers = true)]
    pub env_turn: f64,
    /// The lit body: teapot, sphere (exact), plane, disc (a ring with circular tracks), or an OBJ with z up
    #[arg(long, value_name = "teapot|sphere|plane|disc|FILE", default_value = "teapot")]
    pub mesh: String,
    /// Which way is up in the OBJ
    #[arg(long, value_enum, default_value_t = Axes::ZUp)]
    pub axes: Axes,
    /// Segments along each edge of the teapot's patches
    #[arg(long, default_value_t = DEFAULT_LEVEL, value_parser = clap::value_parser!(u32).range(1..=256))]
    pub level: u32,
    /// Where the camera stands
    #[command(flatten)]
    pub view: ViewArgs,
    /// Rays through each pixel; powers of two are spread most evenly, and 1 goes through the middle [default: as many
    /// as --target-noise takes]
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..=1 << 20))]
    pub samples: Option<u32>,
    /// Follow rays until the noise is so small: its root mean square over the body, in steps of 1/255 of sRGB; from 0.1
    /// to 30 [default: 1.4]
    #[arg(long, value_name = "STEPS")]
    pub target_noise: Option<f64>,
    /// Draw fast and without noise, from few fixed directions and blurred light; one reflection
    #[arg(long)]
    pub preview: bool,
    /// Number of reflections to trace where the body reflects itself. With 1 it does not see itself. With more, light
    /// is traced from part to part; the last part sees the environment as if nothing stood in between
    /// [default: 1, for sheets 3]
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..=64))]
    pub reflections: Option<u32>,
    /// Mirror-like tables: whether light goes through [default: sheet for films in one clear medium]
    #[arg(long, value_enum)]
    pub body: Option<BodyArg>,
    /// Tables over the thickness of a layer, by `estimate --vary`: one thickness in nm; drain (a film that drains, thin
    /// at the top); noise (swirls); or a greyscale picture over the texture coordinates, from the first thickness (0)
    /// to the last (1)
    #[arg(long, value_name = "NM|drain|noise|FILE")]
    pub thickness: Option<String>,
    /// Diffraction orders and facet lobes: the standard deviation of their width, in degrees; 0 is sharp
    #[arg(long, value_name = "DEGREES", default_value_t = 0.0)]
    pub spread: f64,
    /// Mirror-like tables: the roughness α of the surface, in (0, 1], or two numbers along the tangent and the
    /// binormal; 0 is a mirror [default: the table's finish]
    #[arg(long, value_name = "ALPHA[,ALPHA]", value_parser = roughness_or_mirror, allow_hyphen_values = true)]
    pub roughness: Option<RoughnessArg>,
    /// Mirror-like tables: the distribution of the facets' normals, ggx or beckmann [default: the table's, else ggx]
    #[arg(long, value_name = "ggx|beckmann", value_parser = distribution)]
    pub distribution: Option<Distribution>,
    /// Several bounces among facets
    #[command(flatten)]
    pub compensating: Compensating,
    /// Shade each wavelength of the table and then integrate, with the environment's RGB turned into smooth spectra;
    /// without this option RGB is shaded
    #[arg(long)]
    pub spectral: bool,
    /// The background: environment, transparent, or linear R,G,B such as 0.2,0.2,0.2
    #[arg(long, value_name = "WHAT", default_value = "environment")]
    pub background: BackgroundArg,
    /// PNG: brighter by this many stops; EXR stays scene-linear
    #[arg(long, value_name = "STOPS", default_value_t = 0.0, allow_negative_numbers = true)]
    pub exposure: f64,
    /// PNG: the curve that brings bright light into the range of a screen
    #[arg(long, value_enum, default_value_t = ToneMap::None)]
    pub tonemap: ToneMap,
    /// Threads and messages
    #[command(flatten)]
    pub running: Running,
}

/// Options of the camera.
#[derive(Debug, Clone, Args)]
pub struct ViewArgs {
    /// Azimuth of the camera around the vertical, in degrees from +x
    #[arg(long, default_value_t = View::default().azimuth_deg, allow_negative_numbers = true)]
    pub azimuth: f64,
    /// Elevation of the camera above the horizon, in degrees
    #[arg(long, default_value_t = View::default().elevation_deg, allow_negative_numbers = true)]
    pub elevation: f64,
    /// Field of view of the picture's shorter side, in degrees
    #[arg(long, default_value_t = View::default().field_of_view_deg)]
    pub fov: f64,
    /// Distance of the camera from the middle of the mesh, in radii of a sphere around it [default: the sphere fits
    /// into the picture]
    #[arg(long)]
    pub distance: Option<f64>,
    /// Width and height in pixels: 1024, or 1280x720
    #[arg(long, default_value = "1024")]
    pub size: SizeArg,
}

impl ViewArgs {
    /// The view of the camera.
    #[must_use]
    pub fn view(&self) -> View {
        View {
            azimuth_deg: self.azimuth,
            elevation_deg: self.elevation,
            field_of_view_deg: self.fov,
            distance: self.distance,
            size: self.size.0,
        }
    }
}

/// The value of `--size`: width and height in pixels.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SizeArg(pub [u32; 2]);

impl FromStr for SizeArg {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (width, height) = text.split_once('x').unwrap_or((text, text));
        match (width.parse(), height.parse()) {
            (Ok(width), Ok(height)) => Ok(Self([width, height])),
            _ => Err("expected a number of pixels such as 1024, or width and height such as 1280x720".into()),
        }
    }
}

/// The value of `--background`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BackgroundArg(pub Background);

impl FromStr for BackgroundArg {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "environment" => return Ok(Self(Background::Environment)),
            "transparent" => return Ok(Self(Background::Transparent)),
            _ => {}
        }
        let numbers: Result<Vec<f32>, _> = text.split(',').map(str::parse).collect();
        match numbers.map(<[f32; 3]>::try_from) {
            Ok(Ok(rgb)) if rgb.iter().all(|c| c.is_finite()) => Ok(Self(Background::Colour(rgb))),
            _ => Err("expected environment, transparent, or three numbers such as 0.2,0.2,0.2".into()),
        }
    }
}
