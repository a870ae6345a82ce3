//! Tests of `render` with tables of scattered light: albedo, facet lobes, noise, previews.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::{DVec3, Vec3};
use goniochrome::table::{FacetLobe, ScatterLayout};
use goniochrome_cli::table::file;
use goniochrome_cli::table::scatter::{Energy, ScatterTable};

use crate::discs;
use crate::render::{environment, picture};
use crate::user::User;

/// Tolerance of an albedo in a picture. Ten thousand well spread directions of a smooth lobe have a tenth of it.
const ALBEDO: f64 = 5e-3;
/// Largest difference of radiances that single precision and a picture of an exact direction leave, relatively.
const EXACT: f64 = 1e-3;

/// A table of a broad lobe that reddens and is twisted around the normal, with flat facets that reflect the fraction
/// `flat`. It is not reciprocal, so that swapped directions show.
pub fn twisted(flat: f32) -> ScatterTable {
    let layout = ScatterLayout::new([6, 4], [9, 16], 1).unwrap();
    let rgb: Vec<[f32; 3]> = (0..layout.count())
        .map(|i| {
            let ([theta, phi], place) = (layout.incident(i / layout.places()), i % layout.places());
            if place == layout.node_count() {
                return [flat, 0.5 * flat, 0.25 * flat];
            }
            // With even densities the square is not warped.
            let [u, v] = layout.node(place);
            let slope = (0.5 * PI * u * u).min(1.5).tan();
            let twist = 1.0 + 0.3 * theta.sin() * (phi + 0.4).sin() + 0.5 * u * u * (TAU * v).cos();
            let s = (0.12 * (-2.0 * slope * slope).exp() * twist * theta.cos()) as f32;
            [s, 0.5 * s, s * (0.3 + 0.2 * theta as f32)]
        })
        .collect();
    ScatterTable {
        warp: [vec![1.0; 2], vec![1.0; 2]],
        lobes: vec![FacetLobe::reflection(Vec3::Z)],
        wavelength_nm: vec![550.0],
        values: rgb.iter().map(|rgb| rgb[1]).collect(),
        luminance_error: vec![0.0; layout.count()],
        energy: vec![Energy::default(); layout.incident_count()],
        metadata: Default::default(),
        layout,
        rgb,
    }
}

pub fn save(user: &User, name: &str, table: &ScatterTable) {
    file::write(&user.at(name), &table.clone().into(), 1).unwrap();
}

/// Mean colour of a picture of a plane that one direction sees.
fn mean(user: &User, elevation: f64, options: &str) -> [f64; 3] {
    user.ok(&format!(
        "render t.exr -o a.exr --mesh plane --size 12 --fov 0.1 --distance 100 --azimuth 0 --elevation {elevation} {options}"
    ));
    let pixels = picture(user, "a.exr").rgba;
    [0, 1, 2].map(|c| pixels.iter().map(|p| f64::from(p[c])).sum::<f64>() / pixels.len() as f64)
}

/// Largest relative difference of two colours.
fn apart(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|c| (a[c] / b[c] - 1.0).abs()).fold(0.0, f64::max)
}

