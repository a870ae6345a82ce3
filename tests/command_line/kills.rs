//! Interrupted runs of `estimate` on a cell: whether one is killed, loses a part of its checkpoint or meets another
//! run, the same command ends with the same bytes.

use std::fs::{self, File};
use std::process::{Child, Stdio};
use std::sync::LazyLock;
use std::time::{Duration, Instant};

use goniochrome_cli::table::Table;
use goniochrome_cli::table::file::read;

use crate::random::Random;
use crate::user::User;

const SCENE: &str = "[cell]\nperiod_nm = [1000, 1000]\n\
                     surface = { kind = \"pyramids\", count = [1, 1], fill = [0.6, 0.6] }\n\
                     [interface.pyramids]\nabove = 1.0\nbelow = 1.5\n";
const TABLE: &str = "--incident 4x8 --half-vectors 4x8 --rays 2048 --wavelengths 450,550 --coherence none";
const CHECKPOINT: &str = "t.exr.checkpoint";
/// Bytes of a checkpoint's record for [`TABLE`]: number, energy, values of two wavelengths and errors, checksum.
static RECORD: LazyLock<u64> = LazyLock::new(|| {
    let user = user();
    user.ok(&estimate(2));
    let Table::Scatter(table) = read(&user.at("t.exr")).unwrap() else { panic!("a table of scattered light") };
    8 + 9 * 8 + 3 * 4 * table.layout.places() as u64 + 32
});
/// Number of kills in a plain test run; `GONIOCHROME_KILLS` asks for more.
const KILLS: u32 = 40;

fn user() -> User {
    User::with(&[("s.toml", SCENE)])
}

fn estimate(threads: u64) -> String {
    format!("estimate s.toml -o t.exr {TABLE} -q --threads {threads}")
}

fn start(user: &User, line: &str) -> Child {
    user.program().args(line.split_whitespace()).stderr(Stdio::piped()).spawn().expect("the program starts")
}

/// The table of an uninterrupted run, and how long it took.
fn uninterrupted(user: &User) -> (Vec<u8>, Duration) {
    let before = Instant::now();
    user.ok(&estimate(2));
    let table = user.read("t.exr");
    fs::remove_file(user.at("t.exr")).unwrap();
    assert!(!user.at(CHECKPOINT).exists(), "a complete table needs no checkpoint");
    (table, before.elapsed())
}

/// Kills a run: by SIGTERM if `politely` and the system has it, otherwise by SIGKILL.
fn kill(child: &mut Child, politely: bool) {
    let id = child.id().to_string();
    let told = politely && std::process::Command::new("kill").args(["-TERM", &id]).status().is_ok_and(|s| s.success());
    if !told {
        child.kill().expect("a child can be killed");
    }
}

#[test]
fn a_killed_run_resumes_to_the_same_bytes() {
    let kills = std::env::var("GONIOCHROME_KILLS").map_or(KILLS, |text| text.parse().expect("a number of kills"));
    let user = user();
    let (table, duration) = uninterrupted(&user);
    let mut random = Random(7);
    let (mut killed, mut finished, mut resumed, mut cut) = (0, 0, 0, 0);
    while killed < kills || finished == 0 {
        let held = fs::metadata(user.at(CHECKPOINT)).map_or(0, |file| file.len());
        let mut child = start(&user, &estimate(1 + random.below(2)));
        // Late enough kills let some runs finish: what they leave is compared, and the next starts anew.
        if killed < kills {
            std::thread::sleep(duration.mul_f64(random.below(1000) as f64 / 2000.0));
            kill(&mut child, random.below(2) == 0);
        }
        let output = child.wait_with_output().unwrap();
        match output.status.code() {
            Some(0) => {
                assert!(user.at("t.exr").exists() && !user.at(CHECKPOINT).exists());
                finished += 1;
            }
            None => killed += 1,
            code => panic!("{code:?}: {}", String::from_utf8_lossy(&output.stderr)),
        }
        let now = fs::metadata(user.at(CHECKPOINT)).map_or(0, |file| file.len());
        resumed += u32::from(held > *RECORD && now > held);
        // A power cut may lose the end of what was written, within a record as well as between two.
        if now > 0 && random.below(3) == 0 {
            let kept = now.saturating_sub(random.below(2 * *RECORD));
            File::options().write(true).open(user.at(CHECKPOINT)).unwrap().set_len(kept).unwrap();
            cut += 1;
        }
        // A table appears whole or not at all, also where the kill came between it and the end of its checkpoint.
        if user.at("t.exr").exists() {
            assert!(user.read("t.exr") == table, "after {killed} kills");
            fs::remove_file(user.at("t.exr")).unwrap();
        }
    }
    println!("{killed} kills, {cut} logs cut, {resumed} runs that went on and were killed again, {finished} tables");
    assert!(resumed > 0 && cut > 0, "the kills came too early to show anything");
}

/// Planar tables take seconds, so they have no checkpoint: a kill leaves the earlier file or the new one, each whole.
#[test]
fn a_killed_planar_run_leaves_the_earlier_file_or_the_new_one() {
    const LINE: &str = "estimate jewel-beetle -o t.exr -q --threads 1";
    const EARLIER: &[u8] = b"of an earlier run";
    let user = User::new();
    let before = Instant::now();
    user.ok(LINE);
    let (table, duration) = (user.read("t.exr"), before.elapsed());
    let mut killed = 0;
    for step in 0..20 {
        user.write("t.exr", EARLIER);
        let mut child = start(&user, LINE);
        std::thread::sleep(duration.mul_f64(f64::from(step) / 16.0));
        kill(&mut child, step % 2 == 0);
        let done = child.wait_with_output().unwrap().status.success();
        let left = user.read("t.exr");
        assert!(left == table || (!done && left == EARLIER), "kill {step} left {} bytes", left.len());
        killed += u32::from(!done);
    }
    assert!(killed > 0, "no kill came before the end");
    user.ok(LINE);
    assert!(user.read("t.exr") == table && !user.at(CHECKPOINT).exists());
}

