use std::fs;

use tempfile::TempDir;

use super::*;

const PART: usize = 11;
const COUNT: usize = 5;
const RECORD: usize = NUMBER_BYTES + PART + SUM_BYTES;

fn identity(scene: &str) -> Identity {
    Identity::of_program().and("scene", &scene).and("options", &(7, 0.1))
}

fn part(number: usize) -> Vec<u8> {
    vec![number as u8 + 1; PART]
}

/// A folder and the path of an output in it that is not written yet.
fn output() -> (TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().join("table.exr");
    (folder, output)
}

fn open(output: &Path) -> Result<Checkpoint> {
    Checkpoint::open(output, &identity("film"), false).map(|checkpoint| checkpoint.expect("no device"))
}

/// The numbers of the parts that are restored; each must equal the part that was kept.
fn restored(checkpoint: &Checkpoint) -> Vec<usize> {
    let mut numbers = Vec::new();
    let count = checkpoint.restore(PART, COUNT, |number, bytes| {
        assert_eq!(bytes, part(number));
        numbers.push(number);
    });
    assert_eq!(count, Ok(numbers.len()));
    numbers
}

/// The bytes of a log of three parts, and where its records start.
fn log_of_three(output: &Path) -> (Vec<u8>, usize) {
    let checkpoint = open(output).unwrap();
    assert!(restored(&checkpoint).is_empty());
    for number in [3, 0, 4] {
        checkpoint.keep(number, &part(number)).unwrap();
    }
    let bytes = fs::read(&checkpoint.path).unwrap();
    let head = bytes.len() - 3 * RECORD;
    (bytes, head)
}

#[test]
fn what_was_kept_is_found_until_the_end() {
    let (folder, output) = output();
    log_of_three(&output);
    let checkpoint = open(&output).unwrap();
    assert_eq!(restored(&checkpoint), [3, 0, 4]);
    checkpoint.keep(1, &part(1)).unwrap();
    drop(checkpoint);
    let checkpoint = open(&output).unwrap();
    assert_eq!(restored(&checkpoint), [3, 0, 4, 1]);
    checkpoint.remove().unwrap();
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
}

#[test]
fn a_log_cut_anywhere_keeps_its_whole_records() {
    let (_folder, output) = output();
    let (bytes, head) = log_of_three(&output);
    let path = output.with_extension("exr.checkpoint");
    for length in 0..=bytes.len() {
        fs::write(&path, &bytes[..length]).unwrap();
        let checkpoint = open(&output).unwrap();
        let whole = length.saturating_sub(head) / RECORD;
        assert_eq!(restored(&checkpoint), [3, 0, 4][..whole], "{length}");
        // What comes next stands where the cut record stood.
        checkpoint.keep(2, &part(2)).unwrap();
        drop(checkpoint);
        let found = restored(&open(&output).unwrap());
        assert_eq!((found.len(), found[whole]), (whole + 1, 2), "{length}");
    }
}

#[test]
fn a_changed_byte_ends_the_log_or_is_refused() {
    let (_folder, output) = output();
    let (bytes, head) = log_of_three(&output);
    let path = output.with_extension("exr.checkpoint");
    for at in 0..bytes.len() {
        for flip in [0x01, 0x80, 0xff] {
            let mut bytes = bytes.clone();
            bytes[at] ^= flip;
            fs::write(&path, &bytes).unwrap();
            match open(&output) {
                Ok(checkpoint) => assert_eq!(restored(&checkpoint), [3, 0, 4][..(at - head) / RECORD], "{at}"),
                Err(error) => assert!(at < head && !error.to_string().contains('\n'), "{at}: {error}"),
            }
        }
    }
    // Zeros after the last whole record, as a power cut leaves them.
    fs::write(&path, [&bytes[..head + RECORD], &[0; 3 * RECORD]].concat()).unwrap();
    assert_eq!(restored(&open(&output).unwrap()), [3]);
}

#[test]
fn other_work_is_refused_with_the_reason_and_stays() {
    let (_folder, output) = output();
    let (bytes, _) = log_of_three(&output);
    let path = output.with_extension("exr.checkpoint");
    let refusal = |identity: &Identity| Checkpoint::open(&output, identity, false).unwrap_err().to_string();
    let shown = path.display();
    let remedy = "finish it by the command that began it, or begin anew by --restart";
    assert_eq!(
        refusal(&identity("other film")),
        format!("{shown} belongs to other work: not the same scene; {remedy}")
    );
    assert_eq!(
        refusal(&Identity::of_program().and("scene", &"film").and("options", &(7, 0.2))),
        format!("{shown} belongs to other work: not the same options; {remedy}")
    );
    assert_eq!(fs::read(&path).unwrap(), bytes);
    let ours = format!("goniochrome {}", env!("CARGO_PKG_VERSION"));
    let old = String::from_utf8_lossy(&bytes).replace(&ours, "goniochrome 0.0.9");
    fs::write(&path, old.split_once("scene").unwrap().0).unwrap();
    let message = refusal(&identity("film"));
    assert!(message.starts_with(&format!("{shown} comes from goniochrome 0.0.9 (")), "{message}");
    assert!(message.ends_with(&format!("), another version; {remedy}")), "{message}");
    fs::write(&path, "my notes\n").unwrap();
    assert_eq!(refusal(&identity("film")), format!("{shown} is no checkpoint; move it away or choose another output"));
    assert_eq!(fs::read(&path).unwrap(), b"my notes\n");
}

#[test]
fn one_output_takes_one_run() {
    let (_folder, output) = output();
    let first = open(&output).unwrap();
    let message = open(&output).unwrap_err().to_string();
    let remedy = "wait for its end or choose another output";
    assert_eq!(message, format!("another run is writing {}; {remedy}", output.display()));
    first.keep(2, &part(2)).unwrap();
    drop(first);
    assert_eq!(restored(&open(&output).unwrap()), [2]);
}

#[test]
fn nothing_kept_leaves_no_file() {
    let (folder, output) = output();
    drop(open(&output).unwrap());
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
    fs::create_dir(output.with_extension("exr.checkpoint")).unwrap();
    assert!(open(&output).unwrap_err().to_string().ends_with("is a folder; choose another output"));
}

#[cfg(target_os = "linux")]
#[test]
fn a_device_has_no_checkpoint_and_is_none() {
    assert!(Checkpoint::open(Path::new("/dev/null"), &identity("film"), false).unwrap().is_none());
    let (folder, output) = output();
    std::os::unix::fs::symlink("/dev/full", folder.path().join("table.exr.checkpoint")).unwrap();
    assert!(open(&output).unwrap_err().to_string().contains("is no checkpoint; move it away"));
}