#[test]
fn a_plane_reflects_what_its_table_integrates_to_for_its_viewer() {
    let user = User::new();
    let table = twisted(0.1);
    save(&user, "t.exr", &table);
    environment(&user, "one.exr", [16, 8], |_, _| [1.0; 3]);
    // Brighter on one side, so that the light's own sampling counts.
    environment(&user, "side.exr", [16, 8], |x, y| [if (x, y) == (5, 2) { 30.0 } else { 0.5 }; 3]);
    let lookup = table.rgb_lookup().unwrap();
    let core = lookup.table().unwrap();
    for elevation in [75.0, 30.0] {
        let (sin, cos) = f64::to_radians(elevation).sin_cos();
        let viewer = Vec3::new(cos as f32, 0.0, sin as f32);
        let (rows, columns) = (400, 800);
        let mut lobe = [0.0; 3];
        core.reflected(viewer, 0, &mut lobe).unwrap();
        let mut albedo = lobe.map(f64::from);
        for i in 0..rows * columns {
            let theta = (f64::from(i / columns) + 0.5) / f64::from(rows) * FRAC_PI_2;
            let phi = (f64::from(i % columns) + 0.5) / f64::from(columns) * TAU;
            let wi = DVec3::new(theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos());
            let f = core.rgb(viewer, wi.as_vec3());
            let share = theta.cos() * theta.sin() * (FRAC_PI_2 / f64::from(rows)) * (TAU / f64::from(columns));
            (0..3).for_each(|c| albedo[c] += share * f64::from(f[c]));
        }
        for env in ["white", "one.exr"] {
            for more in ["--samples 16", "--target-noise 0.5", "--samples 16 --reflections 3"] {
                let found = mean(&user, elevation, &format!("--env {env} {more}"));
                println!("{elevation} {env} {more}: {:.1e}", apart(found, albedo));
                assert!(apart(found, albedo) <= ALBEDO, "{elevation} {env} {more}: {found:?} {albedo:?}");
            }
        }
        // Few and many samples have the same mean, unless the combined strategies leave light out or count it twice.
        let [few, many] = [16, 256].map(|n| mean(&user, elevation, &format!("--env side.exr --samples {n}")));
        assert!(apart(few, many) <= ALBEDO, "{few:?} {many:?}");
    }
}

#[test]
fn facet_lobes_are_mirrors_and_have_the_width_that_is_asked_for() {
    let user = User::new();
    let mut table = twisted(0.5);
    let (places, last) = (table.layout.places(), table.layout.node_count());
    // The lobe alone.
    for i in (0..table.layout.count()).filter(|i| i % places != last) {
        (table.rgb[i], table.values[i]) = ([0.0; 3], 0.0);
    }
    save(&user, "t.exr", &table);
    // The same mirror as a table of orders, whose width is checked elsewhere.
    let mirror = discs::table(vec![400.0, 550.0, 700.0], 1, |m, _| if m == 0 { 1.0 } else { 0.0 });
    file::write(&user.at("mirror.exr"), &mirror.into(), 1).unwrap();
    for (apart_deg, more) in [(0.0, ""), (0.0, "--spread 3"), (4.0, "--spread 3"), (0.0, "--preview")] {
        let elevation = 60.0 - apart_deg;
        let options = format!("--env lamp:60,180,2 {more}");
        let found = mean(&user, elevation, &options);
        user.ok(&format!(
            "render mirror.exr -o m.exr --mesh plane --size 1 --fov 0.1 --distance 100 --azimuth 0 --elevation \
             {elevation} {options}"
        ));
        let whole = f64::from(picture(&user, "m.exr").rgba[0][0]);
        let expected = [0.5, 0.25, 0.125].map(|share| share * whole);
        println!("{apart_deg}° {more}: {:.1e}", apart(found, expected));
        assert!(apart(found, expected) <= EXACT, "{apart_deg}° {more}: {found:?} {expected:?}");
    }
    table.lobes.clear();
    table.layout = ScatterLayout::new(table.layout.incident_sides(), table.layout.square_sides(), 0).unwrap();
    let count = table.layout.count();
    (table.rgb, table.values, table.luminance_error) = (vec![[0.1; 3]; count], vec![0.1; count], vec![0.0; count]);
    save(&user, "t.exr", &table);
    user.refused("render t.exr -o a.png --spread 2", 2, &["--spread", "no diffraction orders or facet lobes"]);
}

/// Components of linear RGB in steps of 8-bit sRGB.
fn encoded([r, g, b, _]: [f32; 4]) -> [f64; 3] {
    [r, g, b].map(|c| {
        let c = f64::from(c).clamp(0.0, 1.0);
        255.0 * if c <= 0.003_130_8 { 12.92 * c } else { 1.055 * c.powf(1.0 / 2.4) - 0.055 }
    })
}

