//! Fuzzing of maps of one number a pixel from any bytes. A map that can be read is full and finite.

use goniochrome_cli::support::grey_map::decode;

/// Checks any bytes.
pub fn check(bytes: &[u8]) {
    match decode("fuzz", bytes) {
        Err(error) => assert!(!error.to_string().contains('\n')),
        Ok(map) => {
            let [width, height] = map.size;
            assert!(width > 0 && height > 0 && map.values.len() == width * height);
            // The least of a signed type is a step below −1: −128/127.
            let range = if map.integer { -1.01..=1.0 } else { f32::MIN..=f32::MAX };
            assert!(map.values.iter().all(|x| range.contains(x)));
        }
    }
}
