//! Tests of the form of texts: lines of comments and Markdown have at most 120 characters, doc comments stand alone,
//! and source files have at most 500 lines.

use std::fs;
use std::path::{Path, PathBuf};

/// Largest number of characters in a line of a comment or of Markdown.
const MAX_WIDTH: usize = 120;

/// Largest number of lines in a Rust source file.
const MAX_LINES: usize = 500;

/// Openings of doc comments that cannot be understood without their neighbour, which rustdoc's lists do not show.
const LEANING: [&str; 4] = ["The same", "Of ", "For ", "With "];

/// Folders of files that are generated, downloaded or not prose.
const SKIPPED_FOLDERS: [&str; 8] =
    ["target", "node_modules", "data", "seeds", "corpus", "artifacts", "__pycache__", ".git"];

#[derive(Clone, Copy, Debug, PartialEq)]
enum Language {
    /// Comments are `// …` and `/* … */`.
    Slashes,
    /// Comments are `# …`, and in Python also texts between three quotation marks.
    Hashes,
    Markdown,
}

fn language(file: &Path, text: &str) -> Option<Language> {
    match file.extension().map(|extension| extension.to_str().unwrap_or_default()) {
        Some("rs" | "c" | "h" | "cpp" | "glsl" | "hlsl" | "wgsl" | "frag" | "vert" | "js" | "mjs" | "css") => {
            Some(Language::Slashes)
        }
        Some("py" | "sh" | "toml" | "yml") => Some(Language::Hashes),
        Some("md") => Some(Language::Markdown),
        None if text.starts_with("#!") => Some(Language::Hashes),
        _ => None,
    }
}

/// The lines that are prose or hold a comment, with their numbers.
fn prose_lines(text: &str, language: Language) -> impl Iterator<Item = (usize, &str)> {
    let mut in_block = false;
    let lines = text.lines().enumerate().filter(move |(_, line)| {
        let start = line.trim_start();
        let was_in_block = in_block;
        match language {
            Language::Markdown => true,
            Language::Slashes => {
                if let Some((_, rest)) = line.split_once("*/").filter(|_| in_block) {
                    in_block = rest.contains("/*") && !rest.contains("*/");
                } else if start.starts_with("/*") || line.contains(" /*") {
                    in_block = !line.contains("*/");
                }
                was_in_block || start.starts_with("//") || start.starts_with("/*") || line.contains(" // ")
            }
            Language::Hashes => {
                in_block ^= line.matches("\"\"\"").count() % 2 == 1;
                was_in_block || start.starts_with('#') || start.starts_with("\"\"\"") || line.contains(" # ")
            }
        }
    });
    lines.map(|(number, line)| (number + 1, line))
}

/// Whether a line cannot be broken: a row of a table, or a single word behind its marks.
fn is_unbreakable(line: &str) -> bool {
    let text = line.trim_start_matches([' ', '/', '!', '#', '*', '-', '>']).trim_end();
    text.starts_with('|') || !text.contains(' ')
}

fn wide_lines(text: &str, language: Language) -> Vec<String> {
    let wide = prose_lines(text, language).filter_map(|(number, line)| {
        let width = line.chars().count();
        (width > MAX_WIDTH && !is_unbreakable(line)).then(|| format!("{number}: {width} characters"))
    });
    wide.collect()
}

fn leaning_comments(source: &str) -> Vec<String> {
    let doc = |line: &str| {
        let line = line.trim_start();
        ["///", "//!"].into_iter().find(|mark| line.starts_with(mark) && !line.starts_with("////"))
    };
    let mut before = None;
    let mut found = Vec::new();
    for (number, line) in source.lines().enumerate() {
        let mark = doc(line);
        let text = line.trim_start().trim_start_matches(['/', '!', ' ']);
        if mark.is_some() && mark != before && LEANING.iter().any(|opening| text.starts_with(opening)) {
            found.push(format!("{}: a doc comment begins \"{text}\"", number + 1));
        }
        before = mark;
    }
    found
}

