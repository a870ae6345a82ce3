use super::*;

fn read(text: &str) -> Result<Scene> {
    parse("s.toml", text, "s", Some(Path::new("/nonexistent")), FinishKey::Read)
}

fn refusal(text: &str) -> String {
    let error = read(text).unwrap_err();
    assert_eq!(error.exit_code(), 1);
    error.to_string()
}

/// A stack with the given layers, which start at line 3, column 10.
fn stack(layers: &str) -> String {
    format!("[stack]\nambient = 1\nlayers = {layers}\nsubstrate = 1.5\n")
}

fn cell(rest: &str) -> String {
    format!("[cell]\nmesh = \"m.obj\"\nperiod_nm = [1, 1]\n{rest}")
}

fn layers(scene: &Scene) -> Vec<(&str, f64)> {
    let Shape::Stack { layers, .. } = &scene.shape else { panic!("a stack") };
    layers.iter().map(|l| (scene.media[usize::from(l.medium)].name.as_str(), l.thickness_nm)).collect()
}

#[test]
fn repetitions_are_written_out_and_media_listed_once() {
    let group = "[ { material = [1.5, 0.1], thickness_nm = 0x10 }, { repeat = 2, layers = [ { material = \"SIO2\", thickness_nm = 0 } ] } ]";
    let scene =
        read(&stack(&format!("[ {{ repeat = 2, layers = {group} }}, {{ repeat = 0, layers = {group} }} ]"))).unwrap();
    let pair = [("1.5+0.1i", 16.0), ("SiO2", 0.0), ("SiO2", 0.0)];
    assert_eq!(layers(&scene), [pair, pair].concat());
    assert_eq!(scene.media.len(), 4);
    let same = read("[stack]\nambient = \"air\"\nsubstrate = \"AIR\"\n").unwrap();
    assert!(matches!(same.shape, Shape::Stack { ambient: 0, substrate: Below::Medium(0), .. }));
    let mirror =
        read("name = \"m\"\ndescription = \"d\"\nsource = \"s\"\n[stack]\nambient = 1\nsubstrate = \"mirror\"")
            .unwrap();
    assert!(matches!(mirror.shape, Shape::Stack { substrate: Below::Mirror, .. }) && mirror.name == "m");
}

#[test]
fn declared_materials_hide_built_in_ones_and_may_clamp() {
    let text = |clamp: &str| {
        format!(
            "{clamp}\n[stack]\nambient = 1\nlayers = [ {{ material = \"tio2\", thickness_nm = 1 }} ]\nsubstrate = \"TiO2-rutile\"\n[materials.TiO2]\nn = 9\n"
        )
    };
    let eta = |scene: &Scene| scene.media[2].medium.borrow().eta(400.0).is_ok();
    let scene = read(&text("")).unwrap();
    assert_eq!(layers(&scene), [("TiO2", 1.0)]);
    assert!((scene.media[1].medium.borrow().eta(500.0).unwrap().re - 9.0).abs() < 1e-12);
    assert!(!eta(&scene) && eta(&read(&text("extrapolate = \"clamp\"")).unwrap()));
    assert_eq!(
        refusal(&text("extrapolate = \"clam\"")),
        "s.toml:1:15: extrapolate: \"clam\" is unknown; write \"clamp\" or \"refuse\""
    );
}

#[test]
fn syntax_and_keys_are_refused_by_place() {
    let message = refusal("[stack]\nambient = = 1\n");
    assert!(message.starts_with("s.toml:2:11: not valid TOML: "), "{message}");
    assert_eq!(
        refusal(&stack("[ { material = 2, thicknes = 1 } ]")),
        "s.toml:3:28: unknown key \"thicknes\" in layer; nearest is \"thickness_nm\" (known: material, thickness_nm, spread_nm, repeat, layers)"
    );
    assert!(refusal("[stak]\n").starts_with("s.toml:1:2: unknown key \"stak\" in the scene; nearest is \"stack\""));
    assert!(
        refusal("[materials.x]\nm = 1\n").starts_with("s.toml:2:1: unknown key \"m\" in [materials.x] (known: n, k,")
    );
    assert_eq!(refusal("name = 3\n"), "s.toml:1:8: name: expected a text in quotes, found 3");
    assert_eq!(refusal("name = \"x\"\n"), "s.toml:1:1: the scene: neither [stack] nor [cell]; add one");
    assert_eq!(
        refusal(&format!("{}{}", stack("[]"), cell(""))),
        "s.toml:5:1: cell: a scene has either [stack] or [cell]; remove one"
    );
    assert_eq!(
        refusal(&format!("{}[interface.x]\nabove = 1\nbelow = 1", stack("[]"))),
        "s.toml:5:2: interface: only a [cell] has interfaces; remove it"
    );
    assert_eq!(
        refusal("[stack]\nambient = 1\n"),
        "s.toml:1:1: [stack]: \"substrate\" is missing; write a number, a pair [n, k], a material or \"mirror\""
    );
}

