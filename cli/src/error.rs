//! The one error type of the command line: a line of text and an exit code.

use std::fmt;

/// What the user did wrong or what failed, in one line that says what, where and the remedy.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Error {
    message: String,
    exit_code: u8,
}

/// Result of anything that a user can make fail.
pub type Result<T> = std::result::Result<T, Error>;

impl Error {
    /// The command line itself is wrong: exit code 2.
    pub fn usage(message: impl fmt::Display) -> Self {
        Self { message: one_line(&message), exit_code: 2 }
    }

    /// A file, a scene or the machine is at fault: exit code 1.
    pub fn failed(message: impl fmt::Display) -> Self {
        Self { message: one_line(&message), exit_code: 1 }
    }

    /// 1 or 2.
    #[must_use]
    pub fn exit_code(&self) -> u8 {
        self.exit_code
    }
}

/// Libraries report over several lines; a log wants one.
fn one_line(message: &impl fmt::Display) -> String {
    message.to_string().split_whitespace().collect::<Vec<_>>().join(" ")
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl std::error::Error for Error {}
