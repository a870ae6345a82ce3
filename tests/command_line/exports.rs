//! `export`: files of the right size, and what is refused.

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
    user.ok("export soap-bubble --to lut --vary 1=100:300:3 --width 8 -o vary.exr --quiet");
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
        ("export t.exr --to lut --roughness 0.5 -o a.exr", ["--roughness is for", "merl and bsdf"]),
        ("export t.exr --to merl --rgb --roughness 0.5 -o a.binary", ["--rgb is for", "bsdf"]),
        ("export t.exr --to lut --vary 1=1:2:2 -o a.exr", ["--vary", "needs a scene"]),
        ("export soap-bubble --to lut --vary 2=1:2:2 -o a.exr", ["has 1 layers", "1 is the top"]),
        ("export soap-bubble --to lut --vary 1=2:1:2 -o a.exr", ["--vary", "FROM < TO"]),
        ("export soap-bubble --to merl --roughness 0.5 -o a.binary", ["takes a table", "goniochrome estimate"]),
        ("export t.exr --to lut -o a.bsdf", ["writes .exr", "name it so"]),
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
    let options = "--wavelengths 450,550,650 --bins 4x8 --rays 32 --quiet";
    user.ok(&format!("estimate bumpy-glass -o aniso.exr --incident 2x4 {options}"));
    user.ok(&format!("estimate bumpy-glass -o iso.exr --incident 2x1 {options}"));
    user.refused("export aniso.exr --to merl -o a.binary", 1, &["anisotropic", "--incident 2x1"]);
    user.refused("export aniso.exr --to lut -o a.exr", 1, &["scatters", "export a bsdf"]);
    user.refused("export iso.exr --to merl --roughness 0.5 -o a.binary", 2, &["leave it out"]);
    user.ok("export iso.exr --to bsdf -o iso.bsdf --quiet");
    const MOST_BYTES: usize = 70 << 20; // 64 MiB of samples, one more node of θ_i, and what is not samples
    assert!(user.read("iso.bsdf").len() < MOST_BYTES);
    user.ok("export iso.exr --to merl -o iso.binary --quiet");
    assert_eq!(user.read("iso.binary").len(), 34_992_012);
}
