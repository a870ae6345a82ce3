//! Tests of every preset with the commands that take it.

use exr::prelude::{FlatImage, read_first_flat_layer_from_file};
use goniochrome_cli::scene::presets;
use goniochrome_cli::scene::{Shape, load};
use tiny_skia::Pixmap;

use crate::user::{User, column, largest_difference, triples};

/// The presets of plane layers.
fn names() -> impl Iterator<Item = &'static str> {
    presets::names().filter(|name| matches!(load(name).expect(name).shape, Shape::Stack { .. }))
}

/// The presets of tilted facets.
fn mesh_presets() -> impl Iterator<Item = &'static str> {
    presets::names().filter(|name| matches!(load(name).expect(name).shape, Shape::Mesh(_)))
}

/// Error of a power near 1 in single precision.
const SINGLE: f64 = 1e-5;
/// Presets whose media do not absorb, on a substrate that light enters.
const LOSSLESS: [&str; 5] = ["paper-fig4", "paper-fig6-300", "paper-fig6-3000", "soap-bubble", "quarter-wave-mirror"];

#[test]
fn the_list_names_each_preset_and_a_printed_one_is_the_same_scene() {
    let user = User::new();
    let list = user.ok("presets").stdout;
    assert_eq!(list.lines().count(), presets::names().count());
    for name in presets::names() {
        let line = list.lines().find(|line| line.split(' ').next() == Some(name)).expect(name);
        assert!(line.trim_start_matches(name).trim().len() > 20, "{line}");
    }
    for name in names() {
        user.write("scene.toml", user.ok(&format!("presets {name}")).stdout);
        let [preset, file] =
            [name, "scene.toml"].map(|scene| user.ok(&format!("spectrum {scene} --theta 0,60")).stdout);
        assert_eq!(preset, file, "{name}");
    }
}

/// Error of a power near 1 in double precision, with the rounding of every layer.
const DOUBLE: f64 = 1e-11;

#[test]
fn power_is_conserved() {
    let user = User::new();
    for name in names() {
        // `agreement` tests single precision beyond 80 degrees, where resonances amplify its rounding.
        for (grid, angles, tolerance) in
            [("--theta 0:77:11", 8, SINGLE), ("--theta 0:88:11 --precision f64", 9, DOUBLE)]
        {
            let csv = user.ok(&format!("spectrum {name} {grid}")).stdout;
            for [reflected, transmitted] in [["R_s", "T_s"], ["R_p", "T_p"]] {
                let [reflected, transmitted] = [reflected, transmitted].map(|name| column(&csv, name));
                assert_eq!(reflected.len(), angles * 81);
                for (r, t) in reflected.into_iter().zip(transmitted) {
                    assert!(r >= 0.0 && t >= 0.0 && r + t <= 1.0 + tolerance, "{name} {grid}: {r} + {t}");
                    let lost = 1.0 - r - t;
                    assert!(!LOSSLESS.contains(&name) || lost <= tolerance, "{name} {grid}: nothing absorbs {lost:e}");
                }
            }
            assert!(column(&csv, "truncated").iter().all(|truncated| *truncated <= tolerance), "{name}");
        }
    }
}

/// The peak of a preset's reflectance at normal incidence, by its source or design.
struct Peak {
    name: &'static str,
    /// Range of the peak's wavelength.
    wavelength_nm: [f64; 2],
    /// Range of the peak's reflectance.
    reflectance: [f64; 2],
    /// Range outside of which the reflectance is less than half of the peak's.
    half_nm: [f64; 2],
}

const PEAKS: [Peak; 4] = [
    // Stavenga et al. (2011): a peak near 530 nm, bands 100 to 150 nm wide where layers are graded and unequal; equal
    // ones are narrower.
    Peak { name: "jewel-beetle", wavelength_nm: [525.0, 535.0], reflectance: [0.36, 0.39], half_nm: [495.0, 570.0] },
    // Blue Morphos reflect some 400 to 500 nm; unbroken lamellae reflect more than ridges.
    Peak { name: "morpho-stack", wavelength_nm: [400.0, 480.0], reflectance: [0.7, 0.9], half_nm: [380.0, 530.0] },
    // 2 (1.83 · 80 nm + 1.34 · 70 nm) = 480 nm.
    Peak { name: "opaline-guanine", wavelength_nm: [475.0, 490.0], reflectance: [0.98, 1.0], half_nm: [430.0, 550.0] },
    // Macleod: R = ((1 - y)/(1 + y))² with y = (2.35/1.38)^20 · 1.52, 0.9999.
    Peak {
        name: "quarter-wave-mirror",
        wavelength_nm: [545.0, 555.0],
        reflectance: [0.999, 1.0],
        half_nm: [440.0, 720.0],
    },
];