#[test]
fn layers_are_refused_by_place() {
    let third = |layer: &str| refusal(&stack(&format!("[ {layer} ]")));
    let layer =
        |material: &str, thickness: &str| third(&format!("{{ material = {material}, thickness_nm = {thickness} }}"));
    assert_eq!(layer("2", "-1"), "s.toml:3:43: thickness_nm: -1 is negative; lengths are 0 nm or more");
    assert_eq!(layer("2", "nan"), "s.toml:3:43: thickness_nm: NaN is not a finite number");
    assert_eq!(layer("2", "-inf"), "s.toml:3:43: thickness_nm: -inf is not a finite number");
    assert_eq!(layer("2", "\"1\""), "s.toml:3:43: thickness_nm: expected a number, found the text \"1\"");
    assert_eq!(layer("2", "1e10"), "s.toml:3:43: thickness_nm: 10000000000 is more than 1000000000 nm, a metre");
    assert_eq!(layer("0", "1"), "s.toml:3:25: material: n = 0, k = 0 is not passive (n > 0 and k >= 0 are required)");
    assert_eq!(
        layer("[2, -1]", "1"),
        "s.toml:3:25: material: k = -1 is gain; k must not be negative: for n − ik write +k"
    );
    assert_eq!(layer("inf", "1"), "s.toml:3:25: material: inf is not a finite number");
    assert_eq!(layer("1e7", "1"), "s.toml:3:25: material: n = 10000000, k = 0: more than 1000000");
    assert_eq!(
        layer("[1, 2, 3]", "1"),
        "s.toml:3:25: material: expected a number, a pair [n, k] or the name of a material, found a list of 3"
    );
    assert_eq!(
        layer("\"Sio\"", "1"),
        "s.toml:3:25: material: unknown material \"Sio\"; nearest is \"SiO2\", or declare [materials.Sio]"
    );
    assert_eq!(
        layer("\"mirror\"", "1"),
        "s.toml:3:25: material: a perfect mirror can only be a substrate or lie below an interface"
    );
    assert_eq!(
        third("{ material = 2 }"),
        "s.toml:3:12: layer: \"thickness_nm\" is missing; write thickness_nm = 100.0"
    );
    assert_eq!(third("3"), "s.toml:3:12: layers: expected a table, found 3");
    assert_eq!(
        third("{ material = 2, repeat = 3 }"),
        "s.toml:3:12: layer: either material and thickness_nm, or repeat and layers; not both"
    );
    assert_eq!(third("{ layers = [] }"), "s.toml:3:12: layer: \"repeat\" is missing; write repeat = 10");
    assert_eq!(refusal(&stack("7")), "s.toml:3:10: layers: expected a list, found 7");
    assert_eq!(
        refusal("[stack]\nambient = [1.3, 0.1]\nsubstrate = 1\n"),
        "s.toml:2:11: ambient: light cannot arrive through a medium that absorbs; use k <= 0.001, or make it a layer under a clear ambient"
    );
}

#[test]
fn repetition_is_bounded_before_anything_is_written_out() {
    let repeat = |times: &str, inner: &str| format!("[ {{ repeat = {times}, layers = {inner} }} ]");
    let one = "[ { material = 2, thickness_nm = 1 } ]";
    assert_eq!(layers(&read(&stack(&repeat("10_000", one))).unwrap()).len(), 10_000);
    assert_eq!(
        refusal(&stack(&repeat("101", &repeat("100", one)))),
        "s.toml:3:10: layers: 10100 layers after writing out repeat; at most 10000"
    );
    let towers = |height: usize, inner: &str| (0..height).fold(inner.to_owned(), |inner, _| repeat("10000", &inner));
    assert!(refusal(&stack(&towers(6, one))).ends_with("more than 18446744073709551615 layers; at most 10000"));
    assert!(layers(&read(&stack(&towers(16, "[]"))).unwrap()).is_empty());
    assert!(refusal(&stack(&towers(17, "[]"))).ends_with("layers: repeat within repeat, more than 16 deep"));
    for times in ["-1", "10_001", "1.5", "99999999999999999999999"] {
        let message = refusal(&stack(&repeat(times, one)));
        assert!(message.starts_with("s.toml:3:23: repeat: expected an integer from 0 to 10000, found"), "{message}");
    }
}

/// What nests without end must be refused by the parser, not by the end of the call stack.
#[test]
fn deep_nesting_is_refused() {
    assert!(refusal(&stack(&"[".repeat(100_000))).contains("not valid TOML"));
    let dotted = format!("{}x = 1", "a.".repeat(2_000_000));
    assert!(read(&dotted).is_err());
}

