//! Values of the keys of a generated surface, each within its limits.

use crate::scene::parts::MAX_LENGTH_NM;
use crate::scene::toml_value::{TomlItem, TomlTable};
use crate::support::error::Result;

/// Value as a number in [min, max].
pub(super) fn within(item: &TomlItem<'_>, [min, max]: [f64; 2]) -> Result<f64> {
    match item.number()? {
        x if (min..=max).contains(&x) => Ok(x),
        x => Err(item.refuse(format_args!("{x} must lie between {min} and {max}"))),
    }
}

/// Length of more than 0 nm under a required key.
pub(super) fn length(table: &TomlTable<'_>, key: &str) -> Result<f64> {
    positive(&table.require(key, &format!("{key} = 1000.0"))?)
}

/// Value as a length of more than 0 nm.
pub(super) fn positive(item: &TomlItem<'_>) -> Result<f64> {
    match item.number()? {
        x if x > 0.0 && x <= MAX_LENGTH_NM => Ok(x),
        x => Err(item.refuse(format_args!("{x} nm; a length here is more than 0 nm and at most a metre"))),
    }
}

/// Value as an integer in [min, max].
pub(super) fn count(item: &TomlItem<'_>, [min, max]: [u32; 2]) -> Result<u32> {
    match item.count(max)? {
        n if n >= min => Ok(n),
        n => Err(item.refuse(format_args!("{n} is too few; at least {min}"))),
    }
}

/// Value as a list of exactly N values.
pub(super) fn list<'a, const N: usize>(item: &TomlItem<'a>) -> Result<[TomlItem<'a>; N]> {
    let found = || item.refuse(format_args!("expected a list of {N}, found {}", item.found()));
    item.array()?.try_into().map_err(|_| found())
}

/// List of N integers from 1 to `max` under a required key.
pub(super) fn counts<const N: usize>(table: &TomlTable<'_>, key: &str, max: u32) -> Result<[u32; N]> {
    let example = vec!["4"; N].join(", ");
    let items = list::<N>(&table.require(key, &format!("{key} = [{example}]"))?)?;
    let mut numbers = [0; N];
    for (number, item) in numbers.iter_mut().zip(&items) {
        *number = count(item, [1, max])?;
    }
    Ok(numbers)
}
