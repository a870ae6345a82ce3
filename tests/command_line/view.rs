//! Tests of `view`: pages of tables of all kinds, and refusals. `tests/browser/run` tests the page itself.

use goniochrome_cli::table::file;

use crate::discs::compact_disc;
use crate::user::User;

/// Largest size of the page of a 2D table, which fits into an e-mail.
const MAX_BYTES: usize = 2_000_000;

fn text(user: &User, name: &str) -> String {
    String::from_utf8(user.read(name)).expect("text")
}

#[test]
fn a_default_table_becomes_one_small_page() {
    let user = User::new();
    user.ok("estimate jewel-beetle -o t.exr --quiet");
    let ran = user.ok("view t.exr -o view.html");
    assert_eq!((ran.stdout.as_str(), ran.stderr.as_str()), ("", ""));
    let page = text(&user, "view.html");
    assert!(page.starts_with("<!DOCTYPE html>") && page.trim_end().ends_with("</html>"));
    assert!(page.contains("<title>jewel-beetle · goniochrome</title>"));
    assert!(page.len() <= MAX_BYTES, "{} bytes", page.len());
    // Equal tables give equal pages.
    user.ok("view t.exr -o again.htm");
    assert!(user.read("again.htm") == user.read("view.html"));
}

#[test]
fn a_table_of_a_cell_becomes_a_page() {
    let user = User::new();
    user.ok("estimate bumpy-glass -o t.exr --incident 2x2 --half-vectors 4x8 --rays 32 --wavelengths 450:650:50 -q");
    user.ok("view t.exr -o view.html");
    assert!(text(&user, "view.html").contains("\"kind\":\"scatter\""));
}

#[test]
fn a_table_of_orders_becomes_a_page_with_a_width() {
    let user = User::new();
    file::write(&user.at("cd.exr"), &compact_disc().into(), 1).unwrap();
    user.ok("view cd.exr -o view.html");
    let page = text(&user, "view.html");
    assert!(page.contains("\"kind\":\"orders\"") && page.contains("\"spread\":null") && page.len() <= MAX_BYTES);
    user.ok("view cd.exr -o soft.html --spread 1.5");
    assert!(text(&user, "soft.html").contains("\"spread\":{\"concentration\":"));
    user.refused("view cd.exr -o view.html --spread 31", 2, &["--spread 31", "from 0.25 to 30 degrees"]);
    user.ok("estimate paper-fig4 -o t.exr --angles 4 --wavelengths 400:700:100 --quiet");
    user.refused("view t.exr -o view.html --spread 1", 2, &["--spread", "no diffraction orders"]);
}

#[test]
fn a_page_opens_with_the_finish_of_its_table_or_of_the_options() {
    let scene = "[stack]\nambient = \"air\"\nsubstrate = \"Au\"\n\n[finish]\nroughness = [0.125, 0.5]\n";
    let user = User::with(&[("satin.toml", scene)]);
    user.ok("estimate satin.toml -o t.exr --angles 4 --wavelengths 400:700:100 -q");
    let finish = |options: &str| {
        let ran = user.ok(&format!("view t.exr -o view.html {options}"));
        assert_eq!(ran.stderr, "", "{options}");
        let page = text(&user, "view.html");
        let start = page.find("\"finish\":{").expect("the page has a finish");
        page[start..].split_inclusive('}').next().expect("the finish ends").to_owned()
    };
    let expected = |[beckmann, compensated]: [bool; 2], roughness: &str| {
        let kind = format!("\"beckmann\":{beckmann},\"compensated\":{compensated}");
        format!("\"finish\":{{{kind},\"roughness\":{roughness},\"separable\":false}}")
    };
    assert_eq!(finish(""), expected([false; 2], "[0.125,0.5]"));
    assert_eq!(finish("--distribution beckmann"), expected([true, false], "[0.125,0.5]"));
    assert_eq!(finish("--energy-compensation"), expected([false, true], "[0.125,0.5]"));
    assert_eq!(finish("--roughness 0.25"), expected([false; 2], "[0.25,0.25]"));
    assert_eq!(finish("--roughness 0"), expected([false; 2], "[0.0,0.0]"));
    user.refused("view t.exr -o view.html --roughness 2", 2, &["--roughness", "(0, 1]"]);
    file::write(&user.at("cd.exr"), &compact_disc().into(), 1).unwrap();
    user.refused("view cd.exr -o view.html --roughness 0.2", 2, &["--roughness", "mirror-like"]);
}

#[test]
fn what_gives_no_page_is_refused() {
    let user = User::with(&[("text.exr", "no table")]);
    user.ok("estimate paper-fig4 -o t.exr --angles 4 --wavelengths 400:700:100 --quiet");
    let good = user.read("t.exr");
    user.write("cut.exr", &good[..good.len() / 2]);
    user.refused("view t.exr -o view.png", 2, &["view.png", ".html"]);
    user.refused("view t.exr -o view", 2, &["view", ".html"]);
    user.refused("view t.exr", 2, &["--output <FILE>"]);
    user.refused("view t.exr -o nowhere/view.html", 1, &["folder nowhere does not exist", "create it"]);
    user.refused("view missing.exr -o view.html", 1, &["cannot read missing.exr", "goniochrome estimate"]);
    user.refused("view text.exr -o view.html", 1, &["text.exr", "not a readable EXR file"]);
    user.refused("view cut.exr -o view.html", 1, &["cut.exr", "not a readable EXR file"]);
    std::fs::copy(user.at("t.exr"), user.at("t.html")).unwrap();
    user.refused("view t.html -o t.html", 2, &["would overwrite the input", "t.html"]);
    std::fs::create_dir(user.at("there.html")).unwrap();
    user.refused("view t.exr -o there.html", 1, &["there.html is a folder", "name a file in it"]);
}
