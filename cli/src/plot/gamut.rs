//! Counts of the colours of a picture that lie outside the gamut of sRGB, and were changed by the policy of
//! [`super::encode`].

use std::ops::{Add, AddAssign};

/// Smallest component that counts as in gamut: half the first step of 8-bit sRGB below black, where the slope is 12.92.
const MIN_COMPONENT: f32 = -0.5 / 255.0 / 12.92;
/// Largest component that counts as in gamut: half a step of 8-bit sRGB above white, where the slope is 1.055/2.4.
const MAX_COMPONENT: f32 = 1.0 + 0.5 / 255.0 * 2.4 / 1.055;

/// Counts of colours (pixels or swatches), and of those out of gamut.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct OutOfGamut {
    /// Number of colours more saturated than sRGB: a component is negative.
    pub saturated: usize,
    /// Number of colours brighter than white: a component is above 1.
    pub bright: usize,
    /// Number of all colours that show data.
    pub all: usize,
}

impl OutOfGamut {
    /// The count of one colour in linear sRGB.
    #[must_use]
    pub fn of(linear: [f32; 3]) -> Self {
        let saturated = linear.iter().any(|&c| c < MIN_COMPONENT);
        let bright = linear.iter().any(|&c| c > MAX_COMPONENT);
        Self { saturated: saturated.into(), bright: bright.into(), all: 1 }
    }

    /// The message for the user; `None` if all colours are shown unchanged.
    #[must_use]
    pub fn note(self) -> Option<String> {
        let share = |count: usize| match 100.0 * count as f64 / self.all.max(1) as f64 {
            percent if percent < 0.1 => "under 0.1 %".to_owned(),
            percent => format!("{percent:.1} %"),
        };
        let parts = [
            (self.saturated, "are more saturated than sRGB and were made paler"),
            (self.bright, "are brighter than white and were scaled down"),
        ];
        let said: Vec<String> = parts
            .into_iter()
            .filter(|(count, _)| *count > 0)
            .map(|(count, what)| format!("{} {what}", share(count)))
            .collect();
        (!said.is_empty()).then(|| format!("of the colours shown, {}", said.join(", ")))
    }
}

impl Add for OutOfGamut {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            saturated: self.saturated + other.saturated,
            bright: self.bright + other.bright,
            all: self.all + other.all,
        }
    }
}

impl AddAssign for OutOfGamut {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plot::srgb8;

    #[test]
    fn what_counts_is_what_changes() {
        let count = |rgb| {
            let OutOfGamut { saturated, bright, all } = OutOfGamut::of(rgb);
            [saturated, bright, all]
        };
        assert_eq!(count([0.2, 1.0, 0.0]), [0, 0, 1]);
        assert_eq!(count([-0.01, 0.5, 1.2]), [1, 1, 1]);
        // Too little to see.
        assert_eq!((count([0.5, 0.5, -1e-4]), srgb8([0.5, 0.5, -1e-4])), ([0, 0, 1], srgb8([0.5, 0.5, 0.0])));
        assert_eq!((count([0.5, 0.5, 1.004]), srgb8([0.0, 0.0, 1.004])), ([0, 0, 1], [0, 0, 255]));
    }

    #[test]
    fn only_changes_are_told() {
        assert_eq!(OutOfGamut { all: 7, ..OutOfGamut::default() }.note(), None);
        let said = OutOfGamut { saturated: 1, bright: 250, all: 2000 }.note().unwrap();
        assert_eq!(
            said,
            "of the colours shown, under 0.1 % are more saturated than sRGB and were made paler, \
             12.5 % are brighter than white and were scaled down"
        );
    }
}
