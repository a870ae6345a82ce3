//! Storage of a table's values: numbers in memory, or the bytes of a blob.

/// Values of a table, read by index. An index beyond the end reads 0, so look-ups cannot fail.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Values<'a> {
    /// Single-precision numbers.
    Numbers(&'a [f32]),
    /// Bytes of IEEE 754 binary32, little endian.
    Single(&'a [[u8; 4]]),
    /// Bytes of IEEE 754 binary16, little endian.
    Half(&'a [[u8; 2]]),
}

impl<'a> Values<'a> {
    #[inline]
    pub fn len(self) -> usize {
        match self {
            Self::Numbers(numbers) => numbers.len(),
            Self::Single(bytes) => bytes.len(),
            Self::Half(bytes) => bytes.len(),
        }
    }

    #[inline]
    pub fn at(self, place: usize) -> f32 {
        let number = match self {
            Self::Numbers(numbers) => numbers.get(place).copied(),
            Self::Single(bytes) => bytes.get(place).map(|&bytes| f32::from_le_bytes(bytes)),
            Self::Half(bytes) => bytes.get(place).map(|&bytes| from_half(u16::from_le_bytes(bytes))),
        };
        number.unwrap_or(0.0)
    }

    /// The `N` values from each of some indices; 0 where one lies beyond the end.
    #[inline]
    pub fn arrays<const N: usize, const M: usize>(self, from: [usize; M]) -> [[f32; N]; M] {
        fn chunk<T, const N: usize>(all: &[T], from: usize) -> Option<&[T; N]> {
            all.get(from..)?.first_chunk()
        }
        let none = [0.0; N];
        match self {
            Self::Numbers(numbers) => from.map(|from| chunk(numbers, from).copied().unwrap_or(none)),
            Self::Single(bytes) => {
                from.map(|from| chunk(bytes, from).map_or(none, |bytes| bytes.map(f32::from_le_bytes)))
            }
            Self::Half(bytes) => {
                let number = |bytes| from_half(u16::from_le_bytes(bytes));
                from.map(|from| chunk(bytes, from).map_or(none, |bytes| bytes.map(number)))
            }
        }
    }

    /// The first three of `count` values from an index, the last repeated if there are fewer.
    #[inline]
    pub fn three(self, from: usize, count: usize) -> [f32; 3] {
        if count < 3 {
            return [0, 1, 1].map(|place: usize| self.at(from + place.min(count.saturating_sub(1))));
        }
        let [three] = self.arrays([from]);
        three
    }

    /// The `count` values from an index; empty if there are fewer.
    #[inline]
    pub fn part(self, from: usize, count: usize) -> Self {
        let range = from..from.saturating_add(count);
        match self {
            Self::Numbers(numbers) => Self::Numbers(numbers.get(range).unwrap_or(&[])),
            Self::Single(bytes) => Self::Single(bytes.get(range).unwrap_or(&[])),
            Self::Half(bytes) => Self::Half(bytes.get(range).unwrap_or(&[])),
        }
    }

    /// Index of the first value that is NaN or of a larger magnitude.
    pub fn first_beyond(self, magnitude: f32) -> Option<usize> {
        self.iter().position(|x| !(-magnitude..=magnitude).contains(&x))
    }

    pub fn iter(self) -> impl Iterator<Item = f32> + use<'a> {
        (0..self.len()).map(move |place| self.at(place))
    }
}

/// Ratio of the exponent biases of single and half precision, as a factor: 2^(127 − 15).
const REBIAS: f32 = (1u128 << 112) as f32;
/// Exponent bits of half precision, all set: infinities and NaN.
const HALF_EXPONENT: u16 = 0x7c00;

/// Converts half to single precision, exactly, subnormal numbers included. Infinities become 65536 and NaN more.
#[inline]
fn from_half(bits: u16) -> f32 {
    let sign = u32::from(bits & 0x8000) << 16;
    let magnitude = f32::from_bits(u32::from(bits & 0x7fff) << 13) * REBIAS;
    f32::from_bits(magnitude.to_bits() | sign)
}

/// Whether half-precision bits are neither infinite nor NaN.
pub(crate) fn half_is_finite(bits: u16) -> bool {
    bits & HALF_EXPONENT != HALF_EXPONENT
}

/// Rounds to the nearest half-precision number, ties to even; `None` if that is infinite, or for NaN.
pub(crate) fn to_half(x: f32) -> Option<u16> {
    const MIN_NORMAL: f32 = 1.0 / 16384.0;
    /// Inverse of the step between subnormal numbers, 2^−24.
    const STEPS: f32 = 16_777_216.0;
    let (sign, magnitude) = ((x.to_bits() >> 16) as u16 & 0x8000, x.abs());
    let bits = if magnitude < MIN_NORMAL {
        libm::rintf(magnitude * STEPS) as u32
    } else {
        let bits = magnitude.to_bits();
        ((bits + 0xfff + (bits >> 13 & 1)) >> 13) - (112 << 10)
    };
    (bits < u32::from(HALF_EXPONENT)).then_some(bits as u16 | sign)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_half_precision_number_returns() {
        for bits in (0..=u16::MAX).filter(|&bits| half_is_finite(bits)) {
            assert_eq!(to_half(from_half(bits)), Some(bits), "{bits:#x}");
        }
    }

    #[test]
    fn numbers_round_to_the_nearest_half_ties_to_even() {
        for (x, bits) in [
            (1.0, Some(0x3c00)),
            (-2.0, Some(0xc000)),
            (1.0 + 1.0 / 2048.0, Some(0x3c00)),
            (1.0 + 3.0 / 2048.0, Some(0x3c02)),
            (1.0 / 16_777_216.0, Some(0x0001)),
            (1e-9, Some(0)),
            (65504.0, Some(0x7bff)),
            (65519.9, Some(0x7bff)),
            (65520.0, None),
            (f32::INFINITY, None),
            (f32::NAN, None),
        ] {
            assert_eq!(to_half(x), bits, "{x}");
        }
        for i in 0..60_000u32 {
            let x = 1.1f32.powi((i / 200) as i32 - 160) * (1.0 + i as f32 / 60_000.0);
            if let Some(bits) = to_half(x).filter(|_| x < 65504.0) {
                let near = |bits| (f64::from(from_half(bits)) - f64::from(x)).abs();
                let neighbours = [bits.saturating_sub(1), bits + 1];
                assert!(neighbours.iter().all(|&other| near(bits) <= near(other)), "{x}");
            }
        }
    }

    #[test]
    fn places_beyond_the_end_hold_nothing() {
        let values = Values::Single(&[[0, 0, 0x80, 0x3f]]);
        assert_eq!((values.at(0), values.at(1), values.len()), (1.0, 0.0, 1));
        assert_eq!(values.part(0, 2).len(), 0);
        assert_eq!(values.part(usize::MAX, 2).len(), 0);
    }
}
