//! The command `goniochrome render`.

use std::fs;
use std::path::{Path, PathBuf};

use crate::commands::args::RenderArgs;
use crate::commands::body_option::is_sheet;
use crate::commands::finish_option::finish;
use crate::commands::spread_option::spread;
use crate::commands::table_source::TableSource;
use crate::commands::thickness_option::{map_file, thickness};
use crate::obj;
use crate::render::body::{Body, BodyShape, BvhMemory};
use crate::render::camera::Camera;
use crate::render::decode::decode;
use crate::render::environment::{Environment, EnvironmentLight};
use crate::render::lamp::Lamp;
use crate::render::mesh::{Axes, DEFAULT_LEVEL, TriangleMesh};
use crate::render::noise::{Display, NoiseReached};
use crate::render::spread::spread_environment;
use crate::render::surface::{MirrorChoice, Surface};
use crate::render::tone::ToneMap;
use crate::render::{Progress, Quality, Sampling, Stage, render};
use crate::support::error::{Error, Result};
use crate::support::output;
use crate::support::progress::{bar, note};
use crate::support::text::plain;
use crate::table::Table;

/// The size of the largest file that is read as an environment: 1 GiB.
const MAX_BYTES: u64 = 1 << 30;

/// Reflections on a way through a sheet: a bubble's inner wall is seen through its outer one.
const SHEET_REFLECTIONS: u32 = 3;

/// Noise that a picture has by default, in steps of 1/255: nobody sees it.
const DEFAULT_TARGET: f64 = 1.4;
/// Smallest and largest target of noise: less than the rounding to 8 bits, and a tenth of the range.
const TARGETS: [f64; 2] = [0.1, 30.0];

