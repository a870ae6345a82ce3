//! All figures of the paper, with a page that explains them.

use std::fs;
use std::path::{Path, PathBuf};

use goniochrome::colour::{Illuminant, RgbSpace};
use goniochrome::optics::interface::Model;

use crate::paper::comparison::Comparison;
use crate::paper::html::{Section, page};
use crate::paper::teapots;
use crate::solve::colours::Colour;
use crate::solve::precision::Precision;
use crate::solve::spectra::{Method, SpectraRequest};
use crate::support::error::{Error, Result};
use crate::support::output;
use crate::table::mirror::MirrorTable;

use crate::paper::wavelength_count::{self, Point, Setting, error_curve};
use crate::plot::{Disc, Picture, disc_grid};
use crate::render::environment::EnvironmentLight;
use crate::scene::{Scene, load};
use crate::solve::planar_scene::PlanarScene;
use crate::support::progress::bar;

/// Number of angles of a disc, at every degree from 0; discs interpolate between them.
const DISC_ANGLES: usize = 90;
/// Sample counts of the columns of figure 6, before the converged one.
const FIGURE_6_COUNTS: [u16; 5] = [5, 10, 20, 32, 40];
/// Sample counts of the error curve. All counts are shown, so that an error that is small by luck stands beside those
/// of its neighbours.
const FIGURE_6_CURVE: std::ops::RangeInclusive<u16> = 4..=100;
/// Largest error at which a count of samples is called enough.
const FIGURE_6_MAX_ERROR: f64 = 0.02;
/// Wavelengths of the paper's figure 7: Hg blue, Hg green and a deep red.
const FIGURE_7_NM: [f64; 3] = [436.0, 546.0, 700.0];

/// Computes the figures and writes them with `index.html` into a folder, which is made if it is missing; returns the
/// path of the page.
///
/// # Errors
/// A folder or a file that cannot be written.
pub fn write(folder: &Path, threads: usize, quiet: bool) -> Result<PathBuf> {
    let failed = |error| Error::failed(format_args!("{}: {error}; choose another -o", folder.display()));
    fs::create_dir_all(folder).map_err(failed)?;
    let request = SpectraRequest { model: Model::Physical, method: Method::Stack, precision: Precision::F64, threads };

    let progress = bar("figures", 6, quiet);
    let sections = [
        figure_3(folder, &request).inspect(|_| progress.inc(1))?,
        figure_4(folder, &request).inspect(|_| progress.inc(1))?,
        figure_5(folder, &request).inspect(|_| progress.inc(1))?,
        figure_6(folder, &request).inspect(|_| progress.inc(1))?,
        figure_7(folder, &request).inspect(|_| progress.inc(1))?,
        gallery(folder, &request).inspect(|_| progress.inc(1))?,
    ];
    progress.finish_and_clear();
    let intro = "The figures of Shimada &amp; Kawaguchi, “BRDF Estimation System for Structural Colors”, computed by \
                 <code>goniochrome figures</code>, and what exact physics says of each. A disc shows the colour of a \
                 mirror-like surface in every direction: its radius is the angle from the normal.";
    let index = folder.join("index.html");
    output::write_text(&index, &page("Structural colours: the paper’s figures", intro, &sections))?;
    Ok(index)
}

