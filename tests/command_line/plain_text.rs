//! Tests that names from strangers' files cannot act on a terminal or a document: no output contains control
//! characters.

use std::ffi::OsString;
use std::path::Path;

use exr::meta::MetaData;
use exr::meta::attribute::AttributeValue;
use goniochrome::trace::random::Random;
use goniochrome_cli::table::file;
use goniochrome_cli::table::mirror::MirrorTable;

use crate::user::User;

/// Whether a character acts on a terminal or a document, by Unicode's tables: control characters except line ends and
/// tabs, separators of lines and paragraphs, and characters that change the direction of writing.
fn acts(c: char) -> bool {
    let code = u32::from(c);
    let control = code < 0x20 && c != '\n' && c != '\t' || (0x7f..=0x9f).contains(&code);
    control || matches!(code, 0x61c | 0x200e | 0x200f | 0x2028..=0x202e | 0x2066..=0x2069)
}

fn check(text: &str, of: &str) {
    if let Some(found) = text.find(acts) {
        let from = text[..found].char_indices().rev().nth(40).map_or(0, |(at, _)| at);
        panic!("{of}: {:?}", text[from..].chars().take(80).collect::<String>());
    }
}

/// Names that would clear a screen, change its colour or title, ring its bell, or reverse the text that follows.
fn names(random: &mut Random) -> Vec<String> {
    let acting: Vec<char> = (1..0x3000).filter_map(char::from_u32).filter(|c| acts(*c)).collect();
    let mut any = || acting[(random.next() * acting.len() as f64) as usize];
    let known = ["\u{1b}[31mred", "\u{9b}2Ja", "b\u{1b}]0;title\u{7}", "\u{202e}txt.exe\u{2066}"].map(str::to_owned);
    let random = (0..4).map(|i| format!("x{}{}y{}{i}", any(), any(), any()));
    known.into_iter().chain(random.collect::<Vec<_>>()).collect()
}

/// The name as a basic string of TOML.
fn quoted(name: &str) -> String {
    let escaped: String =
        name.chars().map(|c| if acts(c) { format!("\\u{:04x}", u32::from(c)) } else { c.into() }).collect();
    format!("\"{escaped}\"")
}

/// A user whose runs and files are all searched for characters that act.
struct Watched(User);

impl Watched {
    /// Runs a command that may fail, and checks its output. Returns whether it succeeded.
    fn run(&self, words: &[&str]) -> bool {
        let output = self.0.program().args(words.iter().map(OsString::from)).output().expect("the program starts");
        assert!(matches!(output.status.code(), Some(0..=2)), "{words:?}: {:?}", output.status);
        for bytes in [output.stdout, output.stderr] {
            check(&String::from_utf8(bytes).expect("the program speaks UTF-8"), &format!("{words:?}"));
        }
        output.status.success()
    }

    /// Runs a command that must succeed, and checks the text in the file that it writes.
    fn writes(&self, words: &[&str], file: &str) {
        assert!(self.run(words), "{words:?}");
        let bytes = self.0.read(file);
        let text = match Path::new(file).extension().and_then(|extension| extension.to_str()) {
            Some("svg" | "html" | "gltf" | "json" | "csv" | "glsl") => String::from_utf8(bytes).expect("UTF-8"),
            Some("png") => {
                let reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().expect("a PNG");
                assert!(reader.info().uncompressed_latin1_text.is_empty());
                reader.info().utf8_text.iter().map(|chunk| chunk.get_text().expect("text") + "\n").collect()
            }
            Some("exr") => {
                let meta = MetaData::read_from_buffered(bytes.as_slice(), true).expect("an EXR");
                let attributes = meta.headers.into_iter().flat_map(|header| header.own_attributes.other);
                let text = |(name, value)| match value {
                    // A copy of the scene file, unchanged.
                    AttributeValue::Text(_) if name == "goniochrome.scene_toml" => String::new(),
                    AttributeValue::Text(text) => String::from_utf8(text.bytes().to_vec()).expect("UTF-8") + "\n",
                    _ => String::new(),
                };
                attributes.map(|(name, value)| text((name.to_string(), value))).collect()
            }
            _ => return,
        };
        check(&text, &format!("{file} of {words:?}"));
    }
}

