//! Tests of `render`: pictures against the colours that follow from light and table, repairs and refusals.

use std::f64::consts::{PI, TAU};
use std::io::Cursor;

use exr::prelude::{Image, ReadChannels, ReadLayers, SpecificChannels, WritableImage};
use glam::DVec3;
use goniochrome_cli::table::mirror::MirrorTable;
use goniochrome_cli::table::{Table, file};

use crate::user::User;

/// Largest difference of a pixel. Single precision and a table of 90 angles leave 1e-6.
const PIXEL: f32 = 1e-3;

pub struct Picture {
    pub width: usize,
    pub rgba: Vec<[f32; 4]>,
}

pub fn picture(user: &User, name: &str) -> Picture {
    let image = exr::prelude::read()
        .no_deep_data()
        .largest_resolution_level()
        .rgba_channels(
            |size, _| (size.0, vec![[0.0f32; 4]; size.0 * size.1]),
            |image: &mut (usize, Vec<[f32; 4]>), at, (r, g, b, a): (f32, f32, f32, f32)| {
                image.1[at.1 * image.0 + at.0] = [r, g, b, a];
            },
        )
        .first_valid_layer()
        .all_attributes()
        .from_file(user.at(name))
        .expect("a rendered EXR");
    let (width, rgba) = image.layer_data.channel_data.pixels;
    Picture { width, rgba }
}

pub fn environment(user: &User, name: &str, [width, height]: [usize; 2], of: impl Fn(usize, usize) -> [f32; 3] + Sync) {
    let channels = SpecificChannels::rgb(|at: exr::math::Vec2<usize>| {
        let [r, g, b] = of(at.0, at.1);
        (r, g, b)
    });
    let mut bytes = Cursor::new(Vec::new());
    Image::from_channels((width, height), channels).write().non_parallel().to_buffered(&mut bytes).unwrap();
    user.write(name, bytes.into_inner());
}

/// Writes the table of a perfect mirror: ρ = 1 at every angle and wavelength.
pub fn white(user: &User) {
    let wavelength_nm: Vec<f64> = (0..=40).map(|i| 380.0 + 10.0 * f64::from(i)).collect();
    let table = MirrorTable {
        theta_deg: vec![0.0, 45.0, 89.0],
        reflectance_s: vec![1.0; 3 * wavelength_nm.len()],
        reflectance_p: vec![1.0; 3 * wavelength_nm.len()],
        rgb: vec![[1.0; 3]; 3],
        wavelength_nm,
        ..MirrorTable::default()
    };
    file::write(&user.at("white.exr"), &table.into(), 1).unwrap();
}

/// The eye, and the directions from it to the middles of the pixels, for the default field of view of 30 degrees.
pub fn rays(azimuth_deg: f64, elevation_deg: f64, size: usize) -> (DVec3, Vec<DVec3>) {
    let (azimuth, elevation) = (azimuth_deg.to_radians(), elevation_deg.to_radians());
    let back = DVec3::new(elevation.cos() * azimuth.cos(), elevation.cos() * azimuth.sin(), elevation.sin());
    let right = DVec3::Z.cross(back).normalize();
    let up = back.cross(right);
    let half = 15f64.to_radians();
    let at = |i: usize| (2.0 * (i as f64 + 0.5) / size as f64 - 1.0) * half.tan();
    let direction = |i: usize| (at(i % size) * right - at(i / size) * up - back).normalize();
    (1.02 / half.sin() * back, (0..size * size).map(direction).collect())
}

/// The normal where a ray hits the unit sphere.
fn on_sphere(eye: DVec3, direction: DVec3) -> Option<DVec3> {
    let b = eye.dot(direction);
    let root = (b * b - eye.length_squared() + 1.0).sqrt();
    (!root.is_nan()).then(|| eye + (-b - root) * direction)
}

#[test]
fn a_perfect_mirror_in_white_light_is_white() {
    let user = User::new();
    white(&user);
    for (mesh, more) in [
        ("teapot", "--samples 4"),
        ("teapot", "--samples 4 --reflections 4 --spectral"),
        ("sphere", "--samples 4"),
        ("plane", "--samples 1"),
    ] {
        user.ok(&format!(
            "render white.exr -o a.exr --env white --mesh {mesh} --size 160 --background transparent {more}"
        ));
        let covered: Vec<[f32; 4]> = picture(&user, "a.exr").rgba.into_iter().filter(|p| p[3] > 0.0).collect();
        assert!(covered.len() > 160 * 160 / 10, "{mesh}: {}", covered.len());
        for [r, g, b, a] in covered {
            assert!([r, g, b].iter().all(|c| (c / a - 1.0).abs() <= PIXEL), "{mesh} {more}: {r} {g} {b} {a}");
        }
    }
}

