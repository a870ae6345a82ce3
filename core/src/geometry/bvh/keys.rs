//! Numbers of a node's eight boxes side by side, and keys that order them.

/// One number for each of the eight boxes of a node of the bounding volume hierarchy.
pub(super) type BoxLanes = wide::f32x8;

/// Keys of eight non-negative numbers that compare as integers do, each with its lane in the last three bits: the
/// smallest key also says where its number is.
#[derive(Clone, Copy, PartialEq)]
pub(super) struct OrderedKeys(wide::u32x8);

impl OrderedKeys {
    /// Keys of no numbers.
    pub(super) const MAX: Self = Self(wide::u32x8::MAX);
    /// Bits of a key that hold its lane.
    const LANE: u32 = 7;

    /// Keys of the numbers in the lanes that the mask `valid` selects.
    #[inline]
    pub(super) fn new(numbers: BoxLanes, valid: BoxLanes) -> Self {
        let [bits, valid]: [wide::u32x8; 2] = [numbers, valid].map(wide::bytemuck::cast);
        Self((bits & wide::u32x8::splat(!Self::LANE)) | wide::u32x8::new([0, 1, 2, 3, 4, 5, 6, 7]) | !valid)
    }

    /// The largest key of a number in any lane; 0 if it is negative or NaN.
    #[inline]
    pub(super) fn key(number: f32) -> u32 {
        if number >= 0.0 { number.to_bits() | Self::LANE } else { 0 }
    }

    /// Takes the smallest key, `u32::MAX` if there is none, and returns it with the others.
    #[inline]
    pub(super) fn take_min(self) -> (u32, Self) {
        let min = self.0.reduce_min();
        (min, Self(self.0 | self.0.simd_eq(wide::u32x8::splat(min))))
    }
}