#[test]
fn scenes_of_any_name_give_plain_text_in_every_output() {
    for (i, name) in names(&mut Random::new(1, 7)).iter().enumerate() {
        let user = Watched(User::new());
        let stack = "ambient = 1.0\nlayers = [{ material = \"m\", thickness_nm = 300.0 }]\nsubstrate = 1.5";
        let key = quoted(name);
        // The name is alternately a key in the file and the file's own name.
        let (file, named) = if i % 2 == 0 {
            ("film.toml".into(), format!("name = {key}\n"))
        } else {
            (format!("{name}.toml"), String::new())
        };
        let scene = format!("{named}[stack]\n{stack}\n[materials.m]\nn = 1.33\n[materials.{key}]\nn = 1.4\n");
        user.0.write(&file, &scene);
        let scene = file.as_str();
        for words in [
            &["spectrum", scene, "--theta", "0", "--wavelengths", "500,600"][..],
            &["colour", scene, "--theta", "0,30"],
            &["sampling", scene, "--samples", "4"],
            &["orders", scene, "--wavelengths", "500"],
            &["presets", name],
            &[name],
            &["spectrum", name],
            &["spectrum", scene, "--theta", name],
            &["colour", scene, "--csv", &format!("{name}/a.csv")],
            &["spectrum", scene, name],
        ] {
            user.run(words);
        }
        let short = ["--theta", "0,40", "--wavelengths", "450:650:50"];
        user.writes(&[&["compare", scene, "-o", "c.svg", "--csv", "c.csv"][..], &short].concat(), "c.svg");
        user.writes(&["sampling", scene, "--samples", "4,8", "-o", "s.svg", "--csv", "s.csv"], "s.svg");
        let cell = format!("c{name}.toml");
        user.0.write("square.obj", "v 0 0 0\nv 9 0 0\nv 9 9 0\nv 0 9 0\nusemtl top\nf 1 2 3 4\n");
        let square = "[cell]\nmesh = 'square.obj'\nperiod_nm = [9.0, 9.0]\n[interface.top]\nabove = 1.0\nbelow = 1.5\n";
        user.0.write(&cell, format!("{named}{square}"));
        user.writes(&["scatter", &cell, "--rays", "32", "--bins", "1x1", "--json", "s.json"], "s.json");
        user.writes(&["export", scene, "--to", "gltf", "-o", "f.gltf"], "f.gltf");
        for lut in ["l.exr", "l.png"] {
            let words = [
                "export",
                scene,
                "--to",
                "lut",
                "--width",
                "4",
                "--vary",
                "1=100:200:2",
                "--shader",
                "l.glsl",
                "-o",
                lut,
            ];
            user.writes(&words, lut);
        }
        user.writes(&["estimate", scene, "--angles", "4", "--wavelengths", "450:650:50", "-o", "t.exr"], "t.exr");
    }
}

#[test]
fn tables_of_strangers_give_plain_text_in_every_output() {
    for name in names(&mut Random::new(2, 7)) {
        let user = Watched(User::new());
        let keys = ["scene", "model", "illuminant", "colour_space", "scene_toml", "note"];
        let table = MirrorTable {
            theta_deg: vec![0.0, 45.0, 90.0],
            wavelength_nm: vec![450.0, 550.0, 650.0],
            reflectance_s: vec![0.5; 9],
            reflectance_p: vec![0.4; 9],
            rgb: vec![[0.4, 0.5, 0.6]; 3],
            metadata: keys.map(|key| (key, name.clone())).into_iter().collect(),
            ..MirrorTable::default()
        };
        let bytes = file::encode(&table.into(), 1).unwrap();
        let file = format!("t{name}.exr");
        user.0.write(&file, &bytes);
        let table = file.as_str();
        for kind in ["disc", "spectrum", "map", "chromaticity"] {
            user.writes(&["plot", table, "--kind", kind, "-o", "p.svg"], "p.svg");
        }
        user.writes(&["plot", table, "-o", "p.png"], "p.png");
        user.writes(&["view", table, "-o", "v.html"], "v.html");
        user.writes(&["render", table, "-o", "r.png", "--size", "8x8", "--samples", "1"], "r.png");
        user.writes(&["export", table, "--to", "lut", "--width", "4", "-o", "l.exr"], "l.exr");
        user.writes(&["export", table, "--to", "lut", "--width", "4", "-o", "l.png"], "l.png");
        user.writes(&["export", table, "--to", "blob", "-o", "b.gonio"], "b.gonio");
        user.run(&["export", table, "--to", "gltf", "-o", "f.gltf"]);
        user.run(&["export", table, "--to", "bsdf", "-o", "f.bsdf"]);
        user.run(&["plot", table, "--kind", "lobes", "-o", "p.svg"]);
        // Invalid values of a kind, an angle and an attribute's name.
        for (is, becomes) in
            [(&b"mirror"[..], &b"\x1b[31mx"[..]), (b"45", b"\x1b["), (b"goniochrome.kind", b"goniochrome.k\x1b[m")]
        {
            let mut damaged = bytes.clone();
            for at in 0..damaged.len() - is.len() {
                if &damaged[at..at + is.len()] == is {
                    damaged[at..at + is.len()].copy_from_slice(becomes);
                }
            }
            user.0.write("damaged.exr", damaged);
            user.run(&["plot", "damaged.exr", "-o", "p.svg"]);
        }
    }
}

