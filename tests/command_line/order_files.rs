//! Tests of `plot` and `export` with tables of diffraction orders.

use goniochrome_cli::table::file;
use goniochrome_cli::table::orders::OrderTable;

use crate::discs::{compact_disc, strength, table};
use crate::user::User;

/// A user with the table `cd.exr`.
fn user() -> User {
    let user = User::new();
    save(&user, "cd.exr", compact_disc());
    user
}

fn save(user: &User, name: &str, table: OrderTable) {
    file::write(&user.at(name), &table.into(), 1).unwrap();
}

/// The text of an SVG file.
fn svg(user: &User, name: &str) -> String {
    String::from_utf8(user.read(name)).unwrap()
}

#[test]
fn every_kind_of_picture_is_drawn() {
    let user = user();
    user.ok("plot cd.exr -o disc.png -q");
    assert!(user.read("disc.png").starts_with(b"\x89PNG"));
    user.ok("plot cd.exr -o disc.svg --theta 20 --phi 40 -q");
    let disc = svg(&user, "disc.svg");
    assert!(disc.contains("light from θ = 20°, φ = 40°") && disc.contains(">−1</text>"), "{disc}");
    user.ok("plot cd.exr --kind spectrum -o a.svg --theta 0");
    assert!(svg(&user, "a.svg").contains("the strongest 6 of"));
    user.ok("plot cd.exr --kind spectrum -o a.svg --order -1 --order 1,0");
    assert!(svg(&user, "a.svg").contains(">1 s</text>"));
    user.ok("plot cd.exr --kind angles -o a.svg --wavelength 633 --phi 90");
    assert!(svg(&user, "a.svg").contains("light of 633 nm in the plane φ = 90°"));
    user.ok("plot cd.exr --kind map -o a.svg");
    assert!(svg(&user, "a.svg").contains("all reflected orders"));
    user.ok("plot cd.exr --kind map -o a.svg --order 2");
    assert!(svg(&user, "a.svg").contains("order 2"));
    user.ok("plot cd.exr --kind chromaticity -o a.svg --theta 0,60");
}

#[test]
fn pictures_that_a_table_cannot_give_are_refused() {
    let user = user();
    user.ok("estimate paper-fig4 -o film.exr --angles 4 --wavelengths 400,550 --quiet");
    save(&user, "one.exr", table(vec![550.0], 1, strength));
    for (line, says) in [
        ("plot cd.exr --kind lobes -o a.png", ["no lobes", "angles"]),
        ("plot cd.exr --theta 10,20 -o a.png", ["--theta", "one angle"]),
        ("plot cd.exr --kind spectrum --theta 10,20 -o a.png", ["--theta", "one angle"]),
        ("plot cd.exr --kind spectrum --order 9 -o a.png", ["--order 9,0", "from -4,0 to 4,0"]),
        ("plot cd.exr --kind spectrum --order x -o a.png", ["--order", "M or M,N"]),
        ("plot cd.exr --kind map --order 0 --order 1 -o a.png", ["--order", "one order"]),
        ("plot cd.exr --kind map --theta 3 -o a.png", ["--theta", "every angle"]),
        ("plot cd.exr --kind disc --order 1 -o a.png", ["--order", "every order"]),
        ("plot cd.exr --kind angles --wavelength 900 -o a.png", ["--wavelength 900", "380 to 780"]),
        ("plot cd.exr --kind spectrum --wavelength 500 -o a.png", ["--wavelength", "--kind angles"]),
        ("plot one.exr --kind map -o a.png", ["--kind map", "one wavelength"]),
        ("plot film.exr --kind angles -o a.png", ["no orders", "spectrum"]),
        ("plot film.exr --kind spectrum --order 1 -o a.png", ["--order", "diffraction orders"]),
    ] {
        user.refused(line, 2, &says);
    }
}

#[test]
fn textures_and_their_shader_functions_are_written() {
    let user = user();
    for language in ["glsl", "hlsl", "wgsl"] {
        let said = user.ok(&format!("export cd.exr --to order-lut -o lut.exr --shader cd.{language}")).stderr;
        assert!(said.contains("45 × 12 texels, 9 orders at 16 wavelengths"), "{said}");
        let shader = svg(&user, &format!("cd.{language}"));
        assert!(shader.contains(" goniochrome_orders(") && shader.contains("GONIOCHROME_WEIGHTS"), "{shader}");
    }
    user.ok("export cd.exr --to order-lut --bands 32 -o lut.exr --shader cd.glsl -q");
    assert!(svg(&user, "cd.glsl").contains("GONIOCHROME_WAVELENGTH_COUNT = 32;"));
}

#[test]
fn a_bsdf_file_has_a_stated_width() {
    let user = user();
    user.ok("export cd.exr --to bsdf --spread 20 -o cd.bsdf -q");
    assert!(user.read("cd.bsdf").starts_with(b"tensor_file\0\x01\0\x0a\0\0\0"));
    user.ok("export cd.exr --to bsdf --spread 20 --rgb -o cd.bsdf -q");
    assert!(user.read("cd.bsdf").starts_with(b"tensor_file\0\x01\0\x09\0\0\0"));
}

#[test]
fn exports_that_cannot_hold_orders_are_refused_with_the_remedy() {
    let user = user();
    user.ok("estimate paper-fig4 -o film.exr --angles 4 --wavelengths 400,550 --quiet");
    save(&user, "one.exr", table(vec![550.0], 1, strength));
    for (line, code, says) in [
        ("export cd.exr --to bsdf -o a.bsdf", 2, ["--spread is missing", "degrees"]),
        (
            "export cd.exr --to bsdf --roughness 0.1 -o a.bsdf",
            2,
            ["--energy-compensation: are for mirror-like", "--spread 2"],
        ),
        ("export cd.exr --to bsdf --spread 0 -o a.bsdf", 2, ["--spread", "[0.5, 30]"]),
        ("export film.exr --to bsdf --spread 2 -o a.bsdf", 2, ["--spread is for", "leave it out"]),
        ("export cd.exr --to merl --spread 2 -o a.binary", 1, ["diffraction orders", "bsdf with --spread"]),
        ("export cd.exr --to merl -o a.binary", 1, ["diffraction orders", "export a bsdf"]),
        ("export cd.exr --to lut -o a.exr", 1, ["diffraction orders", "order-lut"]),
        ("export cd.exr --to gltf -o a.gltf", 1, ["diffraction orders", "order-lut"]),
        ("export film.exr --to order-lut -o a.exr", 1, ["no diffraction orders", "export a lut"]),
        ("export one.exr --to order-lut -o a.exr", 1, ["550 to 550 nm", "several wavelengths"]),
        ("export cd.exr --to order-lut --bands 6 -o a.exr", 2, ["--bands", "multiple of 4"]),
        ("export cd.exr --to order-lut -o a.png", 2, [".exr", "name it so"]),
        ("export cd.exr --to order-lut -o cd.exr", 2, ["would overwrite the input", "cd.exr"]),
        ("export compact-disc --to order-lut -o a.exr", 2, ["takes a table", "goniochrome estimate"]),
    ] {
        user.refused(line, code, &says);
    }
}
