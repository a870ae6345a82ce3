//! Tests of `export`: the files of each format, and refusals.

use crate::user::User;

#[test]
fn every_format_is_written_from_a_mirror_like_table() {
    let user = User::new();
    user.ok("estimate paper-fig4 -o t.exr --angles 16 --wavelengths 400:700:50 --quiet");
    user.ok("export t.exr --to merl --roughness 0.3 -o t.binary --quiet");
    assert_eq!(user.read("t.binary").len(), 34_992_012);
    user.ok("export t.exr --to bsdf --roughness 0.3 -o t.bsdf --quiet");
    assert!(user.read("t.bsdf").starts_with(b"tensor_file\0\x01\0\x0a\0\0\0"));
    user.ok("export t.exr --to bsdf --rgb --roughness 0.3 -o rgb.bsdf --quiet");
    assert!(user.read("rgb.bsdf").starts_with(b"tensor_file\0\x01\0\x09\0\0\0"));
    user.ok("export t.exr --to lut --shader t.wgsl -o lut.exr --quiet");
    assert!(String::from_utf8(user.read("t.wgsl")).unwrap().contains("fn goniochrome_reflectance("));
    let said = user.ok("export soap-bubble --to lut --vary 1=100:300:3 --width 8 -o vary.exr").stderr;
    assert!(said.contains("first row 100 nm, last row 300 nm") && said.contains("--origin bottom"), "{said}");
    let said = user.ok("export soap-bubble --to lut --vary 1=100:300:3 --width 8 --origin bottom -o over.exr").stderr;
    assert!(said.contains("first row 300 nm, last row 100 nm") && !said.contains("--origin"), "{said}");
    user.ok("export t.exr --to lut --width 8 -o lut.png --quiet");
    // The signature, then IHDR: 8 × 1 texels of 16 bits, RGB.
    assert!(user.read("lut.png").starts_with(b"\x89PNG\r\n\x1a\n\0\0\0\x0dIHDR\0\0\0\x08\0\0\0\x01\x10\x02"));
}

#[test]
fn what_a_format_cannot_hold_is_refused_with_the_remedy() {
    let user = User::new();
    user.ok("estimate paper-fig4 -o t.exr --angles 4 --wavelengths 400,550 --quiet");
    for (line, says) in [
        ("export t.exr --to merl -o a.binary", ["--roughness is missing", "GGX"]),
        ("export t.exr --to bsdf -o a.bsdf", ["--roughness is missing", "GGX"]),
        ("export t.exr --to bsdf --roughness 0 -o a.bsdf", ["--roughness", "(0, 1]"]),
        ("export t.exr --to bsdf --roughness -1 -o a.bsdf", ["--roughness", "(0, 1]"]),
        ("export t.exr --to bsdf --roughness 1.5 -o a.bsdf", ["--roughness", "(0, 1]"]),
        ("export t.exr --to merl --roughness NaN -o a.binary", ["--roughness", "(0, 1]"]),
        ("export t.exr --to lut --roughness 2 -o a.exr", ["--roughness", "(0, 1]"]),
        ("export t.exr --to merl --rgb --roughness 0.5 -o a.binary", ["--rgb is for", "bsdf"]),
        ("export t.exr --to lut --vary 1=1:2:2 -o a.exr", ["--vary", "needs a scene"]),
        ("export soap-bubble --to lut --origin bottom -o a.exr", ["--origin", "--vary"]),
        ("export t.exr --to merl --origin top --roughness 0.5 -o a.binary", ["--origin is for", "lut"]),
        ("export soap-bubble --to lut --vary 2=1:2:2 -o a.exr", ["has 1 layers", "1 is the top"]),
        ("export soap-bubble --to lut --vary 1=2:1:2 -o a.exr", ["--vary", "FROM < TO"]),
        ("export soap-bubble --to merl --roughness 0.5 -o a.binary", ["takes a table", "goniochrome estimate"]),
        ("export t.exr --to lut -o a.bsdf", ["writes .exr or .png", "name it so"]),
        ("export t.exr --to gltf -o a.json", ["writes .gltf", "name it so"]),
        (
            "export t.exr --to order-lut --roughness 0.5 -o a.exr",
            ["--roughness is for", "leave it out of --to order-lut"],
        ),
        ("export t.exr --to lut -o a.exr --shader a.txt", [".glsl", ".wgsl"]),
        ("export t.exr --to lut -o t.exr", ["would overwrite the input", "t.exr"]),
        ("export t.exr --to voxels -o a.exr", ["voxels", "possible values"]),
    ] {
        user.refused(line, 2, &says);
    }
}

