//! The plane facet of a micro-surface, and the errors of the cells that are made of facets.

use glam::DVec3;

/// A plane of the micro-surface that divides two media.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Facet {
    /// Unit normal, pointing to the medium `above` of its interface.
    pub normal: DVec3,
    /// A fixed point of the plane in nanometres: amplitudes are referred to it.
    pub anchor_nm: DVec3,
    /// Which interface of the cell.
    pub interface: u16,
}

impl Facet {
    /// A horizontal plane at height z that faces upwards.
    #[must_use]
    pub fn horizontal(z_nm: f64, interface: u16) -> Self {
        Self { normal: DVec3::Z, anchor_nm: DVec3::new(0.0, 0.0, z_nm), interface }
    }
}

/// Why a cell was refused; the index is that of the facet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CellError {
    /// No facets.
    Empty,
    /// A coordinate that is NaN or infinite.
    NotFinite {
        /// The facet.
        facet: usize,
    },
    /// The interface index is beyond the list.
    NoInterface {
        /// The facet.
        facet: usize,
    },
    /// The facet's normal is not +z: this release cannot trace it.
    Tilted {
        /// The facet.
        facet: usize,
    },
    /// The facet lies above its predecessor; facets stand in order from the top.
    OutOfOrder {
        /// The facet.
        facet: usize,
    },
    /// The period is not positive, or the mesh leaves it.
    Period,
    /// A coating has a film of negative or non-finite thickness.
    Coating {
        /// The interface.
        interface: usize,
    },
    /// The medium above this facet is not the one below its predecessor.
    MediaDiffer {
        /// The facet.
        facet: usize,
    },
}

impl core::fmt::Display for CellError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match *self {
            Self::Empty => write!(f, "the cell has no facets"),
            Self::NotFinite { facet } => write!(f, "facet {facet} has a coordinate that is not finite"),
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