#[test]
fn a_mirror_sphere_shows_the_environment_that_its_directions_say() {
    let user = User::new();
    white(&user);
    let size = [64, 32];
    let texel = |x: usize, y: usize| {
        [
            0.5 + 0.5 * (TAU * f64::from(x as u32) / 64.0).sin() as f32,
            y as f32 / 16.0,
            if (x, y) == (40, 9) { 20.0 } else { 0.1 },
        ]
    };
    environment(&user, "e.exr", size, texel);
    let view = "--mesh sphere --size 200 --samples 1 --background transparent --azimuth 25 --elevation 10";
    user.ok(&format!("render white.exr -o a.exr --env e.exr {view}"));
    let (eye, rays) = rays(25.0, 10.0, 200);
    let found = picture(&user, "a.exr");
    assert_eq!(found.width, 200);
    let (mut sum, mut count) = (0.0, 0);
    for (ray, pixel) in rays.into_iter().zip(found.rgba) {
        let normal = on_sphere(eye, ray);
        assert_eq!(normal.is_some(), pixel[3] > 0.0);
        let Some(normal) = normal else { continue };
        let wi = ray - 2.0 * ray.dot(normal) * normal;
        let (u, v) = (0.5 - wi.y.atan2(wi.x) / TAU, wi.z.clamp(-1.0, 1.0).acos() / PI);
        let (x, y) = (64.0 * u - 0.5, (32.0 * v - 0.5).clamp(0.0, 31.0));
        for (c, &component) in pixel[..3].iter().enumerate() {
            let at = |i: f64, j: f64| f64::from(texel(i.rem_euclid(64.0) as usize, (j as usize).min(31))[c]);
            let (i, j) = (x.floor(), y.floor());
            let row = |j| at(i, j) + (x - i) * (at(i + 1.0, j) - at(i, j));
            sum += (row(j) + (y - j) * (row(j + 1.0) - row(j)) - f64::from(component)).abs();
            count += 1;
        }
    }
    assert!(count > 3 * 20_000);
    println!("mean absolute error {:.1e}", sum / f64::from(count));
    assert!(sum / f64::from(count) <= f64::from(PIXEL));
}

#[test]
fn a_sphere_in_white_light_has_the_tables_colours_also_by_wavelengths() {
    let user = User::new();
    for preset in ["paper-fig4", "soap-bubble"] {
        user.ok(&format!("estimate {preset} -o t.exr --quiet"));
        let Table::Mirror(table) = file::read(&user.at("t.exr")).unwrap() else { panic!("planar") };
        let (eye, rays) = rays(-60.0, 24.0, 200);
        for more in ["", "--spectral"] {
            user.ok(&format!(
                "render t.exr -o a.exr --env white --mesh sphere --size 200 --samples 1 --background transparent --body solid {more}"
            ));
            let mut worst = 0f32;
            for (ray, pixel) in rays.iter().zip(picture(&user, "a.exr").rgba) {
                let Some(normal) = on_sphere(eye, *ray) else { continue };
                let expected = table.rgb_at((-ray.dot(normal)).clamp(0.0, 1.0).acos().to_degrees());
                worst = (0..3).fold(worst, |worst, c| worst.max((expected[c] - pixel[c]).abs()));
            }
            println!("{preset} {more}: {worst:.1e}");
            assert!(worst <= PIXEL, "{preset} {more}: {worst}");
        }
    }
}