/// A checkpoint of some directions but not all.
fn interrupted(user: &User) -> Vec<u8> {
    let mut child = start(user, &estimate(1));
    loop {
        let length = fs::metadata(user.at(CHECKPOINT)).map_or(0, |file| file.len());
        if length > 2 * *RECORD + 512 {
            break;
        }
        assert!(child.try_wait().unwrap().is_none(), "the run ended before its third record");
        std::thread::sleep(Duration::from_millis(1));
    }
    child.kill().unwrap();
    child.wait().unwrap();
    user.read(CHECKPOINT)
}

#[test]
fn a_log_cut_at_any_record_resumes_to_the_same_bytes() {
    let user = user();
    let (table, _) = uninterrupted(&user);
    let log = interrupted(&user);
    let head = log.len() as u64 % *RECORD;
    for record in 0..=(log.len() as u64 - head) / *RECORD {
        for offset in [-1, 0, 1] {
            let Some(length) = (head + record * *RECORD).checked_add_signed(offset) else { continue };
            user.write(CHECKPOINT, &log[..(length as usize).min(log.len())]);
            user.ok(&estimate(2));
            assert!(user.read("t.exr") == table, "record {record} {offset:+}");
            if record > 2 {
                return; // the others are no different
            }
        }
    }
}

#[test]
fn a_checkpoint_of_other_work_is_refused_with_the_reason() {
    let user = user();
    interrupted(&user);
    let remedy = "begin anew by --restart";
    for (change, what) in [("--rays 4096", "options"), ("--seed 3", "options"), ("--precision f64", "options")] {
        let line = estimate(1).replace("--rays 2048", if change.starts_with("--rays") { "" } else { "--rays 2048" });
        user.refused(&format!("{line} {change}"), 1, &[CHECKPOINT, "other work", what, remedy]);
    }
    let line = estimate(1).replace("450,550", "450,551");
    user.refused(&line, 1, &[CHECKPOINT, "not the same wavelengths", remedy]);
    user.write("s.toml", SCENE.replace("below = 1.5", "below = 1.6"));
    user.refused(&estimate(1), 1, &[CHECKPOINT, "not the same scene", remedy]);
    user.write("s.toml", SCENE.replace("fill = [0.6", "seed = 9, fill = [0.5"));
    user.refused(&estimate(1), 1, &[CHECKPOINT, "not the same mesh", remedy]);
    user.write("s.toml", SCENE);
    let log = String::from_utf8_lossy(&user.read(CHECKPOINT)).into_owned();
    let head = log.lines().next().unwrap();
    user.write(CHECKPOINT, format!("{head}\nversion: goniochrome 0.0.1 (none)\n"));
    user.refused(&estimate(1), 1, &[CHECKPOINT, "comes from goniochrome 0.0.1 (none), another version", remedy]);
    user.write(CHECKPOINT, "something else");
    user.refused(&estimate(1), 1, &[CHECKPOINT, "is no checkpoint", "choose another output"]);
    user.refused(&format!("{} --restart", estimate(1)), 1, &[CHECKPOINT, "is no checkpoint", "choose another output"]);
}

#[test]
fn restart_discards_what_an_earlier_run_has_finished() {
    let user = user();
    interrupted(&user);
    let other = estimate(1).replace("--rays 2048", "--rays 1024");
    user.refused(&other, 1, &[CHECKPOINT, "begin anew by --restart"]);
    user.ok(&format!("{other} --restart"));
    let anew = user.read("t.exr");
    assert!(!user.at(CHECKPOINT).exists());
    user.ok(&other);
    assert!(user.read("t.exr") == anew);
}

#[test]
fn an_interrupted_run_has_said_how_to_go_on() {
    let user = user();
    interrupted(&user);
    let aloud = estimate(1).replace(" -q", "");
    let said = user.ok(&aloud).stderr;
    assert!(
        said.contains(&format!("resumes from {}", user.at(CHECKPOINT).display()))
            || said.contains("resumes from t.exr"),
        "{said}"
    );
    assert!(said.contains("--restart begins anew"), "{said}");
    let said = user.ok(&aloud).stderr;
    assert!(said.contains("after an interruption the same command resumes, --restart begins anew"), "{said}");
    // Planes have nothing to resume.
    assert!(!user.ok("estimate paper-fig4 -o p.exr --angles 4 --restart").stderr.contains("resumes"));
}

#[test]
fn two_runs_to_one_output_do_not_mix() {
    let user = user();
    let (table, _) = uninterrupted(&user);
    let mut runs: Vec<Child> = (0..4).map(|_| start(&user, &estimate(1))).collect();
    let mut done = 0;
    for run in runs.drain(..) {
        let output = run.wait_with_output().unwrap();
        let message = String::from_utf8(output.stderr).unwrap();
        match output.status.code() {
            Some(0) => done += 1,
            Some(1) => {
                assert!(
                    message.contains("another run is writing") && message.contains("wait for its end"),
                    "{message}"
                );
                assert_eq!(message.lines().count(), 1);
            }
            code => panic!("{code:?}: {message}"),
        }
    }
    assert!(done > 0 && user.read("t.exr") == table);
    assert!(!user.at(CHECKPOINT).exists());
}

#[test]
fn a_failure_before_any_work_leaves_no_checkpoint() {
    let user = user();
    user.write("s.toml", SCENE.replace("below = 1.5", "below = \"N-BK7\""));
    user.refused("estimate s.toml -o t.exr --wavelengths 1,2,550", 1, &["N-BK7"]);
}