#[test]
fn an_anisotropic_table_is_refused_by_merl_and_an_isotropic_one_needs_no_roughness() {
    let user = User::new();
    let options = "--wavelengths 450,550,650 --half-vectors 5x8 --rays 32 --quiet";
    user.ok(&format!("estimate bumpy-glass -o aniso.exr --incident 2x4 {options}"));
    user.ok(&format!("estimate bumpy-glass -o iso.exr --incident 2x1 {options}"));
    user.refused("export aniso.exr --to merl -o a.binary", 1, &["anisotropic", "--incident 2x1"]);
    user.refused("export aniso.exr --to lut -o a.exr", 1, &["scatters", "export a bsdf"]);
    user.refused("export iso.exr --to merl --roughness 0.5 -o a.binary", 2, &["leave it out"]);
    user.refused("export iso.exr --to bsdf --spread 2 -o a.bsdf", 2, &["--spread is for", "leave it out"]);
    let said = user.ok("export iso.exr --to merl -o iso.binary").stderr;
    assert!(said.contains("halfway between its bins") && said.contains("root mean square"), "{said}");
    assert_eq!(user.read("iso.binary").len(), 34_992_012);
}

#[test]
fn a_bsdf_of_a_scatter_table_is_as_small_as_the_table_and_none_of_its_light_is_negative() {
    let user = User::new();
    user.ok("estimate brushed-metal -o t.exr --incident 3x4 --half-vectors 5x8 --wavelengths 400:700:50 --rays 64 -q");
    user.ok("export t.exr --to bsdf -o t.bsdf --quiet");
    user.ok("export t.exr --to bsdf --rgb -o rgb.bsdf --quiet");
    // The green of pits is out of gamut.
    user.ok("estimate beetle-pits -o p.exr --incident 3x4 --half-vectors 5x8 --wavelengths 400:700:50 --rays 64 -q");
    user.ok("export p.exr --to bsdf --rgb --gamut keep -o keep.bsdf --quiet");
    // φ_i repeats its first, the square of 8 steps is 9 × 9, and the warp of lines has 13 × 65 knots.
    const SLICES: usize = 3 * 5;
    let tensors = |channels: usize| 4 * SLICES * (13 * 65 + 81 * (channels + 1));
    // D and σ, two rows of 4096 samples each, and names.
    let rest = 4 * 2 * 2 * 4096..4 * 2 * 2 * 4096 + 1024;
    assert!(rest.contains(&(user.read("t.bsdf").len() - tensors(7))));
    assert!(rest.contains(&(user.read("rgb.bsdf").len() - tensors(3))));
    // The values are the last tensor of a file with RGB.
    let least = |name: &str| {
        let bytes = user.read(name);
        let numbers = bytes[bytes.len() - (4 * SLICES * 81 * 3).next_multiple_of(8)..].as_chunks::<4>().0;
        numbers.iter().map(|number| f32::from_le_bytes(*number)).fold(f32::INFINITY, f32::min)
    };
    user.ok("export p.exr --to bsdf --rgb -o clipped.bsdf --quiet");
    assert_eq!((least("rgb.bsdf"), least("clipped.bsdf")), (0.0, 0.0));
    assert!(least("keep.bsdf") < 0.0);
    user.refused("export t.exr --to bsdf --gamut keep -o a.bsdf", 2, &["--gamut is for", "--rgb"]);
    user.ok("estimate brushed-metal -o odd.exr --incident 3x4 --half-vectors 64x101 --wavelengths 550 --rays 32 -q");
    user.refused("export odd.exr --to bsdf -o a.bsdf", 1, &["share no square", "--half-vectors 51x100"]);
}

