//! Fuzzing of table files from any bytes. A table that can be read is sound, and stays equal when written and read
//! again.

use goniochrome_cli::table::file::{decode, encode};

/// Checks any bytes.
pub fn check(bytes: &[u8]) {
    match decode(bytes) {
        Err(error) => assert!(!error.to_string().contains('\n')),
        Ok(table) => {
            table.check().expect("decode checks");
            let again = encode(&table, 1).expect("what was read can be written");
            assert_eq!(decode(&again).expect("what was written can be read"), table);
        }
    }
}
