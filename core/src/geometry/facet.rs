//! Facets, the plane pieces of a micro-surface, and the errors for which a cell of facets is refused.

use glam::DVec3;

/// A plane piece of the micro-surface, which divides two media.
///
/// All coplanar polygons that a cell counts as one facet share its anchor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Facet {
    /// Unit normal, which points to the medium `above` of its interface.
    pub normal: DVec3,
    /// A fixed point of the plane in nanometres, to which amplitudes are referred.
    pub anchor_nm: DVec3,
    /// Index of the interface in the list of the cell.
    pub interface: u16,
}

impl Facet {
    /// A horizontal facet at height z that faces upwards.
    #[must_use]
    pub fn horizontal(z_nm: f64, interface: u16) -> Self {
        Self { normal: DVec3::Z, anchor_nm: DVec3::new(0.0, 0.0, z_nm), interface }
    }
}

/// An error in a cell, for which it is refused.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CellError {
    /// The cell has no facets, or a mesh names no facet for some of its triangles.
    Empty,
    /// A facet has a coordinate that is NaN or infinite, or a triangle names a facet beyond the list.
    NotFinite {
        /// Index of the facet.
        facet: usize,
    },
    /// A facet names an interface beyond the list.
    NoInterface {
        /// Index of the facet.
        facet: usize,
    },
    /// A facet of a planar cell has a normal other than +z.
    Tilted {
        /// Index of the facet.
        facet: usize,
    },
    /// A facet of a planar cell lies above its predecessor: they must be in order from the top.
    OutOfOrder {
        /// Index of the facet.
        facet: usize,
    },
    /// The period is not positive and finite, or the mesh leaves it.
    Period,
    /// A coating has a film whose thickness is negative or not finite.
    Coating {
        /// Index of the interface.
        interface: usize,
    },
    /// The medium above a facet of a planar cell is not the one below its predecessor.
    MediaDiffer {
        /// Index of the facet.
        facet: usize,
    },
}

impl core::fmt::Display for CellError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match *self {
            Self::Empty => write!(f, "the cell has no facets, or not one for each triangle"),
            Self::NotFinite { facet } => {
                write!(f, "facet {facet} does not exist, or has a coordinate that is not finite")
            }
            Self::NoInterface { facet } => write!(f, "facet {facet} names an interface that the cell does not have"),
            Self::Tilted { facet } => write!(f, "facet {facet} is not a horizontal plane facing upwards"),
            Self::Period => write!(f, "the period must be positive and hold the whole mesh, from 0"),
            Self::Coating { interface } => {
                write!(f, "the coating of interface {interface} has a thickness that is negative or not finite")
            }
            Self::OutOfOrder { facet } => write!(f, "facet {facet} lies above the one before it"),
            Self::MediaDiffer { facet } => {
                write!(f, "the medium above facet {facet} is not the one below the facet before it")
            }
        }
    }
}

impl core::error::Error for CellError {}
