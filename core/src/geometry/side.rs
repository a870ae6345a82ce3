//! The two sides of a surface.

/// A side of a plane.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// The side of the incident light.
    Above,
    /// The side of the substrate.
    Below,
}