#[test]
fn presets_reflect_what_their_sources_say() {
    let user = User::new();
    for Peak { name, wavelength_nm, reflectance, half_nm } in PEAKS {
        let csv = user.ok(&format!("spectrum {name} --theta 0 --wavelengths 380:780:1")).stdout;
        let (nm, r) = (column(&csv, "wavelength_nm"), column(&csv, "R_s"));
        let top = (0..r.len()).max_by(|&a, &b| r[a].total_cmp(&r[b])).expect("a spectrum");
        println!("{name}: {} at {} nm", r[top], nm[top]);
        assert!((wavelength_nm[0]..=wavelength_nm[1]).contains(&nm[top]), "{name}: {} nm", nm[top]);
        assert!((reflectance[0]..=reflectance[1]).contains(&r[top]), "{name}: {}", r[top]);
        let above = |i: &usize| r[*i] > 0.5 * r[top];
        let [first, last] = [(0..r.len()).find(above), (0..r.len()).rfind(above)].map(|i| nm[i.expect("the peak")]);
        assert!(half_nm[0] <= first && last <= half_nm[1], "{name}: half its peak from {first} to {last} nm");
    }
}

/// Red, green and blue of the first colour in a CSV.
fn hex(csv: &str) -> [u8; 3] {
    let hex = csv.lines().nth(1).and_then(|row| row.rsplit(',').next()).expect("a colour");
    [1, 3, 5].map(|at| u8::from_str_radix(&hex[at..at + 2], 16).expect("a colour"))
}

#[test]
fn presets_have_the_colours_that_they_name() {
    let user = User::new();
    type Looks = fn([u8; 3]) -> bool;
    let [blue, green, violet]: [Looks; 3] =
        [|[r, g, b]: [u8; 3]| b > g && g > r, |[r, g, b]: [u8; 3]| g > b && b > r, |[r, g, b]: [u8; 3]| b > r && r > g];
    let cases: [(&str, f64, Looks); 7] = [
        ("jewel-beetle", 0.0, green),
        ("jewel-beetle", 75.0, |[r, g, b]| b > r && b > g),
        ("morpho-stack", 0.0, blue),
        ("opaline-guanine", 30.0, blue),
        ("anodised-titanium", 0.0, blue),
        ("soap-bubble", 0.0, violet),
        ("quarter-wave-mirror", 0.0, |[r, g, b]| g > r && r > b),
    ];
    for (name, theta, holds) in cases {
        let rgb = hex(&user.ok(&format!("colour {name} --theta {theta} --csv - --quiet")).stdout);
        assert!(holds(rgb), "{name} at {theta}°: {rgb:?}");
    }
}

#[test]
fn the_built_in_materials_are_listed_with_their_ranges() {
    let user = User::new();
    let list = user.ok("presets --materials").stdout;
    assert!(list.lines().any(|line| line.starts_with("N-BK7 ") && line.contains("300 to 2500 nm")), "{list}");
    assert_eq!(user.run("presets soap-bubble --materials").code, Some(2));
    user.write("rutile.toml", "[stack]\nambient = \"air\"\nsubstrate = \"TiO2-rutile\"\n");
    // The error names the first wavelength that was asked for, not another of its group.
    user.refused("spectrum rutile.toml", 1, &["TiO2-rutile", "at 380 nm", "n covers 430 to 1530 nm"]);
    user.write("infrared.toml", "[stack]\nambient = \"air\"\nsubstrate = \"Al\"\n");
    user.ok("spectrum infrared.toml --wavelengths 1690,4000,10600");
}

/// The samples of an EXR channel.
fn channel(image: &FlatImage, name: &str) -> Vec<f64> {
    let channels = &image.layer_data[0].channel_data.list;
    let channel = channels.iter().find(|channel| channel.name.eq(name)).unwrap_or_else(|| panic!("no channel {name}"));
    channel.sample_data.values_as_f32().map(f64::from).collect()
}

fn exr(user: &User, name: &str) -> FlatImage {
    let image = read_first_flat_layer_from_file(user.at(name)).expect("a program that knows no goniochrome reads it");
    FlatImage { attributes: image.attributes, layer_data: [image.layer_data].into_iter().collect() }
}

/// Rounding of a colour in CSV.
const CSV_DIGITS: f64 = 0.6e-6;

