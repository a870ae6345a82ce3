//! Tests of `render` with tables of diffraction orders: colours against the grating equation, energy, width, refusals.

use std::f64::consts::{PI, TAU};

use glam::DVec3;
use goniochrome::colour::{Illuminant, Quadrature, RgbSpace, xyz_weights};
use goniochrome_cli::colour::difference::{delta_e, lab};
use goniochrome_cli::table::file;
use goniochrome_cli::table::orders::OrderTable;

use crate::discs::{PITCH_NM, compact_disc, strength, table};
use crate::render::{environment, picture, rays, white};
use crate::user::User;

/// Largest error of a lossless surface in even light.
const FURNACE: f32 = 1e-3;
/// Largest ΔE2000 of a rendered colour.
const COLOUR: f64 = 2.0;

fn save(user: &User, name: &str, table: OrderTable) {
    file::write(&user.at(name), &table.into(), 1).unwrap();
}

/// Unit vector of an elevation and an azimuth in degrees.
fn towards(elevation_deg: f64, azimuth_deg: f64) -> DVec3 {
    let (elevation, azimuth) = (elevation_deg.to_radians(), azimuth_deg.to_radians());
    DVec3::new(elevation.cos() * azimuth.cos(), elevation.cos() * azimuth.sin(), elevation.sin())
}

/// Linear sRGB that leaves tracks along y towards `wo` under a lamp, straight from the grating equation: the whole
/// calculation that `render` must agree with.
fn grating_colour(wo: DVec3, lamp: DVec3, diameter_deg: f64) -> [f64; 3] {
    let nm: Vec<f64> = (0..=4000).map(|i| 380.0 + 0.1 * f64::from(i)).collect();
    let mut weights = vec![[0.0; 3]; nm.len()];
    xyz_weights(&nm, Illuminant::D65, Quadrature::Sampled, &mut weights).unwrap();
    let mut xyz = DVec3::ZERO;
    for ((m, nm), weight) in (-4..=4).flat_map(|m| nm.iter().zip(&weights).map(move |(nm, weight)| ((m, *nm), weight)))
    {
        let (x, y) = (f64::from(m) * nm / PITCH_NM - wo.x, -wo.y);
        let z = (1.0 - x * x - y * y).sqrt();
        let edge =
            ((DVec3::new(x, y, z).dot(lamp).acos().to_degrees() / (0.5 * diameter_deg) - 0.75) / 0.5).clamp(0.0, 1.0);
        let light = 0.1 + 60.0 / diameter_deg * (1.0 - edge * edge * (3.0 - 2.0 * edge));
        let efficiency = strength(m, nm) * 4.0 * z * wo.z / (z + wo.z).powi(2);
        if z > 0.0 {
            xyz += DVec3::from(*weight) * efficiency * light;
        };
    }
    RgbSpace::Srgb.from_xyz(xyz.to_array())
}

#[test]
fn a_plane_has_the_colour_of_the_grating_equation() {
    let user = User::new();
    save(&user, "cd.exr", compact_disc());
    let (mut worst, mut brightest) = (0.0, 0.0);
    for (eye, lamp, diameter) in [
        ([60.0, 0.0], [81.0, 180.0], 1.0),
        ([60.0, 0.0], [38.0, 180.0], 0.5),
        ([60.0, 0.0], [32.4, 180.0], 3.0),
        ([60.0, 0.0], [79.2, 0.0], 2.0),
        ([30.0, 20.0], [56.2, 212.2], 2.0),
        ([50.0, 90.0], [44.8, -65.0], 6.0),
        ([60.0, 0.0], [60.0, 180.0], 0.5),
        // Seen from below, the back has the same structure.
        ([-60.0, 0.0], [-83.5, 180.0], 1.0),
    ] {
        let [[eye_up, eye_around], [lamp_up, lamp_around]]: [[f64; 2]; 2] = [eye, lamp];
        user.ok(&format!(
            "render cd.exr -o a.exr --env lamp:{lamp_up},{lamp_around},{diameter} --mesh plane --size 1 --samples 1 \
             --fov 0.1 --distance 100 --azimuth {eye_around} --elevation {eye_up}"
        ));
        let [r, g, b, _] = picture(&user, "a.exr").rgba[0];
        let flip = DVec3::new(1.0, 1.0, eye_up.signum());
        let expected =
            grating_colour(flip * towards(eye_up, eye_around), flip * towards(lamp_up, lamp_around), diameter);
        let apart = delta_e(lab([r, g, b].map(f64::from)), lab(expected));
        println!("eye {eye:?}, lamp {lamp:?} of {diameter}°: ΔE2000 {apart:.3}, {expected:.3?}");
        worst = f64::max(worst, apart);
        brightest = f64::max(brightest, expected[1]);
    }
    assert!(worst <= COLOUR && brightest > 0.3, "{worst} {brightest}");
}

