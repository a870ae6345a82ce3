//! Memory whose size a user chooses.
//!
//! A `vec!` that finds no memory ends the program without a word about the cause. What grows with a file, a picture or
//! a table is made here instead, and says what it was for. Systems that promise more memory than they have may still
//! stop the program later; stated limits, not these functions, keep sizes within reason.

use std::fmt::Display;

use crate::support::error::{Error, Result};

/// `len` times `value`.
///
/// # Errors
/// One line that says what the memory was for.
pub fn filled<T: Clone>(value: T, len: usize, what: impl Display) -> Result<Vec<T>> {
    let mut list = empty(len, what)?;
    list.resize(len, value);
    Ok(list)
}

/// An empty list with room for `len`.
///
/// # Errors
/// One line that says what the memory was for.
pub fn empty<T>(len: usize, what: impl Display) -> Result<Vec<T>> {
    let mut list = Vec::new();
    list.try_reserve_exact(len).map_err(|_| too_little(len, size_of::<T>(), &what))?;
    Ok(list)
}

/// Appends an item to a list, which doubles as it fills.
///
/// # Errors
/// One line that says what the memory was for.
pub fn push<T>(list: &mut Vec<T>, item: T, what: impl Display) -> Result<()> {
    list.try_reserve(1).map_err(|_| too_little(list.len().saturating_mul(2), size_of::<T>(), &what))?;
    list.push(item);
    Ok(())
}

/// Tries whether so much memory can be had, for what allocates piece by piece.
///
/// # Errors
/// One line that says what the memory was for.
pub fn expect(bytes: usize, what: impl Display) -> Result<()> {
    empty::<u8>(bytes, what).map(drop)
}

/// Tries whether there is memory for a list of `T`, as long as the product of `factors`.
///
/// # Errors
/// One line that says what the memory was for.
pub fn expect_list<T>(factors: &[usize], what: impl Display) -> Result<()> {
    expect(factors.iter().fold(size_of::<T>(), |bytes, factor| bytes.saturating_mul(*factor)), what)
}

fn too_little(len: usize, size: usize, what: &dyn Display) -> Error {
    let gigabytes = len as f64 * size as f64 * 1e-9;
    Error::failed(format_args!("not enough memory for {what}, which takes {gigabytes:.2} GB; ask for less"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_fits_is_made_and_what_does_not_is_told() {
        assert_eq!(filled(7u8, 3, "three").unwrap(), [7; 3]);
        let mut list = Vec::new();
        push(&mut list, 1, "one").unwrap();
        assert_eq!(list, [1]);
        let message = filled(0u64, usize::MAX / 4, "a picture").unwrap_err().to_string();
        assert!(message.starts_with("not enough memory for a picture, which takes "), "{message}");
        assert!(expect(usize::MAX, "all").is_err() && expect(1 << 10, "some").is_ok());
        assert!(expect_list::<f64>(&[usize::MAX, 2], "all").is_err() && expect_list::<f64>(&[9, 9], "some").is_ok());
    }
}
