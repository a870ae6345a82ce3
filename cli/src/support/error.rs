//! The one error type of the command line: a line of text and an exit code.

use std::fmt;

use crate::support::text::one_line;

/// Error of the command line: one line that says what is wrong, where, and the remedy.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Error {
    message: String,
    exit_code: u8,
    /// Whether the cause is a medium without data at a wavelength.
    no_data: bool,
}

/// Result of anything that a user can make fail.
pub type Result<T> = std::result::Result<T, Error>;

impl Error {
    /// Wrong usage of the command line: exit code 2.
    pub fn usage(message: impl fmt::Display) -> Self {
        Self::new(message, 2)
    }

    /// Fault of a file, a scene or the machine: exit code 1.
    pub fn failed(message: impl fmt::Display) -> Self {
        Self::new(message, 1)
    }

    /// Makes the message one line of plain text: libraries report over several lines, and names come from files of
    /// strangers.
    fn new(message: impl fmt::Display, exit_code: u8) -> Self {
        Self { message: one_line(&message.to_string()), exit_code, no_data: false }
    }

    /// Missing data of a medium at a wavelength that a command needs: exit code 1. The remedy depends on the command:
    /// see [`Error::with_remedy`].
    pub fn no_data(message: impl fmt::Display) -> Self {
        Self { no_data: true, ..Self::failed(message) }
    }

    /// Adds the remedy for missing data of a medium; other errors stay unchanged. `asks` says whether the command lets
    /// its user choose the wavelengths.
    #[must_use]
    pub fn with_remedy(self, asks: bool) -> Self {
        let remedy = match (self.no_data, asks) {
            (false, _) => return self,
            (true, true) => "choose --wavelengths inside, or set extrapolate = \"clamp\" in the scene",
            (true, false) => "set extrapolate = \"clamp\" in the scene",
        };
        Self { message: format!("{}; {remedy}", self.message), no_data: false, ..self }
    }

    /// Exit code of the program, 1 or 2.
    #[must_use]
    pub fn exit_code(&self) -> u8 {
        self.exit_code
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl std::error::Error for Error {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_message_is_one_line_of_plain_text() {
        let error = Error::failed("name\u{1b}[2J:\n  expected a\u{202e}b\r\n");
        assert_eq!(error.to_string(), "name\\u{1b}[2J: expected a\\u{202e}b");
        assert_eq!(Error::usage("\u{9b}0m").to_string(), "\\u{9b}0m");
    }
}