#[test]
fn a_disc_has_tracks_around_its_middle() {
    let user = User::new();
    save(&user, "cd.exr", compact_disc());
    let size = 24;
    user.ok(&format!(
        "render cd.exr -o a.exr --env lamp:55,140,8 --mesh disc --size {size} --samples 1 --azimuth -60 --elevation 40"
    ));
    let (eye, rays) = rays(-60.0, 40.0, size);
    let (mut worst, mut seen, mut bright) = (0.0, 0, 0);
    for (ray, [r, g, b, _]) in rays.into_iter().zip(picture(&user, "a.exr").rgba) {
        let point = eye - eye.z / ray.z * ray;
        if !(46.0 / 116.0..=1.0).contains(&point.length()) {
            continue;
        }
        let across = point.normalize();
        let local = |d: DVec3| DVec3::new(d.dot(across), d.dot(DVec3::Z.cross(across)), d.z);
        let expected = grating_colour(local(-ray), local(towards(55.0, 140.0)), 8.0);
        worst = f64::max(worst, delta_e(lab([r, g, b].map(f64::from)), lab(expected)));
        seen += 1;
        bright += usize::from(expected.iter().any(|&c| c > 0.3));
    }
    println!("{seen} pixels, {bright} of them bright: ΔE2000 up to {worst:.3}");
    assert!(worst <= COLOUR && seen > 100 && bright > 5, "{worst} {seen} {bright}");
}

/// Strength of each order but order 0 in [`lossless`]. Near the horizon, where match factors have kinks between nodes,
/// order 0 is off by a part of it.
const SHARE: f64 = 5e-3;

/// A table that loses nothing: of what the constant strengths of orders beside it leave, order 0 reflects the rest.
fn lossless() -> OrderTable {
    let mut lossless = table((0..=40).map(|i| 380.0 + 10.0 * f64::from(i)).collect(), 3, |_, _| SHARE);
    lossless.layout =
        goniochrome::table::OrderLayout::new([200, 100], lossless.layout.periodicity(), [400.0; 2]).unwrap();
    let count = lossless.layout.count();
    let strength: Vec<f32> = (0..lossless.wavelength_nm.len() * count)
        .flat_map(|i| {
            let (nm, wo) = (lossless.wavelength_nm[i / count], lossless.layout.direction(i % count));
            let left = (-3..=3).filter(|&m| m != 0).fold(1.0, |left, m| {
                let up = 1.0 - (f64::from(m) * nm / 400.0 - wo.x).powi(2) - wo.y * wo.y;
                let (i, o) = (wo.z, up.max(0.0).sqrt());
                left - SHARE * 4.0 * i * o / (i + o).powi(2)
            });
            (-3..=3).map(move |m| if m == 0 { left as f32 } else { SHARE as f32 })
        })
        .collect();
    lossless.error = vec![0.0; lossless.wavelength_nm.len() * count];
    for values in [&mut lossless.transmitted.s, &mut lossless.transmitted.p] {
        *values = vec![0.0; strength.len()];
    }
    (lossless.reflected.s, lossless.reflected.p) = (strength.clone(), strength);
    lossless
}

#[test]
fn what_loses_nothing_is_white_in_even_light() {
    let user = User::new();
    save(&user, "lossless.exr", lossless());
    environment(&user, "one.exr", [16, 8], |_, _| [1.0; 3]);
    for (mesh, elevation, env, more) in [
        ("sphere", 24, "white", ""),
        ("sphere", 24, "one.exr", "--spectral"),
        ("disc", 35, "one.exr", ""),
        ("disc", -35, "white", "--spectral"),
        ("disc", 35, "one.exr", "--spread 5"),
    ] {
        user.ok(&format!(
            "render lossless.exr -o a.exr --env {env} --mesh {mesh} --elevation {elevation} --size 40 --samples 1 \
             --background transparent {more}"
        ));
        let covered: Vec<[f32; 4]> = picture(&user, "a.exr").rgba.into_iter().filter(|p| p[3] > 0.0).collect();
        let off = |p: &[f32; 4]| p[..3].iter().map(|c| (c - 1.0).abs()).fold(0.0, f32::max);
        let worst = covered.iter().map(off).fold(0.0, f32::max);
        println!("{mesh} {env} {more}: {worst:.1e}");
        assert!(covered.len() > 300 && worst <= FURNACE, "{mesh} {env} {more}: {worst}");
    }
}

#[test]
fn in_white_light_a_colour_is_the_sum_of_the_librarys_albedos() {
    // Rounding of single precision.
    const ROUNDING: f64 = 1e-5;
    let user = User::new();
    let table = compact_disc();
    save(&user, "cd.exr", table.clone());
    let mut weights = vec![[0.0; 3]; table.wavelength_nm.len()];
    xyz_weights(&table.wavelength_nm, Illuminant::D65, Quadrature::Interpolated, &mut weights).unwrap();
    let rgb: Vec<[f64; 3]> = weights.iter().map(|xyz| RgbSpace::Srgb.from_xyz(*xyz)).collect();
    let arrays = table.arrays(rgb);
    let lookup = arrays.table().unwrap();
    for elevation in [80.0, 20.0] {
        user.ok(&format!(
            "render cd.exr -o a.exr --env white --mesh plane --size 1 --samples 1 --fov 0.1 --distance 100 --azimuth 30 \
             --elevation {elevation}"
        ));
        let found = picture(&user, "a.exr").rgba[0];
        let view = lookup.view(towards(elevation, 30.0).as_vec3()).unwrap();
        for (c, &found) in found[..3].iter().enumerate() {
            let term = |w: usize| f64::from(lookup.rgb_weight(w)[c] * view.albedo(w));
            let expected: f64 = (0..lookup.wavelength_count()).map(term).sum();
            assert!((f64::from(found) - expected).abs() <= ROUNDING, "{elevation}: {found} {expected}");
        }
    }
}

