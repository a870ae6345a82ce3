//! Any text as a refractive index file. What is read is passive wherever it can be evaluated.

use goniochrome_cli::scene;

/// Holds for any bytes; those that are no text are no input.
pub fn check(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    match scene::parse_nk("fuzz.yml", text) {
        Err(error) => assert!(!error.to_string().contains('\n')),
        Ok(owned) => {
            let medium = owned.borrow();
            let [from, to] = medium.range_nm();
            assert!(from <= to);
            for nm in [from, to, 380.0, 555.5, 780.0] {
                if let Ok(eta) = medium.eta(nm) {
                    assert!(eta.re > 0.0 && eta.im >= 0.0 && eta.is_finite());
                }
            }
        }
    }
}
