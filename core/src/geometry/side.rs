//! The two sides of a surface.

/// A side of the surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// The side from which the light comes.
    Above,
    /// The side of the substrate.
    Below,
}
