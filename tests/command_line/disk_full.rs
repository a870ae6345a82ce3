//! Tests of full disks: one line of error, no half-written file and no lost one.
#![cfg(target_os = "linux")]

use std::fs::File;
use std::process::Command;

use crate::user::User;

const SAYS: [&str; 2] = ["no space left to write", "free some"];

#[test]
fn a_full_device_is_reported() {
    let user = User::new();
    for name in ["full.exr", "full.png"] {
        std::os::unix::fs::symlink("/dev/full", user.at(name)).unwrap();
    }
    user.ok("estimate paper-fig3 -o t.exr --angles 4 --wavelengths 400:700:100 --quiet");
    for line in [
        "spectrum paper-fig3 --csv /dev/full",
        "colour paper-fig3 --csv /dev/full -q",
        "compare paper-fig3 --csv /dev/full",
        // The picture does not appear without its CSV either.
        "compare paper-fig3 --csv /dev/full -o a.png",
        "sampling paper-fig3 --samples 4 --csv /dev/full -o a.svg",
        "estimate paper-fig3 --angles 4 -o full.exr -q",
        "plot t.exr -o full.png",
    ] {
        user.refused(line, 1, &SAYS);
    }
}

#[test]
fn a_full_standard_output_is_reported_and_a_closed_one_is_not() {
    let user = User::new();
    for command in ["presets", "spectrum", "colour", "compare"] {
        let mut program = user.program();
        program.arg(command).args((command != "presets").then_some("paper-fig3"));
        // Without the note on the number of wavelengths.
        program.args((command == "colour").then_some("--quiet"));
        let output = program.stdout(File::create("/dev/full").unwrap()).output().unwrap();
        let message = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(1), "{command}: {message}");
        assert!(SAYS.iter().all(|part| message.contains(part)) && message.lines().count() == 1, "{message}");
    }
    // The output is longer than a pipe holds.
    let arguments = ["spectrum", "paper-fig3", "--theta", "0:89:1", "--wavelengths", "380:780:1"];
    let mut child = user.program().args(arguments).stdout(std::process::Stdio::piped()).spawn().unwrap();
    drop(child.stdout.take());
    assert_eq!(child.wait().unwrap().code(), Some(0));
}

/// Runs a shell script in which `$0` is the program and `tiny` is a private file system of 64 KiB. Returns its output
/// and its errors, or `None` where mounting is not permitted.
fn beside_a_tiny_disk(user: &User, script: &str) -> Option<(String, String)> {
    const NOT_MOUNTED: i32 = 99;
    let script =
        format!("mkdir -p tiny && mount -t tmpfs -o size=64k tmpfs tiny 2>/dev/null || exit {NOT_MOUNTED}; {script}");
    let output = Command::new("unshare")
        .args(["--mount", "--map-root-user", "sh", "-c", &script, env!("CARGO_BIN_EXE_goniochrome")])
        .current_dir(user.at(""))
        .output()
        .ok()
        .filter(|output| output.status.code() == Some(0));
    let text = |bytes| String::from_utf8(bytes).unwrap();
    output.map(|output| (text(output.stdout), text(output.stderr)))
}

/// Runs the program beside a tiny disk that holds two files.
fn on_a_tiny_disk(user: &User, arguments: &str) -> Option<(String, String)> {
    let script = "echo kept > tiny/old.csv; echo kept > tiny/old.exr; \
                  \"$0\" ARGUMENTS; echo \"code $?\"; ls -A tiny; cat tiny/old.csv tiny/old.exr";
    beside_a_tiny_disk(user, &script.replace("ARGUMENTS", arguments))
}

#[test]
fn a_full_file_system_keeps_what_it_had() {
    let user = User::new();
    for arguments in [
        "spectrum paper-fig4 --theta 0:80:5 --wavelengths 380:780:1 --csv tiny/new.csv",
        "spectrum paper-fig4 --theta 0:80:5 --wavelengths 380:780:1 --csv tiny/old.csv",
        "estimate paper-fig4 --wavelengths 380:780:1 -o tiny/new.exr",
        "estimate paper-fig4 --wavelengths 380:780:1 -o tiny/old.exr",
        "compare paper-fig4 -o tiny/new.png --csv tiny/new.csv",
    ] {
        let Some((stdout, stderr)) = on_a_tiny_disk(&user, arguments) else {
            println!("skipped: this machine does not permit mounting a file system");
            return;
        };
        assert_eq!(stdout, "code 1\nold.csv\nold.exr\nkept\nkept\n", "{arguments}: {stderr}");
        assert!(stderr.starts_with("goniochrome: no space left to write tiny/"), "{stderr}");
        assert_eq!(stderr.lines().count(), 1, "{stderr}");
    }
}

#[test]
fn a_full_file_system_keeps_the_directions_that_are_finished() {
    let user = User::new();
    let table =
        "silicon-pyramids --incident 4x8 --half-vectors 16x32 --rays 32 --wavelengths 450,550 --coherence none -q";
    let script = "\"$0\" estimate TABLE -o tiny/t.exr; echo \"code $?\"; ls -A tiny; mount -o remount,size=4m tiny; \
                  \"$0\" estimate TABLE -o tiny/t.exr; echo \"code $?\"; ls -A tiny; cp tiny/t.exr resumed.exr";
    let Some((stdout, stderr)) = beside_a_tiny_disk(&user, &script.replace("TABLE", table)) else {
        println!("skipped: this machine does not permit mounting a file system");
        return;
    };
    assert_eq!(stdout, "code 1\nt.exr.checkpoint\ncode 0\nt.exr\n", "{stderr}");
    assert!(stderr.starts_with("goniochrome: no space left to write tiny/t.exr.checkpoint; free some"), "{stderr}");
    assert!(stderr.ends_with("what is finished is kept, and the same command goes on from there\n"), "{stderr}");
    assert_eq!(stderr.lines().count(), 1, "{stderr}");
    user.ok(&format!("estimate {table} -o t.exr"));
    assert!(user.read("resumed.exr") == user.read("t.exr"));
}
