//! Fuzzing of refractive index files of both formats from any text. A medium that can be read is passive wherever it
//! can be evaluated.

use goniochrome_cli::scene::{self, OwnedMedium};
use goniochrome_cli::support::error::Error;

/// Checks any bytes that are text.
pub fn check(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    for read in [scene::parse_nk("fuzz.yml", text), scene::parse_columns("fuzz.csv", text)] {
        passive(read);
    }
}

/// Checks that a medium, if it was read, is passive.
fn passive(read: Result<OwnedMedium, Error>) {
    match read {
        Err(error) => assert!(!error.to_string().contains('\n')),
        Ok(owned) => {
            let medium = owned.borrow();
            let [from, to] = medium.range_nm();
            assert!(from <= to);
            assert!(owned.note(&[from, 550.0]).is_none_or(|said| !said.contains('\n')));
            for nm in [from, to, 380.0, 555.5, 780.0] {
                match medium.eta(nm) {
                    Ok(eta) => assert!(eta.re > 0.0 && eta.im >= 0.0 && eta.is_finite()),
                    Err(error) => assert!(!owned.describe(&error).contains('\n')),
                }
            }
        }
    }
}
