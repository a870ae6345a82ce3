//! Tests of films that light goes through, and of tables over the thickness of a layer.

use std::f32::consts::{FRAC_PI_2, PI, TAU};

use glam::Vec3;
use goniochrome_cli::table::finish::FinishChoice;
use goniochrome_cli::table::mirror::MirrorTable;
use goniochrome_cli::table::{Table, file};

use crate::render::{environment, picture};
use crate::user::User;

/// Largest difference of a pixel: single precision, and R + T of a clear film, whose colours add up to white by the
/// same quadrature.
const PIXEL: f32 = 1e-3;

fn table(user: &User, name: &str) -> MirrorTable {
    let Table::Mirror(table) = file::read(&user.at(name)).unwrap() else { panic!("{name} is planar") };
    table
}

#[test]
fn a_clear_sheet_in_white_light_is_not_seen() {
    let user = User::new();
    user.ok("estimate soap-bubble -o one.exr -q");
    user.ok("estimate soap-bubble --vary 1=20:800:40 -o many.exr -q");
    for (source, mesh, more) in [
        ("one.exr", "sphere", ""),
        ("one.exr", "teapot", "--reflections 1"),
        ("one.exr", "teapot", "--reflections 8"),
        ("one.exr", "plane", "--spectral"),
        ("many.exr", "sphere", "--thickness drain"),
        ("many.exr", "teapot", "--thickness noise --spectral"),
    ] {
        user.ok(&format!(
            "render {source} -o a.exr --env white --mesh {mesh} --size 96 --samples 4 --background transparent {more}"
        ));
        let covered: Vec<[f32; 4]> = picture(&user, "a.exr").rgba.into_iter().filter(|p| p[3] > 0.0).collect();
        assert!(covered.len() > 96 * 96 / 10, "{mesh}: {}", covered.len());
        for [r, g, b, a] in covered {
            assert!([r, g, b].iter().all(|c| (c / a - 1.0).abs() <= PIXEL), "{mesh} {more}: {r} {g} {b} {a}");
        }
    }
}

#[test]
fn a_rough_sheet_in_white_light_lacks_what_meets_a_second_facet() {
    /// Steps over √θ_m and φ_m of the integral over the facets.
    const STEPS: [u32; 2] = [400, 360];
    let user = User::new();
    user.write("facets.csv", "theta_deg,D\n0,3\n10,2\n25,1\n40,0.2\n60,0\n");
    let film =
        "[stack]\nambient = 1.0\nlayers = [{ material = 1.8, thickness_nm = 90 }]\nsubstrate = 1.0\n\n[finish]\n";
    for (text, options) in [
        ("roughness = 0.3", ""),
        ("roughness = [0.1, 0.4]\ndistribution = \"beckmann\"", "--spectral"),
        ("distribution = { file = \"facets.csv\" }", ""),
    ] {
        user.write("s.toml", format!("{film}{text}\n"));
        user.ok("estimate s.toml -o t.exr -q");
        user.ok(&format!(
            "render t.exr -o a.exr --env white --mesh plane --azimuth 0 --elevation 30 --size 9 --samples 1024 {options}"
        ));
        let found = picture(&user, "a.exr").rgba[9 * 4 + 4];
        let table = table(&user, "t.exr");
        let owned = FinishChoice::default().of(&table.metadata).unwrap().unwrap();
        let finish = owned.finish();
        // The middle of the picture is seen 60 degrees from the normal.
        let wo = Vec3::new(0.75_f32.sqrt(), 0.0, 0.5);
        let (mut seen, mut lost) = (0.0, [0.0; 3]);
        for i in 0..STEPS[0] * STEPS[1] {
            let part = ((i / STEPS[1]) as f32 + 0.5) / STEPS[0] as f32;
            let (theta, phi) = (FRAC_PI_2 * part * part, TAU * (i % STEPS[1]) as f32 / STEPS[1] as f32);
            let m = Vec3::new(theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos());
            let solid_angle = theta.sin() * (PI * part / STEPS[0] as f32) * TAU / STEPS[1] as f32;
            let share = finish.density(m) * wo.dot(m).max(0.0) * solid_angle / finish.visible_area(wo);
            let wi = 2.0 * wo.dot(m) * m - wo;
            // G₂/G₁ of the light: what reaches the viewer of what the facet reflects.
            let reaches =
                if wi.z > 0.0 { 4.0 * wi.z * finish.visible_area(wo) * finish.shadowing(wi, wo) } else { 0.0 };
            let rho = table.rgb_at(f64::from(wo.dot(m).clamp(0.0, 1.0)).acos().to_degrees());
            seen += share;
            (0..3).for_each(|c| lost[c] += rho[c] * share * (1.0 - reaches));
        }
        assert!((seen - 1.0).abs() <= 0.3 * PIXEL, "{text}: the viewer sees {seen} of the facets");
        assert!(lost.iter().all(|lost| *lost > PIXEL), "{text}: {lost:?}");
        assert!((0..3).all(|c| (found[c] - 1.0 + lost[c]).abs() <= PIXEL), "{text}: {found:?}, lost {lost:?}");
    }
}

