//! Tests of `estimate --part` and `merge`: tables whose parts are computed one by one.

use std::fs;

use crate::user::User;

const PITS: &str = "estimate beetle-pits --incident 4x8 --half-vectors 8x16 --rays 64 --wavelengths 400:700:50";
const DISC: &str = "estimate compact-disc --incident 3x5 --wavelengths 400:700:100";

/// Computes so many parts, and returns the names of their files, the last first.
fn computed(user: &User, command: &str, of: u32) -> String {
    let mut names = String::new();
    for number in 1..=of {
        user.ok(&format!("{command} --part {number}/{of} -o p{number}.part -q"));
        names = format!("p{number}.part {names}");
    }
    names
}

#[test]
fn parts_join_to_the_bytes_of_one_run() {
    let user = User::new();
    for (command, parts) in [
        (PITS, &[1, 3][..]),
        (&format!("{PITS} --reciprocal --space rec2020"), &[2]),
        // More parts than directions: some are empty.
        (DISC, &[2, 40]),
        ("estimate silicon-pyramids --incident 3x1 --wavelengths 400:700:100 --rays 64 --coherence bin", &[2]),
    ] {
        user.ok(&format!("{command} -o one.exr -q"));
        for &of in parts {
            let names = computed(&user, command, of);
            user.ok(&format!("merge {names} -o joined.exr -q --threads 1"));
            assert!(user.read("one.exr") == user.read("joined.exr"), "{command} in {of} parts");
            assert!(!user.at("joined.exr.checkpoint").exists());
        }
    }
}

#[test]
fn a_missing_double_foreign_or_damaged_part_is_named() {
    let user = User::new();
    let names = computed(&user, PITS, 3);
    user.ok(&format!("{PITS} --part 3/3 --seed 1 -o seed.part -q"));
    user.ok(&format!("{PITS} --part 3/3 --illuminant E -o light.part -q"));
    user.ok(&format!("{PITS} --part 3/3 --reciprocal -o mean.part -q"));
    user.ok(&format!("{PITS} --part 3/4 -o of4.part -q"));
    let whole = user.read("p3.part");
    user.write("cut.part", &whole[..whole.len() / 2]);
    let mut changed = whole.clone();
    changed[whole.len() / 2] ^= 1;
    user.write("changed.part", changed);
    let mut head = whole.clone();
    head[70] ^= 1;
    user.write("head.part", head);
    user.write("text.part", "no part");
    for (parts, says) in [
        ("p1.part p2.part", &["part 3/3 is missing"][..]),
        ("p3.part", &["2 of 3 parts are missing", "1/3"]),
        ("p1.part p2.part p3.part p2.part", &["p2.part: is part 2/3 as p2.part"]),
        ("p1.part p2.part seed.part", &["seed.part", "another table than p1.part"]),
        ("p1.part p2.part light.part", &["light.part", "another table than p1.part"]),
        ("p1.part p2.part mean.part", &["mean.part", "another table than p1.part"]),
        ("p1.part p2.part of4.part", &["of4.part", "is part 3/4"]),
        ("p1.part p2.part cut.part", &["cut.part", "is damaged"]),
        ("p1.part p2.part changed.part", &["changed.part", "is damaged in record"]),
        ("p1.part p2.part head.part", &["head.part", "is damaged"]),
        ("p1.part p2.part text.part", &["text.part", "is no finished part"]),
        ("p1.part p2.part none.part", &["none.part", "cannot read"]),
    ] {
        user.refused(&format!("merge {parts} -o joined.exr -q"), 1, says);
    }
    user.refused(&format!("merge {names} -o p1.part -q"), 2, &["p1.part"]);
    for (line, says) in [
        (format!("{PITS} --part 4/3 -o a.part -q"), "I/N"),
        (format!("{PITS} --part 0/3 -o a.part -q"), "I/N"),
        (format!("{PITS} --part array -o a.part -q"), "SLURM_ARRAY_TASK_ID"),
        (format!("{PITS} --part 1/3 -o a.part --plot a.png -q"), "--plot"),
        ("estimate soap-bubble --part 1/3 -o a.part -q".to_owned(), "is planar"),
    ] {
        user.refused(&line, 2, &[says]);
    }
}

#[test]
fn a_scene_that_has_changed_is_not_joined_and_the_parts_stay() {
    let user = User::new();
    let scene = |index: f64| {
        format!(
            "[cell]\nperiod_nm = [2000, 2000]\nsurface = {{ kind = \"sines\", waves = 4, highest = 2, rms_slope = 0.2, grid = [8, 8] }}\n\
             [interface.upper]\nabove = \"air\"\nbelow = {index}\n"
        )
    };
    user.write("s.toml", scene(1.5));
    let run = user.run("estimate s.toml --incident 2x2 --rays 32 --wavelengths 550 --part 1/1 -o p.part -q");
    assert_eq!(run.code, Some(0), "{}", run.stderr);
    user.write("s.toml", scene(1.6));
    user.refused("merge p.part -o t.exr -q", 1, &["cannot be joined", "not the same scene"]);
    user.write("s.toml", scene(1.5));
    user.ok("merge p.part -o t.exr -q");
}

#[test]
fn a_task_of_an_array_knows_its_part() {
    let user = User::new();
    let line: Vec<&str> = PITS.split(' ').chain(["--part", "array", "-o", "a.part", "-q", "--threads", "1"]).collect();
    let variables = [("SLURM_ARRAY_TASK_ID", "6"), ("SLURM_ARRAY_TASK_MIN", "5"), ("SLURM_ARRAY_TASK_COUNT", "3")];
    assert!(user.program().args(line).envs(variables).status().unwrap().success());
    user.ok(&format!("{PITS} --part 1/3 -o p1.part -q"));
    user.ok(&format!("{PITS} --part 3/3 -o p3.part -q"));
    user.ok("merge p1.part a.part p3.part -o joined.exr -q");
    user.ok(&format!("{PITS} -o one.exr -q"));
    assert!(fs::read(user.at("one.exr")).unwrap() == user.read("joined.exr"));
}