/// All faults of a file, each as `LINE: WHAT`.
fn faults(file: &Path, text: &str) -> Vec<String> {
    let mut found = language(file, text).map_or_else(Vec::new, |language| wide_lines(text, language));
    if file.extension().is_some_and(|extension| extension == "rs") {
        found.extend(leaning_comments(text));
        let lines = text.lines().count();
        if lines > MAX_LINES {
            found.push(format!("{lines}: more than {MAX_LINES} lines"));
        }
    }
    found
}

fn files(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).expect("a folder of the workspace can be read") {
        let path = entry.expect("an entry can be read").path();
        if !path.is_dir() {
            found.push(path);
        } else if !SKIPPED_FOLDERS.iter().any(|skipped| path.ends_with(skipped)) {
            found.extend(files(&path));
        }
    }
    found.sort();
    found
}

#[test]
fn what_people_read_is_in_form() {
    let workspace = Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("the workspace holds this package");
    let (mut read, mut found) = (Vec::new(), Vec::new());
    for file in files(workspace) {
        // Pictures and fonts are not text.
        let Ok(text) = fs::read_to_string(&file) else { continue };
        let name = file.strip_prefix(workspace).expect("a file of the workspace");
        found.extend(faults(name, &text).into_iter().map(|fault| format!("{}:{fault}", name.display())));
        read.push(name.to_path_buf());
    }
    for known in ["README.md", "core/src/lib.rs", "core/capi/include/goniochrome.h", ".ci/run"] {
        assert!(read.iter().any(|name| name == Path::new(known)), "{known} is not read");
    }
    assert!(found.is_empty(), "{} places to mend:\n{}", found.len(), found.join("\n"));
}

fn wide(length: usize) -> String {
    "word ".repeat(length / 5)
}

#[test]
fn wide_comments_are_found_in_every_language() {
    let (long, short) = (wide(125), wide(100));
    let slashes = [
        format!("/// {long}\n// {short}\nlet x = \"{long}\";\nlet y = 1; // {long}"),
        format!("/* one\n {long}\n*/ let z = \"{long}\";\n/* {long}*/\n{long}"),
    ]
    .join("\n");
    let expected =
        ["1: 129 characters", "4: 139 characters", "6: 126 characters", "7: 139 characters", "8: 130 characters"];
    // A line that ends a comment counts as one.
    assert_eq!(faults(Path::new("a.rs"), &slashes), expected);

    let hashes = format!("#!/bin/sh\n# {long}\necho {long}\n");
    assert_eq!(faults(Path::new("run"), &hashes), ["2: 127 characters"]);
    let python = format!("\"\"\"One.\n\n{long}\n\"\"\"\nx = '{long}'\n");
    assert_eq!(faults(Path::new("a.py"), &python), ["3: 125 characters"]);
    assert_eq!(faults(Path::new("a.md"), &format!("{short}\n{long}\n")), ["2: 125 characters"]);
    assert_eq!(faults(Path::new("a.png"), &long), [""; 0]);
}

#[test]
fn lines_that_cannot_be_broken_may_be_wide() {
    let (long, word) = (wide(200), "x".repeat(130));
    let text = format!("| {long} |\n- <https://{word}>\n[a link](https://{word})\n");
    assert_eq!(faults(Path::new("a.md"), &text), ["3: 148 characters"]);
    assert_eq!(faults(Path::new("a.rs"), &format!("//! | {long} |\n// https://{word}\n")), [""; 0]);
}

#[test]
fn doc_comments_that_lean_on_a_neighbour_are_found() {
    let source = [
        "//! Title.\n//! For all.\n/// The same of b.\nfn a() {}\n\n    /// With c.\n    /// Of d.\n",
        "/// A word.\n///\n/// With e.\n// Of f.\n",
    ]
    .concat();
    let expected = ["3: a doc comment begins \"The same of b.\"", "6: a doc comment begins \"With c.\""];
    assert_eq!(faults(Path::new("a.rs"), &source), expected);
}

#[test]
fn long_source_files_are_found() {
    assert_eq!(faults(Path::new("a.rs"), &"\n".repeat(MAX_LINES)), [""; 0]);
    assert_eq!(faults(Path::new("a.rs"), &"\n".repeat(MAX_LINES + 1)), ["501: more than 500 lines"]);
}