#[test]
fn a_pane_shows_the_light_above_it_by_r_and_the_light_below_it_by_t() {
    let user = User::new();
    // A film that absorbs: R + T is not 1.
    user.write(
        "s.toml",
        "[stack]\nambient = 1.0\nlayers = [{ material = [1.6, 0.2], thickness_nm = 240 }]\nsubstrate = 1.0\n",
    );
    user.ok("estimate s.toml -o t.exr -q");
    environment(&user, "e.exr", [64, 32], |_, y| if y < 16 { [1.0, 0.0, 0.5] } else { [0.0, 1.0, 0.25] });
    let drawn = |more: &str| {
        user.ok(&format!("render t.exr -o a.exr --env e.exr --mesh plane --elevation 50 --size 65 --samples 1 {more}"));
        picture(&user, "a.exr").rgba[65 * 32 + 32]
    };
    let table = table(&user, "t.exr");
    let through = MirrorTable { rgb: table.rgb_transmitted.clone(), ..table.clone() };
    // The ray through the middle of the picture meets the plane 40 degrees from its normal.
    let (r, t) = (table.rgb_at(40.0), through.rgb_at(40.0));
    assert!(t.iter().zip(r).all(|(t, r)| (0.1..0.9).contains(t) && (0.01..0.5).contains(&r)), "{r:?} {t:?}");
    let close = |found: [f32; 4], expected: [f32; 3]| {
        assert!((0..3).all(|c| (found[c] - expected[c]).abs() <= PIXEL), "{found:?} for {expected:?}");
    };
    close(drawn(""), [r[0], t[1], 0.5 * r[2] + 0.25 * t[2]]);
    close(drawn("--body solid"), [r[0], 0.0, 0.5 * r[2]]);
    close(drawn("--background 0.25,0.5,0"), [r[0] + 0.25 * t[0], 0.5 * t[1], 0.5 * r[2]]);
}

#[test]
fn a_table_over_a_thickness_holds_the_tables_of_its_thicknesses() {
    let user = User::new();
    let scene = |nm: f64| {
        format!(
            "[stack]\nambient = 1.0\nlayers = [{{ material = 1.33, thickness_nm = 90 }}, {{ material = 2.4, thickness_nm = {nm:?} }}]\nsubstrate = 1.5\n"
        )
    };
    user.write("s.toml", scene(7.0));
    user.ok("estimate s.toml --vary 2=50:150:3 --wavelengths 400:700:10 --angles 30 -o many.exr -q");
    let many = table(&user, "many.exr");
    assert_eq!(many.thickness.as_ref().unwrap().nm, [50.0, 100.0, 150.0]);
    for nm in [50.0, 100.0, 150.0] {
        user.write("one.toml", scene(nm));
        user.ok("estimate one.toml --wavelengths 400:700:10 --angles 30 -o one.exr -q");
        let (one, of_many) = (table(&user, "one.exr"), many.at_thickness(nm));
        let arrays = |t: &MirrorTable| {
            let colours = [t.rgb.as_flattened(), t.rgb_transmitted.as_flattened()].concat();
            [&t.reflectance_s[..], &t.reflectance_p, &t.transmittance_s, &t.transmittance_p, &colours].concat()
        };
        assert!(arrays(&one) == arrays(&of_many), "{nm} nm");
        assert!(one.is_transparent());
        let lookup = |line: &str| user.ok(line).stdout;
        let asked = lookup(&format!("lookup many.exr --wi 30,0 --thickness {nm} --csv -"));
        assert_eq!(asked, lookup("lookup one.exr --wi 30,0 --csv -"));
    }
    // A picture of one grey, and the number that it stands for.
    user.write("grey.npy", npy(&[0.25; 4]));
    let drawn = |thickness: &str| {
        user.ok(&format!("render many.exr --thickness {thickness} -o a.exr --size 32 --samples 1"));
        picture(&user, "a.exr").rgba
    };
    assert_eq!(drawn("grey.npy"), drawn("75"));
    assert!(drawn("75") != drawn("drain"));
}

