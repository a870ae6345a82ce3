//! A user of the program: a folder, the files in it, and commands run there.

use std::collections::BTreeMap;
use std::fs;
use std::path::PathBuf;
use std::process::Command;

use tempfile::TempDir;

/// The exit code and the output of a run.
pub struct Ran {
    pub code: Option<i32>,
    pub stdout: String,
    pub stderr: String,
}

/// A temporary folder in which commands run.
pub struct User(TempDir);

impl User {
    pub fn new() -> Self {
        Self(tempfile::tempdir().expect("a temporary folder"))
    }

    pub fn with(files: &[(&str, &str)]) -> Self {
        let user = Self::new();
        files.iter().for_each(|(name, text)| user.write(name, text));
        user
    }

    pub fn at(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    pub fn write(&self, name: &str, contents: impl AsRef<[u8]>) {
        fs::write(self.at(name), contents).expect("the folder takes files");
    }

    pub fn read(&self, name: &str) -> Vec<u8> {
        fs::read(self.at(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
    }

    /// The program, to be run in this folder.
    pub fn program(&self) -> Command {
        let mut program = Command::new(env!("CARGO_BIN_EXE_goniochrome"));
        program.current_dir(self.0.path());
        program
    }

    /// Runs a command line, whose words are separated by spaces; `''` is an empty word.
    pub fn run(&self, line: &str) -> Ran {
        let words = line.split_whitespace().map(|word| if word == "''" { "" } else { word });
        let output = self.program().args(words).output().expect("the program starts");
        let text = |bytes| String::from_utf8(bytes).expect("the program speaks UTF-8");
        Ran { code: output.status.code(), stdout: text(output.stdout), stderr: text(output.stderr) }
    }

    /// Runs a command line that must succeed.
    pub fn ok(&self, line: &str) -> Ran {
        let ran = self.run(line);
        assert_eq!(ran.code, Some(0), "{line}: {}", ran.stderr);
        ran
    }

    /// Runs a command line that must fail with this exit code: it prints one line of error that contains all of `says`,
    /// prints nothing to standard output, and makes, changes or removes no file. Returns the error.
    pub fn refused(&self, line: &str, code: i32, says: &[&str]) -> String {
        let before = self.files();
        let Ran { code: found, stdout, stderr } = self.run(line);
        assert_eq!(found, Some(code), "{line}: {stderr}");
        let message = stderr.strip_suffix('\n').unwrap_or_else(|| panic!("{line}: no line on standard error"));
        assert!(message.starts_with("goniochrome: ") && !message.contains('\n'), "{line}: {message}");
        for part in says {
            assert!(message.contains(part), "{line}: {part:?} is missing from {message:?}");
        }
        assert_eq!(stdout, "", "{line}");
        assert_eq!(self.files(), before, "{line}: a failure leaves the folder as it was");
        message.to_owned()
    }

    /// Every file with its contents, and every folder and device without.
    fn files(&self) -> BTreeMap<PathBuf, Option<Vec<u8>>> {
        let mut files = BTreeMap::new();
        let mut folders = vec![self.0.path().to_owned()];
        while let Some(folder) = folders.pop() {
            for entry in fs::read_dir(folder).expect("the folder is there") {
                let path = entry.expect("the folder is readable").path();
                if path.is_dir() {
                    folders.push(path.clone());
                }
                let contents = path.is_file().then(|| fs::read(&path).expect("files are readable"));
                files.insert(path, contents);
            }
        }
        files
    }
}

/// The numbers in a column of a CSV.
pub fn column(csv: &str, name: &str) -> Vec<f64> {
    let mut reader = csv::Reader::from_reader(csv.as_bytes());
    let header = reader.headers().expect("a header").clone();
    let place = header.iter().position(|known| known == name).unwrap_or_else(|| panic!("no column {name}: {csv}"));
    let number = |record: csv::Result<csv::StringRecord>| {
        let record = record.expect("every row is as long as the header");
        record[place].parse().unwrap_or_else(|_| panic!("{name}: {:?} is not a number", &record[place]))
    };
    reader.records().map(number).collect()
}

/// The rows of three columns of numbers of a CSV.
pub fn triples(csv: &str, names: [&str; 3]) -> Vec<[f64; 3]> {
    let [x, y, z] = names.map(|name| column(csv, name));
    x.into_iter().zip(y).zip(z).map(|((x, y), z)| [x, y, z]).collect()
}

/// The largest difference of two lists of equal length.
pub fn largest_difference(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    assert!(!a.is_empty());
    assert!(a.iter().chain(b).all(|x| x.is_finite()));
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}
