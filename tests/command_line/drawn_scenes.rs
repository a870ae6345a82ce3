//! Tests of `plot`, `render` and `view` on scenes: they draw the table that `estimate` makes by default.

use crate::user::User;

const FILM: &str = "[stack]\nambient = 1.0\nlayers = [{ material = 1.33, thickness_nm = 420.0 }]\nsubstrate = 1.0\n";

#[test]
fn a_planar_scene_is_drawn_as_its_table_is() {
    let user = User::with(&[("film.toml", FILM)]);
    user.ok("estimate film.toml -o t.exr -q");
    for kind in ["disc", "spectrum"] {
        user.ok(&format!("plot t.exr --kind {kind} -o a.svg"));
        user.ok(&format!("plot film.toml --kind {kind} -o b.svg -q"));
        assert!(user.read("a.svg") == user.read("b.svg"), "{kind}");
    }
    user.ok("view t.exr -o a.html");
    user.ok("view film.toml -o b.html -q");
    assert!(user.read("a.html") == user.read("b.html"));
    user.ok("render t.exr -o a.exr --size 32 --samples 1");
    let said = user.ok("render film.toml -o b.exr --size 32 --samples 1").stderr;
    assert!(user.read("a.exr") == user.read("b.exr"));
    assert!(said.contains("film: 90 angles × 81 wavelengths") && said.contains("`goniochrome estimate`"), "{said}");
    // A table's file may have any name.
    std::fs::rename(user.at("t.exr"), user.at("table")).unwrap();
    user.ok("plot table --kind disc -o c.svg");
    user.ok("plot film.toml --kind disc -o b.svg -q");
    assert!(user.read("c.svg") == user.read("b.svg"));
}

#[test]
fn presets_are_drawn_by_name_and_leave_no_other_file() {
    let user = User::new();
    user.ok("plot soap-bubble -o bubble.png -q");
    let said = user.ok("plot beetle-pits --kind lobes -o pits.svg").stderr;
    assert!(said.contains("beetle-pits: ") && said.contains(" incident directions × "), "{said}");
    let mut names: Vec<_> = std::fs::read_dir(user.at(".")).unwrap().map(|e| e.unwrap().file_name()).collect();
    names.sort();
    assert_eq!(names, ["bubble.png", "pits.svg"]);
}

#[test]
fn what_is_neither_table_nor_scene_is_refused_with_the_remedy() {
    let user = User::with(&[("film.toml", FILM), ("words", "nothing of use")]);
    user.refused("plot soap-bublle -o a.png", 2, &["no file and no preset", "soap-bubble"]);
    user.refused("view nowhere.toml -o a.html", 1, &["nowhere.toml", "check the path"]);
    user.refused("render words -o a.png", 1, &["words:1"]);
    std::fs::hard_link(user.at("film.toml"), user.at("film.html")).unwrap();
    user.refused("view film.toml -o film.html", 2, &["would overwrite the input"]);
}

#[test]
fn colours_out_of_gamut_are_told_with_their_share() {
    // A lossless film in air reflects neither more than white nor colours that sRGB lacks.
    let user = User::with(&[("film.toml", FILM)]);
    user.ok("estimate film.toml -o film.exr -q");
    user.ok("estimate jewel-beetle -o beetle.exr -q");
    assert_eq!(user.ok("plot film.exr -o a.png --theta 0 --kind spectrum").stderr, "");
    let said = user.ok("plot beetle.exr -o a.png").stderr;
    let told = |said: &str| {
        said.starts_with("a.png: of the colours shown, ") && said.contains(" % are more saturated than sRGB")
    };
    assert!(told(&said) && said.lines().count() == 1, "{said}");
    assert_eq!(user.ok("plot beetle.exr -o a.png -q").stderr, "");
    let render = "render beetle.exr -o a.png --size 32 --samples 1";
    assert!(told(&user.ok(render).stderr));
    assert_eq!(user.ok(&format!("{render} -q")).stderr, "");
    let bright = user.ok(&format!("{render} --exposure 4")).stderr;
    assert!(bright.contains("brighter than white"), "{bright}");
    // Scene-linear files keep all colours.
    assert_eq!(user.ok("render beetle.exr -o a.exr --size 32 --samples 1").stderr, "");
}