#[test]
fn exposures_in_radiance_files_do_not_change_the_light() {
    let user = User::new();
    white(&user);
    let hdr = |header: &str, resolution: &str, exponent: u8| {
        let mut bytes = format!("#?RGBE\n{header}FORMAT=32-bit_rle_rgbe\n\n{resolution}\n").into_bytes();
        (0..8u8).for_each(|i| bytes.extend([128 + i, 64, 3 * i, exponent]));
        bytes
    };
    let drawn = |bytes: Vec<u8>| {
        user.write("e.hdr", bytes);
        user.ok("render white.exr -o a.exr --env e.hdr --mesh sphere --size 24 --samples 2");
        picture(&user, "a.exr").rgba
    };
    let plain = drawn(hdr("", "-Y 2 +X 4", 129));
    // Twice as bright, twice.
    assert_eq!(drawn(hdr("EXPOSURE=2\nEXPOSURE=2\n", "-Y 2 +X 4", 131)), plain);
    assert_eq!(drawn(hdr("EXPOSURE=0.5\nCOLORCORR=4 4 4\n", "-Y 2 +X 4", 130)), plain);
    assert!(drawn(hdr("", "-Y 2 -X 4", 129)) != plain);
}

#[test]
fn a_mesh_with_y_up_stands_as_with_z_up() {
    let user = User::new();
    white(&user);
    user.write(
        "z.obj",
        "v 0 0 0\nv 2 0 0\nv 2 0 1\nv 1 0 1\nv 1 0 3\nv 0 0 3\nvn 0 -1 0\nf 2//1 3//1 4//1 5//1 6//1 1//1\n",
    );
    user.write(
        "y.obj",
        "v 0 0 0\nv 2 0 0\nv 2 1 0\nv 1 1 0\nv 1 3 0\nv 0 3 0\nvn 0 0 1\nf 2//1 3//1 4//1 5//1 6//1 1//1\n",
    );
    let covered = |options: &str| {
        user.ok(&format!(
            "render white.exr -o a.exr {options} --env white --size 64 --samples 4 --background transparent"
        ));
        picture(&user, "a.exr").rgba
    };
    assert_eq!(covered("--mesh z.obj"), covered("--mesh y.obj --axes y-up"));
    assert!(covered("--mesh y.obj") != covered("--mesh z.obj"));
}

const TRIANGLES: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nvn 0 0 1\n";

#[test]
fn what_can_be_mended_is_mended_and_said() {
    let user = User::new();
    white(&user);
    user.write("bare.obj", format!("{TRIANGLES}f 1 2 3\nf 1 2 4\n"));
    let ran = user.ok("render white.exr -o a.exr --mesh bare.obj --size 32 --samples 1");
    assert_eq!(
        ran.stderr,
        "bare.obj: 2 of 2 triangles have corners without normals; they were computed, smooth across edges of up to 45 degrees\n"
    );
    user.write("flat.obj", format!("{TRIANGLES}f 1//1 2//1 3//1\nf 1//1 2//1 2//1\nf 1//1 1//1 1//1\n"));
    let ran = user.ok("render white.exr -o a.exr --mesh flat.obj --size 32 --samples 1");
    assert_eq!(ran.stderr, "flat.obj: 2 triangles have no area; they were left out\n");
    environment(&user, "odd.exr", [4, 2], |x, _| [[1.0, -1.0, f32::NAN, f32::INFINITY][x], 1.0, 1.0]);
    let ran = user.ok("render white.exr -o a.exr --env odd.exr --size 32 --samples 1");
    assert_eq!(
        ran.stderr,
        "odd.exr: components of the environment: 2 negative, now 0; 2 not numbers, now 0; 2 infinite, now 65504\n"
    );
    user.write(
        "wide.hdr",
        [b"#?RGBE\nPRIMARIES=0.7 0.3 0.2 0.7 0.1 0.05 0.3 0.3\n\n-Y 1 +X 2\n".as_slice(), &[99; 8]].concat(),
    );
    let ran = user.ok("render white.exr -o a.exr --env wide.hdr --size 32 --samples 1");
    assert_eq!(ran.stderr, "wide.hdr: its colours are converted from its own primaries to those of Rec. 709 (sRGB)\n");
    let ran = user.ok("render white.exr -o a.exr --size 32 --distance 5 --mesh plane --samples 1 --elevation 0");
    assert!(ran.stderr.contains("the body is not in the picture"), "{}", ran.stderr);
}