pub fn run(args: &RenderArgs) -> Result<()> {
    let format = RenderFormat::of(&args.output)?;
    let source = TableSource::find(&args.table)?;
    let mut inputs = source.files();
    inputs.extend([file_of(&args.env), file_of(&args.mesh), map_file(args.thickness.as_deref())].into_iter().flatten());
    output::check_destination(&args.output, &inputs)?;
    for (option, value) in [("--env-turn", args.env_turn), ("--exposure", args.exposure)] {
        if !value.is_finite() || value.abs() > 1e4 {
            return Err(Error::usage(format_args!("{option} {value}: must be finite and at most 10000")));
        }
    }
    if args.axes != Axes::ZUp && file_of(&args.mesh).is_none() {
        let what = format!("--axes: {} has z up already; it is for meshes from files", args.mesh);
        return Err(Error::usage(what));
    }
    if args.level != DEFAULT_LEVEL && args.mesh != "teapot" {
        return Err(Error::usage(format_args!("--level: divides the teapot; --mesh {} does not use it", args.mesh)));
    }
    if matches!(format, RenderFormat::Exr) && (args.exposure != 0.0 || args.tonemap != ToneMap::None) {
        return Err(Error::usage(format_args!(
            "{}: an EXR holds radiance as it is; leave --exposure and --tonemap out, or write a .png",
            args.output.display()
        )));
    }
    let sampling = sampling(args)?;
    let view = args.view.view();
    // Bad options are refused before files are read.
    Camera::new(&view, glam::DVec3::ZERO, 1.0)?;
    let lamp = lamp(&args.env)?;

    let table = source.table(args.running.quiet)?;
    let spread = spread(args.spread, &table)?;
    if args.reflections.is_some_and(|reflections| reflections > 1) && matches!(table, Table::Orders(_)) {
        let what = "--reflections: each reflection by diffraction orders branches into all of them; leave it out";
        return Err(Error::usage(what));
    }
    let name = |error: Error| Error::failed(format_args!("{}: {error}", args.table.display()));
    let finish = finish(args.roughness, args.distribution, args.compensating, &table)?;
    let is_sheet = is_sheet(args.body, &table)?;
    let thickness = thickness(args.thickness.as_deref(), &table)?;
    let surface = Surface::new(&table, args.spectral, MirrorChoice { finish, is_sheet, thickness }).map_err(name)?;
    surface.check_not_black().map_err(name)?;
    let light = lamp.map_or_else(|| light(&args.env, args.running.quiet), |lamp| Ok(EnvironmentLight::Lamp(lamp)))?;
    let environment = Environment::new(light, args.env_turn);
    let spread = spread.map(|width| spread_environment(&environment, width, args.running.threads())).transpose()?;
    let shape = shape(&args.mesh, args.axes, args.level, args.running.quiet)?;
    let mut memory = BvhMemory::default();
    let body = Body::new(&shape, &mut memory)?;
    let (centre, radius) = body.bounds();
    let camera = Camera::new(&view, centre, radius)?;

    let stage = Stage {
        body: &body,
        surface: &surface,
        environment: &environment,
        widened: spread.as_ref().unwrap_or(&environment),
        camera: &camera,
        background: args.background.0,
    };
    let display = Display { stops: args.exposure, tone: args.tonemap };
    let reflections = args.reflections.unwrap_or(if is_sheet { SHEET_REFLECTIONS } else { 1 });
    let quality = Quality { sampling, reflections, display, threads: args.running.threads() };
    let bar = bar(table.name(), 0, args.running.quiet);
    let report = |progress: Progress| {
        bar.set_length(progress.expected);
        bar.set_position(progress.done);
        if let Some(noise) = progress.noise {
            bar.set_message(format!("{}, noise {noise:.2} of 255", plain(table.name())));
        }
    };
    let film = render(&stage, &quality, &report)?;
    bar.finish_and_clear();
    if let Some(said) = film.noise.and_then(|reached| said_of_noise(reached, args.target_noise)) {
        note(args.running.quiet, said);
    }
    if !film.shows_body {
        note(args.running.quiet, "the body is not in the picture: no ray from the camera meets it; move the camera");
    }
    let bytes = match format {
        RenderFormat::Png => {
            let (png, out_of_gamut) = film.png(args.exposure, args.tonemap);
            if let Some(said) = out_of_gamut.note() {
                note(args.running.quiet, format_args!("{}: {said}", args.output.display()));
            }
            png
        }
        RenderFormat::Exr => film.exr(&format!("{} on {} in {} light", table.name(), args.mesh, args.env))?,
    };
    output::write_file(&args.output, &bytes)
}

/// How the options say that pixels are sampled.
fn sampling(args: &RenderArgs) -> Result<Sampling> {
    let [min, max] = TARGETS;
    match (args.samples, args.target_noise, args.preview) {
        (Some(_), Some(_), _) => Err(Error::usage(
            "--target-noise: takes as many samples as it needs; leave either --target-noise or --samples out",
        )),
        (Some(_), None, true) => Err(Error::usage("--preview: has samples of its own; leave --samples out")),
        (None, Some(_), true) => Err(Error::usage("--preview: has no noise; leave --target-noise out")),
        (None, None, true) if args.reflections.is_some_and(|reflections| reflections > 1) => {
            Err(Error::usage("--preview: shows one reflection; leave either --preview or --reflections out"))
        }
        (None, None, true) => Ok(Sampling::Preview),
        (Some(samples), None, false) => Ok(Sampling::Fixed(samples)),
        (None, Some(target), false) if !(min..=max).contains(&target) => Err(Error::usage(format_args!(
            "--target-noise {target}: must be from {min} to {max} steps of 1/255; noise of 1 is not seen"
        ))),
        (None, target, false) => Ok(Sampling::ToNoise(target.unwrap_or(DEFAULT_TARGET))),
    }
}