#[test]
fn materials_are_refused_by_place() {
    let material = |body: &str| refusal(&format!("[materials.x]\n{body}\n"));
    assert_eq!(material("k = 1"), "s.toml:2:5: k: k without n; add n");
    assert_eq!(material(""), "s.toml:1:1: [materials.x]: no data; add n (and k), table or file");
    assert_eq!(
        material("n = 1\nfile = \"x.yml\""),
        "s.toml:3:8: file: a material has either a file or n and k; remove one"
    );
    assert_eq!(material("n = 1\nk = -1"), "s.toml:3:5: k: k = -1 is gain; k must not be negative: for n − ik write +k");
    assert_eq!(material("n = 0"), "s.toml:2:5: n: n = 0, k = 0 is not passive (n > 0 and k >= 0 are required)");
    assert_eq!(material("n = nan"), "s.toml:2:5: n: NaN is not a finite number");
    assert_eq!(
        material("file = \"x.yml\""),
        "s.toml:2:8: file: /nonexistent/x.yml: no such file; paths start at the scene file"
    );
    assert_eq!(
        material("table = [[400, 1.5], [500]]"),
        "s.toml:2:22: table: a row of 1 numbers; write [nm, n] or [nm, n, k]"
    );
    assert_eq!(material("table = []"), "s.toml:2:9: table: no rows; write table = [[400, 1.5, 0.0], [700, 1.48, 0.0]]");
    assert_eq!(
        material("table = [[400, 1.5], [500, 1.5, 0.1]]"),
        "s.toml:2: k stands in some rows and is missing in others; give it in each, or in none"
    );
    assert_eq!(
        material("n = 1\ntable = [[400, 1.5]]"),
        "s.toml:2:5: n: a material has either a table, a file, or n and k; keep one"
    );
    assert_eq!(
        material("unit = \"nm\"\nn = 1"),
        "s.toml:2:8: unit: only columns of text in a file have a unit; an inline table is in nm"
    );
    assert_eq!(material("unit = \"cm\"\nfile = \"x\""), "s.toml:2:8: unit: \"cm\" is unknown; write \"nm\" or \"um\"");
    assert_eq!(
        refusal("[materials.Mirror]\nn = 1\n"),
        "s.toml:1:1: Mirror: this name stands for a perfect mirror; choose another"
    );
    assert_eq!(
        refusal("[materials.X]\nn = 1\n[materials.x]\nn = 1\n"),
        "s.toml:3:1: x: [materials.X] has the same name but for upper and lower case; rename one"
    );
}

#[test]
fn cells_are_refused_by_place() {
    assert_eq!(
        refusal(&cell("[interface.a]\nabove = 1\nbelow = \"mirror\"\n")),
        "s.toml:2:8: mesh: /nonexistent/m.obj: no such file; paths start at the scene file"
    );
    assert_eq!(
        refusal(&cell("")),
        "s.toml:1:1: [cell]: a [cell] needs one [interface.NAME] for each usemtl name of its mesh; add them"
    );
    let coating = "[interface.a]\nabove = 1\nbelow = 2\ncoating = [ { material = \"MgF2\", thickness_nm = 100 } ]\n";
    assert!(refusal(&cell(coating)).ends_with("/nonexistent/m.obj: no such file; paths start at the scene file"));
    assert_eq!(
        refusal(&cell(&coating.replace("MgF2", "MgFF"))),
        "s.toml:7:26: material: unknown material \"MgFF\"; nearest is \"MgF2\", or declare [materials.MgFF]"
    );
    let both = cell("surface = { kind = \"pits\" }\n");
    assert_eq!(refusal(&both), "s.toml:4:11: surface: a [cell] has either a mesh or a surface; remove one");
    assert_eq!(
        refusal("[cell]\nperiod_nm = [1, 1]\n"),
        "s.toml:1:1: [cell]: neither mesh nor surface; write mesh = \"file.obj\""
    );
    assert!(
        refusal(&cell(&coating.replace("100", "-1")))
            .ends_with("thickness_nm: -1 is negative; lengths are 0 nm or more")
    );
    assert_eq!(
        refusal(&cell("[interface.a]\nabove = 1\n")),
        "s.toml:4:1: [interface.a]: \"below\" is missing; write the medium behind the facet, or \"mirror\""
    );
    let period = |value: &str| refusal(&cell("").replace("[1, 1]", value));
    assert_eq!(period("[1, 0]"), "s.toml:3:13: period_nm: a period must be more than 0 nm");
    assert_eq!(period("[1]"), "s.toml:3:13: period_nm: expected two lengths [x, y], found a list of 1");
}
