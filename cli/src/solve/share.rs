//! A share of the parts of a table, for work that is spread over machines.

use std::fmt;
use std::str::FromStr;

/// One of so many shares, each of which takes every so-many-th part: neighbours cost about the same.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Share {
    /// Number of the share, from 1.
    pub number: u32,
    /// Number of shares.
    pub of: u32,
}

/// Largest number of shares.
pub const MAX_SHARES: u32 = 1 << 20;

impl Share {
    /// Whether the share takes the part at this place among all parts.
    #[must_use]
    pub fn takes(self, place: usize) -> bool {
        place % self.of as usize == self.number as usize - 1
    }
}

impl fmt::Display for Share {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.number, self.of)
    }
}

impl FromStr for Share {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let numbers = text.split_once('/').and_then(|(number, of)| Some((number.parse().ok()?, of.parse().ok()?)));
        match numbers {
            Some((number, of)) if (1..=of).contains(&number) && of <= MAX_SHARES => Ok(Self { number, of }),
            _ => Err(format!("expected I/N such as 3/8, with I from 1 to N and N at most {MAX_SHARES}")),
        }
    }
}