/// The bytes of a NumPy file of a row of numbers.
fn npy(values: &[f32]) -> Vec<u8> {
    let header = format!("{{'descr': '<f4', 'fortran_order': False, 'shape': (1, {}), }}", values.len());
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((118u16).to_le_bytes());
    bytes.extend(format!("{header:<117}\n").bytes());
    bytes.extend(values.iter().flat_map(|x| x.to_le_bytes()));
    bytes
}

#[test]
fn opaque_bodies_have_no_transmittance_and_films_on_glass_are_no_sheets() {
    let user = User::new();
    for (scene, transparent) in [("anodised-titanium", false), ("soap-bubble", true), ("oil-on-water", true)] {
        user.ok(&format!("estimate {scene} -o {scene}.exr --wavelengths 400:700:20 -q"));
        assert_eq!(table(&user, &format!("{scene}.exr")).is_transparent(), transparent, "{scene}");
    }
    let said = |scene: &str| user.ok(&format!("export {scene}.exr --to merl --roughness 0.3 -o a.binary")).stderr;
    assert!(said("soap-bubble").contains("merl holds reflected light alone"));
    assert!(!said("anodised-titanium").contains("reflected light alone"));
    user.refused("render oil-on-water.exr -o a.png --body sheet -q", 2, &["--body sheet", "both sides"]);
    user.refused("render anodised-titanium.exr -o a.png --body sheet -q", 2, &["--body sheet"]);
    user.ok("estimate soap-bubble --model paper --wavelengths 400:700:20 -o paper.exr -q");
    assert!(!table(&user, "paper.exr").is_transparent());
}

#[test]
fn what_thickness_cannot_be_is_said() {
    let user = User::new();
    user.ok("estimate soap-bubble --vary 1=100:300:5 --wavelengths 400:700:20 -o many.exr -q");
    user.ok("estimate soap-bubble --wavelengths 400:700:20 -o one.exr -q");
    user.write("word.png", "no picture");
    for (line, says) in [
        ("render many.exr -o a.png -q", "--thickness is missing"),
        ("render many.exr -o a.png --thickness 99 -q", "100 to 300 nm of layer 1"),
        ("render one.exr -o a.png --thickness 200 -q", "estimate --vary"),
        ("plot many.exr -o a.png -q", "--thickness is missing"),
        ("lookup many.exr --wi 0,0 --thickness 400 -q", "100 to 300 nm of layer 1"),
        ("export many.exr --to merl -o a.binary -q", "--thickness is missing"),
        ("export many.exr --to blob --thickness 200 -o a.gonio -q", "--thickness is for"),
        ("estimate soap-bubble --vary 2=100:300:5 -o b.exr -q", "has 1 layers"),
        ("estimate beetle-pits --vary 1=100:300:5 -o b.exr -q", "--vary"),
        ("estimate compact-disc --vary 1=100:300:5 -o b.exr -q", "--vary"),
        ("estimate soap-bubble --vary 1=300:100:5 -o b.exr -q", "LAYER=FROM:TO:STEPS"),
    ] {
        user.refused(line, 2, &[says]);
    }
    user.refused("render many.exr -o a.png --thickness word.png -q", 1, &["word.png", "neither PNG"]);
    user.refused("estimate soap-bubble --vary 1=0:4000:4096 --angles 9000 -o b.exr -q", 1, &["are too many"]);
}
