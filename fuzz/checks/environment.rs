//! Fuzzing of environment maps from any bytes. A map that can be read covers the sphere with finite radiance.

use goniochrome_cli::render::decode::decode;

/// Checks any bytes.
pub fn check(bytes: &[u8]) {
    match decode("fuzz.hdr", bytes) {
        Err(error) => assert!(!error.to_string().contains('\n')),
        Ok((image, repairs)) => {
            let [width, height] = image.size();
            assert!(width == 2 * height && image.texels().len() == width * height);
            assert!(image.texels().iter().flatten().all(|x| x.is_finite() && *x >= 0.0));
            assert!(repairs.notes().iter().all(|said| !said.contains('\n')));
        }
    }
}
