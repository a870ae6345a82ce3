//! How many colours of a picture lie outside the gamut of sRGB, and so were changed by the policy of [`super::encode`].

use std::ops::{Add, AddAssign};

/// A negative component counts beyond half the first step of 8-bit sRGB above black, whose slope there is 12.92.
const BELOW: f32 = -0.5 / 255.0 / 12.92;
/// A component above 1 counts beyond half a step of 8-bit sRGB below white, whose slope there is 1.055/2.4.
const ABOVE: f32 = 1.0 + 0.5 / 255.0 * 2.4 / 1.055;

/// Counts of colours: pixels, or swatches.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct OutOfGamut {
    /// More saturated than sRGB: a component is negative.
    pub saturated: usize,
    /// Brighter than white: a component is above 1.
    pub bright: usize,
    /// All that show the data.
    pub all: usize,
}

impl OutOfGamut {
    /// One colour, in linear sRGB.
    #[must_use]
    pub fn of(linear: [f32; 3]) -> Self {
        let saturated = linear.iter().any(|&c| c < BELOW);
        let bright = linear.iter().any(|&c| c > ABOVE);
        Self { saturated: saturated.into(), bright: bright.into(), all: 1 }
    }

    /// What to tell the user; nothing where all colours are shown as they are.
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
