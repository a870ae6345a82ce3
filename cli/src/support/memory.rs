//! Memory whose size a user chooses.
//!
//! A `vec!` that finds no memory aborts the program without naming the cause. What grows with a file, a picture or a
//! table is allocated here instead; the error names its purpose. Systems that promise more memory than they have may
//! still stop the program later; stated limits, not these functions, keep sizes within reason.

use std::fmt::Display;

use crate::support::error::{Error, Result};

/// List of `len` copies of `value`.
///
/// # Errors
/// Too little memory; the line says what it was for.
pub fn filled<T: Clone>(value: T, len: usize, what: impl Display) -> Result<Vec<T>> {
    let mut list = empty(len, what)?;
    list.resize(len, value);
    Ok(list)
}

/// Empty list with room for `len` items.
///
/// # Errors
/// Too little memory; the line says what it was for.
pub fn empty<T>(len: usize, what: impl Display) -> Result<Vec<T>> {
    let mut list = Vec::new();
    list.try_reserve_exact(len).map_err(|_| too_little(len, size_of::<T>(), &what))?;
    Ok(list)
}

/// Appends an item to a list, which doubles as it fills.
///
/// # Errors
/// Too little memory; the line says what it was for.
pub fn push<T>(list: &mut Vec<T>, item: T, what: impl Display) -> Result<()> {
    list.try_reserve(1).map_err(|_| too_little(list.len().saturating_mul(2), size_of::<T>(), &what))?;
    list.push(item);
    Ok(())
}

/// Checks that so much memory is available, for code that allocates piece by piece.
///
/// # Errors
/// Too little memory; the line says what it was for.
pub fn expect(bytes: usize, what: impl Display) -> Result<()> {
    empty::<u8>(bytes, what).map(drop)
}

/// Checks that memory is available for a list of `T` as long as the product of `factors`.
///
/// # Errors
/// Too little memory; the line says what it was for.
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