/// Differences of the components of two pictures where the second shows the body, in steps of 8-bit sRGB.
fn differences(user: &User, a: &str, b: &str) -> Vec<f64> {
    let pixels = picture(user, a).rgba.into_iter().zip(picture(user, b).rgba).filter(|(_, b)| b[3] > 0.0);
    pixels
        .flat_map(|(a, b)| {
            let (a, b) = (encoded(a), encoded(b));
            [0, 1, 2].map(|c| a[c] - b[c])
        })
        .collect()
}

#[test]
fn noise_is_what_is_said_and_no_more_than_was_asked_for() {
    // Some 500 pixels of the silhouette have most of the noise, and errors that are not normal: both root mean squares
    // are known to 4 %. The first rays of all, two in each half, are too few for the slope of the encoding.
    const ESTIMATE: f64 = 0.1;
    let user = User::new();
    save(&user, "t.exr", &twisted(0.1));
    let view = "--mesh sphere --size 100 --background transparent";
    user.ok(&format!("render t.exr -o reference.exr {view} --samples 1024"));
    for target in [2.0, 1.0] {
        let ran = user.ok(&format!("render t.exr -o a.exr {view} --target-noise {target}"));
        let said: f64 = ran.stderr.split_whitespace().nth(1).unwrap().parse().unwrap();
        let apart = differences(&user, "a.exr", "reference.exr");
        let rms = (apart.iter().map(|d| d * d).sum::<f64>() / apart.len() as f64).sqrt();
        println!("{target}: said {said}, found {rms:.2}; {}", ran.stderr);
        assert!(apart.len() > 10_000 && said <= target, "{}", ran.stderr);
        assert!((rms / said - 1.0).abs() <= ESTIMATE, "{target}: said {said}, found {rms}");
    }
    let ran = user.ok(&format!("render t.exr -o a.exr {view}"));
    assert_eq!(ran.stderr, "", "the default says nothing unless it is missed");
}

#[test]
fn a_preview_is_smooth_and_close_to_the_picture() {
    /// Mean difference, in steps of 8-bit sRGB.
    const PREVIEW: f64 = 3.0;
    /// Relative bend of a plane's picture, all of whose pixels have nearly one viewer: rounding.
    const BEND: f32 = 1e-3;
    let user = User::new();
    save(&user, "t.exr", &twisted(0.1));
    for light in ["studio", "lamp:50,20,20", "white"] {
        let view = format!("--mesh sphere --size 40 --background transparent --env {light}");
        user.ok(&format!("render t.exr -o reference.exr {view} --samples 128"));
        user.ok(&format!("render t.exr -o a.exr {view} --preview"));
        let apart = differences(&user, "a.exr", "reference.exr");
        let mean = apart.iter().map(|d| d.abs()).sum::<f64>() / apart.len() as f64;
        println!("{light}: {mean:.2}");
        assert!(mean <= PREVIEW, "{light}: {mean}");
        user.ok(&format!(
            "render t.exr -o a.exr --env {light} --preview --mesh plane --size 16 --fov 0.1 --distance 100 --elevation 40"
        ));
        let pixels = picture(&user, "a.exr").rgba;
        let rows = pixels.chunks(16).flat_map(|row| row.windows(3));
        let bend = rows.map(|three| (three[0][1] - 2.0 * three[1][1] + three[2][1]).abs() / three[1][1]);
        let worst = bend.fold(0.0, f32::max);
        assert!(worst <= BEND, "{light}: {worst}");
    }
}

#[test]
fn pictures_do_not_depend_on_threads() {
    let user = User::new();
    save(&user, "t.exr", &twisted(0.1));
    for (name, more) in [
        ("a.exr", "--samples 3 --reflections 2"),
        ("a.png", "--tonemap filmic --target-noise 6 --reflections 2"),
        ("b.png", "--preview"),
    ] {
        let drawn = |threads: u32| {
            user.ok(&format!("render t.exr -o {name} --size 40x30 {more} --threads {threads}"));
            user.read(name)
        };
        assert_eq!(drawn(1), drawn(3), "{name}");
    }
    assert!(user.read("a.png").starts_with(b"\x89PNG"));
}