#[test]
fn tables_hold_what_spectrum_and_colour_print() {
    let user = User::new();
    for name in names() {
        let ran = user.ok(&format!("estimate {name} -o t.exr --angles 6"));
        let (count, rest) = ran.stderr.split_once(" wavelengths from 380 to 780 nm; ").expect("how many it took");
        assert!(rest.contains(&format!("\nt.exr: 6 angles × {count} wavelengths; truncated")), "{}", ran.stderr);
        let image = exr(&user, "t.exr");
        let theta = "--theta 0:75:15";
        let colours = triples(&user.ok(&format!("colour {name} {theta} --csv -")).stdout, ["R", "G", "B"]);
        for (i, component) in ["R", "G", "B"].into_iter().enumerate() {
            let printed: Vec<f64> = colours.iter().map(|rgb| rgb[i]).collect();
            assert!(largest_difference(&channel(&image, component), &printed) <= CSV_DIGITS, "{name} {component}");
        }
        let csv = user.ok(&format!("spectrum {name} {theta} --wavelengths 550")).stdout;
        let [s, p] = ["R_s", "R_p"].map(|name| column(&csv, name));
        // Reflectances are printed so that they read back as they were.
        assert!(largest_difference(&channel(&image, "s.T.550,000000nm"), &s) <= f64::from(f32::EPSILON), "{name}");
        assert!(largest_difference(&channel(&image, "p.T.550,000000nm"), &p) <= f64::from(f32::EPSILON), "{name}");
    }
}

/// Change of an 8-bit colour by anti-aliasing and interpolation between angles.
const LEVELS: u8 = 3;

fn shows(picture: &Pixmap, hex: &str) -> bool {
    let wanted = [1, 3, 5].map(|at| u8::from_str_radix(&hex[at..at + 2], 16).expect("a colour"));
    let near = |a: u8, b: u8| a.abs_diff(b) <= LEVELS;
    picture
        .pixels()
        .iter()
        .any(|pixel| near(pixel.red(), wanted[0]) && near(pixel.green(), wanted[1]) && near(pixel.blue(), wanted[2]))
}

/// Width and height of a PNG.
fn png_size(bytes: &[u8]) -> [u32; 2] {
    assert!(bytes.starts_with(b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR"), "a PNG");
    assert!(bytes.ends_with(b"IEND\xaeB`\x82"), "a whole PNG");
    [16, 20].map(|at| u32::from_be_bytes(bytes[at..at + 4].try_into().expect("four bytes")))
}

#[test]
fn tables_become_pictures() {
    let user = User::new();
    for name in names() {
        user.ok(&format!("estimate {name} -o t.exr --quiet"));
        let drawn = ["disc -o disc.png", "map -o map.png", "chromaticity -o path.png", "spectrum -o spectrum.svg"];
        for line in drawn {
            let ran = user.ok(&format!("plot t.exr --kind {line} -q"));
            assert_eq!((ran.stdout.as_str(), ran.stderr.as_str()), ("", ""), "{name} {line}");
        }
        for file in ["disc.png", "map.png"] {
            let [width, height] = png_size(&user.read(file));
            assert!(width >= 400 && height >= 400, "{name} {file}: {width} × {height}");
        }
        let disc = Pixmap::decode_png(&user.read("disc.png")).expect("a PNG");
        let csv = user.ok(&format!("colour {name} --theta 0,40 --csv -")).stdout;
        for row in csv.lines().skip(1) {
            let hex = row.rsplit(',').next().expect("a colour");
            assert!(shows(&disc, hex), "{name}: {hex} is not in the disc");
        }
        let svg = String::from_utf8(user.read("spectrum.svg")).expect("text");
        assert!(svg.starts_with("<svg ") && svg.trim_end().ends_with("</svg>"), "{name}");
        for label in ["Wavelength (nm)", "Reflectance", &format!("{name}: reflectance"), "45° s", "75° p"] {
            assert!(svg.contains(label), "{name}: {label:?} is missing");
        }
        for number in ["nan", "NaN", "inf"] {
            assert!(!svg.contains(&format!("{number},")) && !svg.contains(&format!(",{number}")), "{name}");
        }
    }
}

/// Power that a scattering estimate may leave out.
const LEFT_OUT: f64 = 1e-4;

#[test]
fn mesh_presets_scatter_all_of_the_light() {
    let user = User::new();
    assert_eq!(mesh_presets().count(), 13);
    for name in mesh_presets() {
        let light = "--theta 20 --phi 30 --wavelength 550 --coherence none --rays 1024 --json -";
        let report = user.ok(&format!("scatter {name} {light}")).stdout;
        let of = |key: &str| {
            let place = report.find(&format!("\"{key}\"")).expect(key);
            let value = report[place..].split("\"value\":").nth(1).expect("a value");
            value.split([',', '\n', '}']).next().expect("a number").trim().parse::<f64>().expect("a number")
        };
        let [reflected, transmitted, absorbed, truncated] =
            ["reflected", "transmitted", "absorbed", "truncated"].map(of);
        println!("{name}: {reflected} {transmitted} {absorbed} {truncated}");
        // The least: pyramids of a moth's eye.
        assert!(reflected > 1e-3 && transmitted > 0.01, "{name}: {reflected} {transmitted}");
        assert!(truncated <= LEFT_OUT, "{name}: {truncated}");
        let sum = reflected + transmitted + absorbed + truncated;
        assert!((sum - 1.0).abs() <= LEFT_OUT, "{name}: {sum}");
    }
}
