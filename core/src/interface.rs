//! One plane between two media: which media, and how a plane wave divides there.

use crate::medium::MediumIndex;

/// What lies below an interface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Below {
    /// A medium of the scene.
    Medium(MediumIndex),
    /// A perfect mirror: the limit of infinite conductivity, r_s = −1 and r_p = +1 at every angle and wavelength.
    Mirror,
}

/// The pair of media that a plane divides; `above` is the side its normal points to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Interface {
    /// The medium on the normal's side.
    pub above: MediumIndex,
    /// What lies on the other side.
    pub below: Below,
}