#[test]
fn what_cannot_be_rendered_is_refused() {
    let user = User::new();
    white(&user);
    environment(&user, "night.exr", [4, 2], |_, _| [0.0; 3]);
    environment(&user, "square.exr", [4, 4], |_, _| [1.0; 3]);
    environment(&user, "good.exr", [32, 16], |x, _| [x as f32; 3]);
    let good = user.read("good.exr");
    user.write("cut.exr", &good[..good.len() / 2]);
    user.write("text.hdr", "no light");
    user.write("cut.hdr", "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 8 +X 16\n");
    user.write("empty.obj", "v 0 0 0\n");
    user.write("line.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n");
    user.write("nan.obj", "v 0 0 nan\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    user.write("far.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n");
    user.write("back.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvn 0 0 1\nf 1/-9/-9 2/1/1 3/1/1\n");
    user.write("word.obj", "v 0 0 0\nv 1 0 x\n");
    for (options, code, says) in [
        ("-o a.jpg", 2, ".exr or .png"),
        ("-o a.png --size 0", 2, "--size 0x0"),
        ("-o a.png --size 0x9", 2, "--size 0x9"),
        ("-o a.png --size 16384x16384", 2, "more than"),
        ("-o a.png --size big", 2, "expected a number of pixels"),
        ("-o a.png --fov 180", 2, "--fov 180"),
        ("-o a.png --exposure inf", 2, "--exposure inf"),
        ("-o a.png --samples 4 --target-noise 1", 2, "leave either --target-noise or --samples out"),
        ("-o a.png --samples 4 --preview", 2, "--preview: has samples of its own"),
        ("-o a.png --target-noise 1 --preview", 2, "--preview: has no noise"),
        ("-o a.png --reflections 2 --preview", 2, "--preview: shows one reflection"),
        ("-o a.png --target-noise 0.01", 2, "--target-noise 0.01: must be from 0.1 to 30"),
        ("-o a.png --target-noise nan", 2, "--target-noise NaN: must be"),
        ("-o a.png --background pink", 2, "expected environment"),
        ("-o nowhere/a.png", 1, "does not exist"),
        ("-o white.exr", 2, "would overwrite the input"),
        ("-o good.exr --env good.exr", 2, "would overwrite the input"),
        ("-o a.png --env none.exr", 1, "cannot read none.exr"),
        ("-o a.png --env night.exr", 1, "night.exr: every texel of the environment is black"),
        ("-o a.png --env square.exr", 1, "square.exr: 4 × 4 texels are no lat-long image"),
        ("-o a.png --env cut.exr", 1, "cut.exr: not a readable EXR file"),
        ("-o a.png --env text.hdr", 1, "neither OpenEXR nor Radiance HDR"),
        ("-o a.png --env cut.hdr", 1, "not a readable Radiance HDR file"),
        ("-o a.png --env white.exr", 1, "a BRDF table, where an environment is expected"),
        ("-o a.png --axes y-up", 2, "--axes: teapot has z up already"),
        ("-o a.png --mesh none.obj", 1, "cannot read none.obj"),
        ("-o a.png --mesh empty.obj", 1, "empty.obj: the mesh has no faces"),
        ("-o a.png --mesh line.obj", 1, "line.obj: no triangle of the mesh has an area"),
        ("-o a.png --mesh nan.obj", 1, "nan.obj:1: coordinate \"nan\" is not a finite number"),
        ("-o a.png --mesh far.obj", 1, "far.obj:4: vertex 9 does not exist; 3 are defined above"),
        ("-o a.png --mesh back.obj", 1, "back.obj:6: texture coordinate -9 does not exist; 1 are defined above"),
        ("-o a.png --mesh word.obj", 1, "word.obj:2: coordinate \"x\" is not a finite number"),
    ] {
        user.refused(&format!("render white.exr {options}"), code, &[says]);
    }
    user.refused("render good.exr -o a.png", 1, &["good.exr", "not a goniochrome table"]);
    let black = MirrorTable {
        theta_deg: vec![0.0, 80.0],
        wavelength_nm: vec![500.0],
        reflectance_s: vec![0.0; 2],
        reflectance_p: vec![0.0; 2],
        rgb: vec![[0.0; 3]; 2],
        ..MirrorTable::default()
    };
    file::write(&user.at("black.exr"), &black.into(), 1).unwrap();
    user.refused("render black.exr -o a.png", 1, &["black.exr: the table reflects nothing"]);
    user.refused("render black.exr -o a.png --spectral", 1, &["black.exr: 1 wavelengths cannot tell"]);
}
