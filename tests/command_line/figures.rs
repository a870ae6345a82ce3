//! Tests of `figures`: every figure of the paper, and the page that shows them.

use std::fs;

use crate::user::User;

const FILES: [&str; 12] = [
    "figure-3-teapot.png",
    "figure-3.png",
    "figure-4-teapot.png",
    "figure-4.png",
    "figure-5-studio.png",
    "figure-5-white.png",
    "figure-6-discs.png",
    "figure-6-error.png",
    "figure-7-film.png",
    "figure-7-three-films.png",
    "index.html",
    "presets.png",
];

/// All values of an attribute in a page.
fn values<'a>(html: &'a str, attribute: &str) -> Vec<&'a str> {
    let start = format!(" {attribute}=\"");
    html.split(start.as_str()).skip(1).filter_map(|rest| rest.split('"').next()).collect()
}

#[test]
fn every_figure_is_drawn_and_shown() {
    let user = User::new();
    // The folder is created, with its parent.
    let ran = user.ok("figures -o deep/figures");
    assert_eq!(ran.stdout, "");
    assert_eq!(ran.stderr, "deep/figures/index.html\n");
    let mut found: Vec<String> = fs::read_dir(user.at("deep/figures"))
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    found.sort();
    assert_eq!(found, FILES);
    let pictures: Vec<&str> = FILES.into_iter().filter(|file| file.ends_with(".png")).collect();
    for file in &pictures {
        assert!(user.read(&format!("deep/figures/{file}")).starts_with(b"\x89PNG\r\n\x1a\n"), "{file}");
    }
    let html = String::from_utf8(user.read("deep/figures/index.html")).unwrap();
    let shown = values(&html, "src");
    let mut sorted = shown.clone();
    sorted.sort_unstable();
    assert_eq!(sorted, pictures);
    for link in shown.into_iter().chain(values(&html, "href")) {
        assert!(user.at("deep/figures").join(link).is_file(), "{link} does not exist");
    }
    for heading in ["Figure 3", "Figure 4", "Figure 5", "Figure 6", "Figure 7", "The built-in scenes"] {
        assert!(html.contains(&format!("<h2>{heading}")), "{heading}");
    }
    for broken in ["NaN", "inf ", "0e0"] {
        assert!(!html.contains(broken), "{broken} on the page");
    }
}