#[test]
fn one_sample_a_pixel_has_no_noise() {
    // A smooth picture is a line through three neighbours, but for its curvature, in pixels of 3e-5 of a radian.
    const CURVATURE: f32 = 1e-4;
    let user = User::new();
    save(&user, "cd.exr", compact_disc());
    for light in ["studio", "lamp:81,180,4"] {
        user.ok(&format!(
            "render cd.exr -o a.exr --env {light} --mesh plane --size 64 --samples 1 --fov 0.1 --distance 100 --azimuth 0 \
             --elevation 60"
        ));
        let pixels = picture(&user, "a.exr").rgba;
        let bent = |three: &[[f32; 4]], c: usize| (three[0][c] - 2.0 * three[1][c] + three[2][c]).abs() / three[1][1];
        let rows = pixels.chunks(64).flat_map(|row| row.windows(3));
        let worst = rows.flat_map(|three| (0..3).map(move |c| bent(three, c))).fold(0.0, f32::max);
        println!("{light}: {worst:.1e}");
        assert!(worst <= CURVATURE, "{light}: {worst}");
    }
}

#[test]
fn a_spread_lamp_is_a_gaussian_of_its_power() {
    // The sphere's curvature and the bilinear image, each below a percent.
    const PEAK: f64 = 0.02;
    let user = User::new();
    save(&user, "mirror.exr", table(vec![400.0, 550.0, 700.0], 1, |m, _| if m == 0 { 1.0 } else { 0.0 }));
    let (sigma, radius) = (3f64.to_radians(), 0.5f64.to_radians());
    // The lamp widens the Gaussian by a disc's variance.
    let variance = sigma * sigma + radius * radius / 4.0;
    // The power of a disc whose edge falls by the smoothstep between 3/4 and 5/4 of its radius.
    let power = 60.0 * PI * radius * radius * (1.0 + 1.0 / 16.0 / 5.0);
    for apart in [0.0, 2.0, 5.0, 8.0] {
        user.ok(&format!(
            "render mirror.exr -o a.exr --env lamp:60,180,1 --spread 3 --mesh plane --size 1 --samples 1 --fov 0.1 \
             --distance 100 --azimuth 0 --elevation {}",
            60.0 - apart
        ));
        let found = f64::from(picture(&user, "a.exr").rgba[0][1]) - 0.1;
        let expected = power / (TAU * variance) * (-f64::to_radians(apart).powi(2) / variance / 2.0).exp();
        println!("{apart}°: {found:.4} of {expected:.4}");
        assert!((found / expected - 1.0).abs() <= PEAK, "{apart}: {found} {expected}");
    }
}

#[test]
fn lamps_light_other_tables_too() {
    let user = User::new();
    white(&user);
    user.ok(
        "render white.exr -o a.exr --env lamp:60,180,2 --mesh plane --size 1 --samples 1 --fov 0.1 --distance 100 --azimuth 0 \
         --elevation 60",
    );
    assert!((picture(&user, "a.exr").rgba[0][0] - 30.1).abs() < 1e-3);
}

#[test]
fn what_orders_cannot_do_is_refused() {
    let user = User::new();
    save(&user, "cd.exr", compact_disc());
    white(&user);
    user.refused("render cd.exr -o a.png --reflections 2", 2, &["--reflections", "branches"]);
    user.refused("render cd.exr -o a.png --spread 0.1", 2, &["--spread 0.1", "from 0.25 to 30 degrees"]);
    user.refused("render cd.exr -o a.png --spread nan", 2, &["--spread NaN"]);
    user.refused("render white.exr -o a.png --spread 1", 2, &["--spread", "no diffraction orders or facet lobes"]);
    for lamp in ["lamp:1,2", "lamp:a,b,c", "lamp:91,0,1", "lamp:0,inf,1", "lamp:0,0,0.05", "lamp:"] {
        user.refused(&format!("render cd.exr -o a.png --env {lamp}"), 2, &["--env lamp:", "degrees"]);
    }
    save(&user, "black.exr", table(vec![400.0, 550.0], 1, |_, _| 0.0));
    user.refused("render black.exr -o a.png", 1, &["black.exr: the table reflects nothing"]);
    save(&user, "one.exr", table(vec![550.0], 1, |_, _| 0.1));
    user.refused("render one.exr -o a.png --spectral", 1, &["one.exr: 1 wavelengths cannot tell"]);
    user.ok("render one.exr -o a.png --mesh disc --env lamp --size 8 --samples 1");
    save(&user, "infrared.exr", table(vec![900.0, 950.0], 1, |_, _| 0.1));
    user.refused("render infrared.exr -o a.png", 1, &["infrared.exr", "invisible"]);
}
