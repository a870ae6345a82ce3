//! Tests of outputs that cannot be written, or must not be.

use crate::user::User;

/// A cell that reads three files. Copies of its scene have names that `estimate` and `plot` accept as outputs.
fn cell() -> User {
    let scene = "[cell]\nmesh = \"film.obj\"\nperiod_nm = [10, 10]\n[interface.top]\nabove = 1.0\nbelow = \"glass\"\n\
                 [materials.glass]\nfile = \"glass.yml\"\n";
    User::with(&[
        ("film.toml", scene),
        ("film.exr", scene),
        ("film.png", scene),
        ("film.obj", "v 0 0 0\nv 10 0 0\nv 10 10 0\nv 0 10 0\nusemtl top\nf 1 2 3 4\n"),
        ("glass.yml", "DATA:\n  - type: formula 5\n    wavelength_range: 0.3 0.9\n    coefficients: 1.5\n"),
    ])
}

#[test]
fn inputs_are_never_overwritten() {
    let user = cell();
    user.ok("spectrum film.toml --csv film.csv");
    for input in ["film.toml", "film.obj", "glass.yml", "./film.obj"] {
        for command in ["spectrum", "colour", "compare", "sampling"] {
            let line = format!("{command} film.toml --csv {input}");
            user.refused(&line, 2, &["would overwrite the input", input, "choose another output"]);
        }
    }
    user.refused("estimate film.exr -o film.exr", 2, &["would overwrite the input", "film.exr"]);
    user.refused("compare film.png -o film.png", 2, &["would overwrite the input", "film.png"]);
    user.refused("sampling film.png -o film.png", 2, &["would overwrite the input", "film.png"]);
}

#[cfg(unix)]
#[test]
fn inputs_are_recognised_behind_links() {
    let user = cell();
    for input in ["film.toml", "film.obj", "glass.yml"] {
        std::os::unix::fs::symlink(input, user.at("soft.exr")).unwrap();
        std::fs::hard_link(user.at(input), user.at("hard.exr")).unwrap();
        for link in ["soft.exr", "hard.exr"] {
            user.refused(&format!("spectrum film.toml --csv {link}"), 2, &["would overwrite the input", link]);
            user.refused(&format!("estimate film.toml -o {link}"), 2, &["would overwrite the input", link]);
            std::fs::remove_file(user.at(link)).unwrap();
        }
    }
    // The other way round: a link is read, its file written.
    std::os::unix::fs::symlink("film.toml", user.at("link")).unwrap();
    user.refused("spectrum link --csv film.toml", 2, &["would overwrite the input"]);
}

#[test]
fn a_table_is_not_overwritten_by_its_picture() {
    let user = User::new();
    user.ok("estimate paper-fig3 -o t.exr --angles 4 --wavelengths 400:700:100 --quiet");
    std::fs::copy(user.at("t.exr"), user.at("t.png")).unwrap();
    user.refused("plot t.png -o t.png", 2, &["would overwrite the input", "t.png"]);
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink("t.exr", user.at("link.svg")).unwrap();
        user.refused("plot t.exr -o link.svg", 2, &["would overwrite the input", "t.exr"]);
    }
}

#[test]
fn a_missing_folder_is_named() {
    let user = cell();
    user.ok("estimate paper-fig3 -o t.exr --angles 4 --wavelengths 400:700:100 --quiet");
    for line in [
        "spectrum film.toml --csv nowhere/a.csv",
        "colour film.toml --csv nowhere/a.csv",
        "compare film.toml --csv nowhere/a.csv",
        "compare film.toml -o nowhere/a.png",
        "sampling film.toml -o nowhere/a.svg",
        "estimate film.toml -o nowhere/a.exr",
        "plot t.exr -o nowhere/a.png",
    ] {
        user.refused(line, 1, &["folder nowhere does not exist", "create it"]);
    }
    std::fs::create_dir_all(user.at("there.exr")).unwrap();
    user.refused("estimate film.toml -o there.exr", 1, &["there.exr is a folder", "name a file in it"]);
    user.refused("spectrum film.toml --csv there.exr", 1, &["there.exr is a folder", "name a file in it"]);
    user.refused("figures -o film.toml", 1, &["film.toml", "choose another -o"]);
}

#[test]
fn one_file_does_not_take_two_outputs() {
    let user = User::new();
    for csv in ["a.png", "./a.png"] {
        for command in ["compare", "sampling"] {
            user.refused(&format!("{command} paper-fig3 -o a.png --csv {csv}"), 2, &["one file for two outputs"]);
        }
    }
}