/// What is said of the noise that was reached: always if a target was asked for, else only if the default was missed.
fn said_of_noise(reached: NoiseReached, asked: Option<f64>) -> Option<String> {
    let NoiseReached { rms, mean_rays, most_rays } = reached;
    let target = asked.unwrap_or(DEFAULT_TARGET);
    let missed = rms > target;
    let remedy =
        if missed { format!(", more than {target}: {most_rays} samples a pixel are the limit") } else { String::new() };
    (missed || asked.is_some()).then(|| {
        format!("noise {rms:.2} of 255 (root mean square over the body), by {mean_rays:.0} samples a pixel{remedy}")
    })
}

/// The format of a rendered picture.
#[derive(Clone, Copy)]
enum RenderFormat {
    Exr,
    Png,
}

impl RenderFormat {
    fn of(path: &Path) -> Result<Self> {
        match path.extension().unwrap_or_default().to_ascii_lowercase().to_str() {
            Some("exr") => Ok(Self::Exr),
            Some("png") => Ok(Self::Png),
            _ => Err(Error::usage(format_args!(
                "{}: a rendered picture is written as .exr or .png; choose one of these extensions",
                path.display()
            ))),
        }
    }
}

/// The file that an option names, unless it names something built in.
fn file_of(word: &str) -> Option<PathBuf> {
    let built_in = ["white", "studio", "lamp", "teapot", "sphere", "plane", "disc"].contains(&word);
    (!built_in && !word.starts_with("lamp:")).then(|| PathBuf::from(word))
}

/// The lamp that `--env` describes, if it describes one.
fn lamp(word: &str) -> Result<Option<Lamp>> {
    if word == "lamp" {
        return Ok(Some(Lamp::default()));
    }
    let Some(numbers) = word.strip_prefix("lamp:") else { return Ok(None) };
    let numbers: std::result::Result<Vec<f64>, _> = numbers.split(',').map(|number| number.trim().parse()).collect();
    match numbers.as_deref() {
        Ok(&[elevation, azimuth, diameter]) => Lamp::new(elevation, azimuth, diameter).map(Some),
        _ => Err(Error::usage(format_args!(
            "--env {word}: expected lamp:ELEVATION,AZIMUTH,DIAMETER in degrees, such as lamp:55,112,5"
        ))),
    }
}

/// The light that `--env` names.
fn light(word: &str, quiet: bool) -> Result<EnvironmentLight> {
    match word {
        "white" => Ok(EnvironmentLight::White),
        "studio" => Ok(EnvironmentLight::Studio(Box::default())),
        file => {
            let (image, mended) =
                decode(file, &read(file, "an environment is white, studio, lamp, or a .exr or .hdr file")?)?;
            mended.notes().iter().for_each(|said| note(quiet, format_args!("{file}: {said}")));
            Ok(EnvironmentLight::Image(image))
        }
    }
}

/// The shape that `--mesh` names.
fn shape(word: &str, axes: Axes, level: u32, quiet: bool) -> Result<BodyShape> {
    match word {
        "teapot" => Ok(BodyShape::Mesh(TriangleMesh::teapot(level))),
        "sphere" => Ok(BodyShape::Sphere),
        "disc" => Ok(BodyShape::Disc),
        "plane" => Ok(BodyShape::Mesh(TriangleMesh::plane())),
        file => {
            let text = obj::read_file(Path::new(file), "; a mesh is teapot, sphere, plane, disc, or an .obj file")?;
            let (mesh, repairs) = TriangleMesh::from_obj(file, &text, axes)?;
            repairs.notes().iter().for_each(|said| note(quiet, format_args!("{file}: {said}")));
            Ok(BodyShape::Mesh(mesh))
        }
    }
}

/// Reads a file of limited size.
fn read(file: &str, remedy: &str) -> Result<Vec<u8>> {
    let failed = |error: std::io::Error| Error::failed(format_args!("cannot read {file}: {error}; {remedy}"));
    let size = fs::metadata(file).map_err(failed)?.len();
    if size > MAX_BYTES {
        return Err(Error::failed(format_args!("{file}: longer than {} MiB, the limit", MAX_BYTES >> 20)));
    }
    fs::read(file).map_err(failed)
}