/// A way to compute the colours of a disc: caption, model, light, colour space.
type Rendering = (&'static str, Model, Illuminant, RgbSpace);

const RENDERINGS: [Rendering; 3] = [
    ("paper’s model, paper’s colours", Model::Paper, Illuminant::E, RgbSpace::Paper),
    ("exact physics, paper’s colours", Model::Physical, Illuminant::E, RgbSpace::Paper),
    ("exact physics, D65 and sRGB", Model::Physical, Illuminant::D65, RgbSpace::Srgb),
];

fn disc_angles() -> Vec<f64> {
    (0..DISC_ANGLES).map(|i| i as f64).collect()
}

/// Colours at every degree, by the integral over the wavelength.
fn at_every_degree(
    scene: &Scene,
    illuminant: Illuminant,
    space: RgbSpace,
    request: &SpectraRequest,
) -> Result<Vec<Colour>> {
    let setting = Setting { theta_deg: &disc_angles(), illuminant, space, request: *request };
    wavelength_count::converged(&PlanarScene::new(scene)?, &setting)
}

/// Colours at every degree, for each rendering.
fn computed(scene: &Scene, request: &SpectraRequest) -> Result<Vec<Vec<Colour>>> {
    let colours = |&(_, model, illuminant, space): &Rendering| {
        at_every_degree(scene, illuminant, space, &SpectraRequest { model, ..*request })
    };
    RENDERINGS.iter().map(colours).collect()
}

/// A picture of one row of discs, one for each rendering.
fn renderings(computed: &[Vec<Colour>], title: &str) -> Picture {
    let tables: Vec<MirrorTable> =
        computed.iter().zip(&RENDERINGS).map(|(colours, rendering)| teapots::table(colours, rendering.3)).collect();
    let looks: Vec<_> = tables.iter().map(|table| move |theta_deg: f64, _: f64| table.rgb_at(theta_deg)).collect();
    let discs: Vec<Disc<'_>> = looks
        .iter()
        .zip(&RENDERINGS)
        .map(|(rgb, &(label, ..))| Disc { label, rgb, theta_max_deg: 90.0, azimuthal: false })
        .collect();
    disc_grid(title, &[String::new()], &vec![String::new(); discs.len()], &discs)
}

/// Draws the teapot of one rendering in white light; returns the names of its files.
fn teapot(
    folder: &Path,
    file: &str,
    computed: &[Vec<Colour>],
    rendering: usize,
    threads: usize,
) -> Result<Vec<String>> {
    let table = teapots::table(&computed[rendering], RENDERINGS[rendering].3);
    teapots::draw(folder, table, vec![(file, EnvironmentLight::White)], threads)
}

fn figure_5(folder: &Path, request: &SpectraRequest) -> Result<Section> {
    let computed = computed(&load("paper-fig4")?, request)?;
    teapots::figure_5(folder, teapots::table(&computed[2], RENDERINGS[2].3), request.threads)
}

fn figure_3(folder: &Path, request: &SpectraRequest) -> Result<Section> {
    let scene = load("paper-fig3")?;
    let computed = computed(&scene, request)?;
    renderings(&computed, "Figure 3: film n = 2.4, 300 nm, on a mirror").save(&folder.join("figure-3.png"))?;
    let mut images = vec!["figure-3.png".to_owned()];
    images.extend(teapot(folder, "figure-3-teapot.png", &computed, 0, request.threads)?);
    Ok(Section {
        heading: "Figure 3: one film on a mirror".into(),
        images,
        caption_html: "<p>The paper sees red to violet. With its own rules, which weigh a ray by Fresnel’s power ratios and \
                       take the modulus of the sum as flux, the tool does too. <strong>Exact physics shows no colour at \
                       all:</strong> a lossless film on a perfect mirror reflects all light of every wavelength at every \
                       angle, |r| = 1. What is left in the middle disc is the tint of the paper’s colour matrix, whose \
                       white is pink under equal energy: R, G, B = 1.222, 0.944, 0.910. The teapot, in white light, wears the \
                       left disc.</p>"
            .into(),
    })
}

fn figure_4(folder: &Path, request: &SpectraRequest) -> Result<Section> {
    let scene = load("paper-fig4")?;
    let title = "Figure 4: three films n = 2.4, 180 nm apart";
    let computed = computed(&scene, request)?;
    renderings(&computed, title).save(&folder.join("figure-4.png"))?;
    let mut images = vec!["figure-4.png".to_owned()];
    images.extend(teapot(folder, "figure-4-teapot.png", &computed, 1, request.threads)?);
    Ok(Section {
        heading: "Figure 4: three films with air between".into(),
        images,
        caption_html: "<p>The paper describes orange seen from above, then green, then blue towards grazing angles. That is \
                       what exact physics gives: 1.39, 0.72, −0.01 at 0°, 0.48, 0.60, 0.47 at 60°, bluish at 80° (linear \
                       RGB, the paper’s matrix). The paper’s own rules, taken literally, do not give orange. The teapot, in white \
                       light, wears the middle disc.</p>"
            .into(),
    })
}

fn figure_6(folder: &Path, request: &SpectraRequest) -> Result<Section> {
    let scenes = [load("paper-fig6-300")?, load("paper-fig6-3000")?];
    let labels = ["film 300 nm", "film 3000 nm"];
    let space = RgbSpace::Srgb;
    let theta = disc_angles();
    let coarse: Vec<f64> = (0..=17).map(|i| 5.0 * f64::from(i)).collect();
    let disc_setting = Setting { theta_deg: &theta, illuminant: Illuminant::E, space, request: *request };
    let curve_setting = Setting { theta_deg: &coarse, ..disc_setting };

    let counts: Vec<u16> = FIGURE_6_CURVE.collect();
    let mut grid: Vec<MirrorTable> = Vec::new();
    let mut curves = Vec::new();
    for (scene, label) in scenes.iter().zip(labels) {
        let planar = PlanarScene::new(scene)?;
        for count in FIGURE_6_COUNTS {
            grid.push(teapots::table(&wavelength_count::sampled(&planar, count, &disc_setting)?, space));
        }
        grid.push(teapots::table(&wavelength_count::converged(&planar, &disc_setting)?, space));
        curves.push((label.to_owned(), error_curve(&planar, &counts, &curve_setting, &|_| ())?));
    }
    let looks: Vec<_> = grid.iter().map(|table| move |theta_deg: f64, _: f64| table.rgb_at(theta_deg)).collect();
    let discs: Vec<Disc<'_>> =
        looks.iter().map(|rgb| Disc { label: "", rgb, theta_max_deg: 90.0, azimuthal: false }).collect();
    let columns: Vec<String> =
        FIGURE_6_COUNTS.iter().map(|n| format!("N = {n}")).chain(["the integral".into()]).collect();
    let title = "Figure 6: colour from N wavelengths";
    disc_grid(title, &labels.map(str::to_owned), &columns, &discs).save(&folder.join("figure-6-discs.png"))?;
    wavelength_count::picture("Figure 6: error against the number of wavelengths", &curves)
        .save(&folder.join("figure-6-error.png"))?;
    Ok(Section {
        heading: "Figure 6: how many wavelengths a colour needs".into(),
        images: vec!["figure-6-discs.png".into(), "figure-6-error.png".into()],
        caption_html: figure_6_caption(&curves[0].1, &curves[1].1),
    })
}

/// The caption of figure 6: the errors of the thin and of the thick film beside the paper's numbers.
fn figure_6_caption(thin: &[Point], thick: &[Point]) -> String {
    let error = |curve: &[Point], samples: u16| {
        curve.iter().find(|point| point.samples == samples).map_or(f64::NAN, |point| point.error)
    };
    let enough = |curve: &[Point]| {
        let last_too_few = curve.iter().rposition(|point| point.error > FIGURE_6_MAX_ERROR);
        curve.get(last_too_few.map_or(0, |place| place + 1)).map_or(u16::MAX, |point| point.samples)
    };
    format!(
        "<p>A film of n = 2.4, N midpoint samples from 380 to 780 nm, equal energy, linear sRGB, angles from 0 to 85°; the \
         error is the largest difference of a component from the integral over the wavelength. The film stands on n = 1.5, \
         because on the paper’s perfect mirror it reflects all light and there is no colour to err in.</p>\
         <p>The paper finds 10 samples enough for 300 nm and 40 for 3000 nm. For 300 nm the error at N = 10 is indeed {:.4}, \
         but {:.3} at 9, {:.3} at 11 and {:.3} at 12: it depends on where the samples fall, and <strong>10 is luck</strong>. \
         Errors stay below {FIGURE_6_MAX_ERROR} from N = {} on. For 3000 nm they do so from N = {} on, so the paper’s 40 holds ({:.3}). \
         <code>--wavelengths auto</code> adds samples until the colour stands still.</p>",
        error(thin, 10),
        error(thin, 9),
        error(thin, 11),
        error(thin, 12),
        enough(thin),
        enough(thick),
        error(thick, 40),
    )
}

fn figure_7(folder: &Path, request: &SpectraRequest) -> Result<Section> {
    let theta = disc_angles();
    let request = SpectraRequest { method: Method::Hits, ..*request };
    let mut images = Vec::new();
    let mut differences = Vec::new();
    for (name, title, file) in [
        ("paper-fig6-300", "Figure 7: film n = 2.4, 300 nm, on n = 1.5", "figure-7-film.png"),
        ("paper-fig4", "Figure 7: the three films of figure 4", "figure-7-three-films.png"),
    ] {
        let scene = load(name)?;
        let planar = PlanarScene::new(&scene)?;
        let comparison = Comparison::new(&planar, &theta, &FIGURE_7_NM, &request)?;
        comparison.picture(title).save(&folder.join(file))?;
        images.push(file.to_owned());
        differences.push(comparison.largest_difference());
    }
    Ok(Section {
        heading: "Figure 7: ray tracing against the closed form".into(),
        images,
        caption_html: format!(
            "<p>Closed form: the recursion of the planar stack. Ray tracing: rays followed hit by hit, those in equal states \
             added as amplitudes. The coloured discs are the paper’s: 436, 546 and 700 nm as blue, green and red, one for each \
             method. The grey ones show each wavelength alone, half by one method and half by the other. The single film \
             stands on n = 1.5, because on the paper’s perfect mirror it reflects everything and every disc would be white. \
             The largest differences of s or p reflectance are {:.0e} and {:.0e}: \
             merged rays converge to the exact result. Without merging, three films do not converge at all.</p>",
            differences[0], differences[1]
        ),
    })
}

/// Presets of the gallery: those that nature or industry makes, and the paper's multilayer.
const GALLERY: [&str; 8] = [
    "jewel-beetle",
    "morpho-stack",
    "opaline-guanine",
    "quarter-wave-mirror",
    "soap-bubble",
    "oil-on-water",
    "anodised-titanium",
    "paper-fig4",
];
/// Angle up to which the discs of the gallery are brightened to the same maximum: beyond, every surface is white.
const GALLERY_BRIGHTNESS_DEG: usize = 70;

fn gallery(folder: &Path, request: &SpectraRequest) -> Result<Section> {
    let computed = GALLERY
        .iter()
        .map(|name| at_every_degree(&load(name)?, Illuminant::D65, RgbSpace::Srgb, request))
        .collect::<Result<Vec<_>>>()?;
    let tables: Vec<MirrorTable> = computed.iter().map(|colours| teapots::table(colours, RgbSpace::Srgb)).collect();
    let looks: Vec<_> = computed
        .iter()
        .zip(&tables)
        .map(|(colours, table)| {
            let brightest = colours[..GALLERY_BRIGHTNESS_DEG].iter().flat_map(|c| c.rgb).fold(0.0, f64::max) as f32;
            move |theta_deg: f64, _: f64| table.rgb_at(theta_deg).map(|c| c / brightest)
        })
        .collect();
    let discs: Vec<Disc<'_>> = looks
        .iter()
        .zip(GALLERY)
        .map(|(rgb, label)| Disc { label, rgb, theta_max_deg: 90.0, azimuthal: false })
        .collect();
    let (no_rows, no_columns) = (vec![String::new(); 2], vec![String::new(); 4]);
    disc_grid("What a surface of each kind looks like from every angle", &no_rows, &no_columns, &discs)
        .save(&folder.join("presets.png"))?;
    Ok(Section {
        heading: "The built-in scenes".into(),
        images: vec!["presets.png".into()],
        caption_html:
            "<p>Exact physics, daylight (D65), sRGB. Each disc is brightened to the same maximum up to 70°: a soap \
                       film reflects a tenth of the light, a beetle’s shell more than a third of its green. \
                       <code>goniochrome presets</code> lists them.</p>"
                .into(),
    })
}
