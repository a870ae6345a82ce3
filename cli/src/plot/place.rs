//! Boxes on the canvas, and the rounding of coordinates.

/// A box on the canvas, in SVG units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Place {
    pub x: f64,
    pub y: f64,
    pub width: f64,
    pub height: f64,
}

impl Place {
    /// Coordinate of the right edge.
    pub(super) fn right(&self) -> f64 {
        self.x + self.width
    }

    /// Coordinate of the lower edge.
    pub(super) fn bottom(&self) -> f64 {
        self.y + self.height
    }

    /// The box with all its edges moved outwards by a distance.
    pub(super) fn grown(&self, by: f64) -> Self {
        Self { x: self.x - by, y: self.y - by, width: self.width + 2.0 * by, height: self.height + 2.0 * by }
    }

    /// The box with its numbers rounded as in the SVG document.
    pub(super) fn rounded(&self) -> Self {
        let [x, y, width, height] = [self.x, self.y, self.width, self.height].map(number);
        Self { x, y, width, height }
    }
}

impl std::fmt::Display for Place {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { x, y, width, height } = self.rounded();
        write!(f, "x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\"")
    }
}

/// Rounds a coordinate to hundredths of a pixel, which are enough and keep files small.
pub(super) fn number(value: f64) -> f64 {
    (value * 100.0).round() / 100.0 + 0.0
}
