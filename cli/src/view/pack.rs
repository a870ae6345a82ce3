//! Arrays of numbers as text in a page: little-endian, in base64.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use exr::prelude::f16;
use serde_json::Value;

/// Packs 32-bit floats.
pub(super) fn floats(values: impl IntoIterator<Item = f32>) -> Value {
    encoded(values.into_iter().flat_map(f32::to_le_bytes))
}

/// Packs numbers as 16-bit floats.
pub(super) fn halves(values: impl IntoIterator<Item = f32>) -> Value {
    encoded(values.into_iter().flat_map(|value| f16::from_f32(value).to_le_bytes()))
}

/// Packs numbers from −1 to 1 in steps of 1/32767.
pub(super) fn signed(values: impl IntoIterator<Item = f64>) -> Value {
    let step = f64::from(i16::MAX);
    encoded(values.into_iter().flat_map(|value| ((value.clamp(-1.0, 1.0) * step).round() as i16).to_le_bytes()))
}

/// Packs whole numbers below 65536.
pub(super) fn indices(values: impl IntoIterator<Item = u16>) -> Value {
    encoded(values.into_iter().flat_map(u16::to_le_bytes))
}

fn encoded(bytes: impl Iterator<Item = u8>) -> Value {
    STANDARD.encode(bytes.collect::<Vec<u8>>()).into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_little_endian() {
        assert_eq!(floats([1.0]), "AACAPw==");
        assert_eq!(halves([1.0, -2.0]), "ADwAwA==");
        assert_eq!(signed([1.0, -1.0, 2.0]), "/38BgP9/");
        assert_eq!(indices([1, 256]), "AQAAAQ==");
    }
}