#[test]
fn whatever_is_wrong_with_a_name_is_said_in_plain_text() {
    for name in names(&mut Random::new(3, 7)) {
        let user = Watched(User::new());
        let key = quoted(&name);
        let stack = |ambient: &str| format!("[stack]\nambient = {ambient}\nlayers = []\nsubstrate = 1.5\n");
        let cell = |mesh: &str| format!("[cell]\nmesh = {mesh}\nperiod_nm = [9.0, 9.0]\n");
        let top = "[interface.top]\nabove = 1.0\nbelow = 1.5\n";
        let square = "v 0 0 0\nv 9 0 0\nv 9 9 0\nv 0 9 0\n";
        user.0.write("named.obj", format!("{square}usemtl {name}\nf 1 2 3 4\n"));
        user.0.write("words.obj", format!("{square}v 1 {name} 2\nf 1 2 {name}\n"));
        user.0.write(&format!("{name}.obj"), format!("{square}usemtl top\nf 1 2 3\n"));
        user.0.write(
            "type.yml",
            format!("DATA:\n  - type: \"{}\"\n    data: |\n        0.5 1.5\n", key.trim_matches('"')),
        );
        user.0.write("raw.yml", format!("DATA:\n  - type: {name}\n"));
        user.0.write(
            "data.yml",
            format!("DATA:\n  - type: tabulated n\n    data: |\n        0.5 {name}\n        0.6 1.5\n"),
        );
        let material = |file: &str| format!("{}[materials.x]\nfile = {file}\n", stack("'x'"));
        let scenes = [
            stack(&key),
            format!("{}[materials.{key}]\nn = {key}\n", stack("1.0")),
            format!("{}[materials.{key}]\n{key} = 1\n", stack("1.0")),
            format!("{}{key} = 1\n", stack("1.0")),
            format!("{key} = 1\n{}", stack("1.0")),
            format!("{name}\n{}", stack("1.0")),
            format!("# {name}\nextrapolate = {key}\n{}", stack("1.0")),
            format!("{}[materials.{key}]\nn = 1.5\n[materials.x]\nn = 1.6\n", stack(&quoted(&format!("{name}2")))),
            material(&key),
            material("'type.yml'"),
            material("'raw.yml'"),
            material("'data.yml'"),
            format!("{}{top}", cell(&key)),
            format!("{}{top}", cell("'named.obj'")),
            format!("{}[interface.{}]\nabove = 1.0\nbelow = 1.5\n", cell("'named.obj'"), quoted(&format!("{name}2"))),
            format!("{}{top}", cell("'words.obj'")),
            format!("{}{top}", cell(&quoted(&format!("{name}.obj")))),
            format!("[cell]\nperiod_nm = [9.0, 9.0]\nsurface = {{ kind = {key} }}\n{top}"),
        ];
        for scene in scenes {
            user.0.write("s.toml", &scene);
            user.run(&["spectrum", "s.toml", "--theta", "0", "--wavelengths", "550"]);
            user.run(&["scatter", "s.toml", "--rays", "32", "--bins", "1x1"]);
        }
        user.0.write(&format!("{name}.hdr"), format!("#?RADIANCE\n{name}\n"));
        user.run(&["estimate", "paper-fig4", "--angles", "4", "--wavelengths", "450,550", "-o", "t.exr"]);
        let mesh = format!("{name}.obj");
        let light = format!("{name}.hdr");
        user.run(&["render", "t.exr", "-o", "r.png", "--size", "4x4", "--samples", "1", "--mesh", &mesh]);
        user.run(&["render", "t.exr", "-o", "r.png", "--size", "4x4", "--samples", "1", "--env", &light]);
    }
}
