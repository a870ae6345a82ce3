//! Tests of `export --to blob`: the library loads what the table holds.

use goniochrome::colour::RgbSpace;
use goniochrome::simd::complex::Polarised;
use goniochrome::table::blob::{Blob, Contents};
use goniochrome::table::{OrderLayout, Periodicity};
use goniochrome_cli::table::metadata::{Metadata, MetadataKey};
use goniochrome_cli::table::orders::OrderTable;
use goniochrome_cli::table::{Table, file};

use crate::user::User;

/// Rounding of a number near 1 in half precision.
const HALF: f32 = 1.0 / 2048.0;

#[test]
fn a_planar_table_loads_with_its_colours_and_space() {
    let user = User::new();
    user.ok("estimate jewel-beetle -o t.exr --angles 30 --space rec2020 --quiet");
    user.ok("export t.exr --to blob -o t.gonio --quiet");
    user.ok("export t.exr --to blob --half -o h.gonio --quiet");
    let Table::Mirror(table) = file::read(&user.at("t.exr")).unwrap() else { panic!("a planar table") };
    let (single, half) = (user.read("t.gonio"), user.read("h.gonio"));
    assert_eq!((single.len(), half.len()), (64 + 30 * 3 * 4, 64 + 30 * 3 * 2));
    let blob = Blob::read(&single).unwrap();
    assert_eq!(blob.space, Some(RgbSpace::Rec2020));
    let Contents::Mirror(read) = blob.contents else { panic!("a planar table") };
    let Contents::Mirror(rounded) = Blob::read(&half).unwrap().contents else { panic!("a planar table") };
    for (theta, rgb) in table.theta_deg.iter().zip(&table.rgb) {
        let theta = theta.to_radians() as f32;
        for ((want, got), rounded) in rgb.iter().zip(read.rgb(theta)).zip(rounded.rgb(theta)) {
            // The angle itself is rounded.
            assert!((got - want).abs() < 1e-5);
            assert!((rounded - want).abs() < 1e-5 + HALF * want.abs());
        }
    }
}

#[test]
fn a_table_of_a_cell_loads_with_its_sampler() {
    let user = User::new();
    user.ok(
        "estimate beetle-pits -o t.exr --incident 3x2 --half-vectors 4x8 --rays 64 --wavelengths 400:700:60 --quiet",
    );
    user.ok("export t.exr --to blob -o t.gonio --quiet");
    let bytes = user.read("t.gonio");
    let Table::Scatter(table) = file::read(&user.at("t.exr")).unwrap() else { panic!("a cell's table") };
    let Contents::Scatter(read, sampler) = Blob::read(&bytes).unwrap().contents else { panic!("a cell's table") };
    assert_eq!(read.layout(), table.layout);
    for i in 0..table.layout.incident_count() {
        let [theta, phi] = table.layout.incident(i).map(|x| x as f32);
        let wi = glam::Vec3::new(theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos());
        let (wo, pdf) = sampler.sample(wi, [0.4, 0.7]).unwrap();
        // The half vector is found anew from the directions: some roundings, over the angle to the normal.
        const ROUNDING: f32 = 1e-4;
        assert!(pdf > 0.0 && (sampler.pdf(wi, wo) / pdf - 1.0).abs() < ROUNDING);
        assert!(read.rgb(wi, wo).iter().any(|f| *f > 0.0), "drawn where it reflects");
    }
}

/// A table of three orders of lines 1600 nm apart, at four wavelengths.
fn lines() -> OrderTable {
    let layout = OrderLayout::new([5, 3], Periodicity::X, [1600.0, 1600.0]).unwrap();
    let wavelength_nm = vec![420.0, 500.0, 580.0, 660.0];
    let strengths = |seed: usize| (0..4 * 15 * 3).map(|i| ((i + seed) * 37 % 101) as f32 / 101.0).collect::<Vec<_>>();
    OrderTable {
        layout,
        orders: vec![[-1, 0], [0, 0], [1, 0]],
        index_above: vec![1.0; 4],
        index_below: vec![0.0; 4],
        reflected: Polarised { s: strengths(0), p: strengths(1) },
        transmitted: Polarised { s: vec![0.0; 180], p: vec![0.0; 180] },
        error: vec![1e-4; 4 * 15],
        metadata: [(MetadataKey::ColourSpace, "acescg"), (MetadataKey::Scene, "lines")]
            .into_iter()
            .collect::<Metadata>(),
        wavelength_nm,
    }
}

#[test]
fn a_table_of_orders_loads_with_its_wavelengths() {
    let user = User::new();
    let table = lines();
    file::write(&user.at("t.exr"), &table.clone().into(), 2).unwrap();
    user.ok("export t.exr --to blob -o t.gonio --quiet");
    user.ok("export t.exr --to blob --half -o h.gonio --quiet");
    let (single, half) = (user.read("t.gonio"), user.read("h.gonio"));
    let axes = 4 * (2 * 3 + 5 * 4);
    assert_eq!((single.len(), half.len()), (64 + 4 * 180 + axes, 64 + 2 * 180 + axes));
    let blob = Blob::read(&single).unwrap();
    assert_eq!(blob.space, Some(RgbSpace::AcesCg));
    let Contents::Orders(read) = blob.contents else { panic!("a table of orders") };
    let Contents::Orders(rounded) = Blob::read(&half).unwrap().contents else { panic!("a table of orders") };
    for node in 0..table.layout.count() {
        let wo = table.layout.direction(node).as_vec3();
        let (view, rounded) = (read.view(wo).unwrap(), rounded.view(wo).unwrap());
        for (w, order) in (0..4).flat_map(|w| (0..3).map(move |order| (w, order))) {
            let Some(light) = view.light(w, order) else { continue };
            let factor = goniochrome::table::match_factor(wo.z, light.direction.z);
            let expected = table.unpolarised()[table.first(w, node) + order] * factor;
            // The angles themselves are rounded.
            assert!((light.efficiency - expected).abs() < 1e-5, "{light:?} for {expected}");
            assert!((rounded.light(w, order).unwrap().efficiency - expected).abs() < 1e-5 + HALF);
        }
    }
    // White light makes white.
    let white: [f32; 3] = std::array::from_fn(|c| (0..4).map(|w| read.rgb_weight(w)[c]).sum());
    assert!(white.iter().all(|c| (c - 1.0).abs() < 0.1), "{white:?}");
}

#[test]
fn what_is_no_table_and_what_does_not_fit_is_refused() {
    let user = User::with(&[("text.exr", "no image")]);
    user.refused("export text.exr --to blob -o t.gonio", 1, &["text.exr", "not a readable EXR file"]);
    user.refused("export missing.exr --to blob -o t.gonio", 1, &["missing.exr", "`goniochrome estimate` writes"]);
    user.refused("export text.exr --to blob -o text.exr", 2, &["would overwrite the input"]);
}