#[test]
fn lobes_of_flat_facets_need_a_width() {
    let user = User::new();
    user.ok("estimate silicon-pyramids -o t.exr --incident 3x4 --half-vectors 5x8 --wavelengths 450,550 --rays 64 -q");
    user.refused("export t.exr --to bsdf -o a.bsdf", 2, &["--spread is missing", "flat facets"]);
    user.ok("export t.exr --to bsdf --spread 20 --rgb -o t.bsdf --quiet");
    assert!(user.read("t.bsdf").starts_with(b"tensor_file"));
    let csv = user.ok("lookup t.exr --wi 10,0 --csv -").stdout;
    assert!(csv.contains(",facet 1,450,") && csv.contains(",facet 1,R,"), "{csv}");
    let text = user.ok("lookup t.exr --wi 10,0 --wo 20,180").stdout;
    assert!(text.contains("f in 1/sr") && text.contains("facet 1"), "{text}");
    assert!(user.ok("lookup t.exr --wi 10,0 --wo 20,180 --csv f.csv").stderr.contains("f leaves out exact lobes"));
    let text = user.ok("lookup t.exr --wi 10,0 --wo 20,180 --spread 5").stdout;
    assert!(text.contains("f in 1/sr") && !text.contains("facet 1"), "{text}");
}

#[test]
fn a_table_and_its_scene_give_the_same_gltf() {
    let user = User::new();
    let film = "[stack]\nambient = 'air'\nlayers = [{ material = 1.33, thickness_nm = 250 }]\nsubstrate = 'N-BK7'\n";
    user.write("film.toml", film);
    user.ok("estimate film.toml -o film.exr --angles 16 --wavelengths 400:700:50 --quiet");
    let said = user.ok("export film.exr --to gltf -o film.gltf").stderr;
    assert!(said.contains("from the exact colour at 0 to 85°") && said.contains(" 45°  exact "), "{said}");
    assert_eq!(user.ok("export film.toml --to gltf -o same.gltf --quiet").stderr, "");
    assert_eq!(user.read("film.gltf"), user.read("same.gltf"));
}

#[test]
fn what_gltf_cannot_hold_is_refused_with_the_reason() {
    let film = "[stack]\nambient = 1\nlayers = [{ material = 'x', thickness_nm = 250 }]\nsubstrate = 1.5\n";
    let user = User::with(&[
        ("n.yml", "DATA:\n  - type: formula 5\n    wavelength_range: 0.3 0.9\n    coefficients: 1.33\n"),
        ("file.toml", &format!("{film}[materials.x]\nfile = 'n.yml'\n")),
    ]);
    user.ok("estimate paper-fig4 -o t.exr --angles 4 --wavelengths 400,550 --quiet");
    user.ok("estimate file.toml -o paper.exr --model paper --angles 4 --wavelengths 400,550 --quiet");
    user.ok("estimate file.toml -o file.exr --angles 4 --wavelengths 400,550 --quiet");
    user.ok(
        "estimate bumpy-glass -o bumpy.exr --incident 2x1 --wavelengths 450,550 --half-vectors 5x8 --rays 32 --quiet",
    );
    for (line, says) in [
        ("export t.exr --to gltf -o a.gltf", ["is a single film", "export a lut"]),
        ("export bumpy.exr --to gltf -o a.gltf", ["scatters", "export a bsdf"]),
        ("export bumpy-glass --to gltf -o a.gltf", ["is a plane film", "bumpy-glass"]),
        ("export paper.exr --to gltf -o a.gltf", ["--model paper", "make the table without"]),
        ("export file.exr --to gltf -o a.gltf", ["name files", "export the scene file itself"]),
    ] {
        user.refused(line, 1, &says);
    }
    user.ok("export file.toml --to gltf -o file.gltf --quiet");
}
