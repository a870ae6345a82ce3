//! A scene as plain data: its media, and what lies where.

use std::path::PathBuf;

use goniochrome::optics::interface::Below;
use goniochrome::optics::medium::{MediumError, MediumIndex};

use super::finish::OwnedFinish;
use super::mesh::Mesh;
use super::parts::{Layer, NamedInterface, NamedMedium};
use super::planes::FlatCell;
use super::watertight::ClosedCell;
use crate::support::error::{Error, Result};

/// Scene: media, and the surface that they form.
#[derive(Clone, Debug)]
pub struct Scene {
    /// Name of the scene: its own, else that of the preset or file.
    pub name: String,
    /// Scene file as read, for the metadata of what is made from it.
    pub toml: String,
    /// Every medium in use, each once; a [`MediumIndex`] counts in this list.
    pub media: Vec<NamedMedium>,
    /// Geometry: a stack of layers, or a cell.
    pub shape: Shape,
    /// Roughness of a planar scene, if it is no mirror.
    pub finish: Option<OwnedFinish>,
    /// Coherence between the periods of a cell, if the scene names it.
    pub periods: Option<Periods>,
    /// Medium in front of a thick plate, if the cell's uppermost medium is one: light arrives in it, through the
    /// plate's plane front face.
    pub front: Option<MediumIndex>,
    /// What commands say about the surface on standard error.
    pub notes: Vec<String>,
    /// Every file that was read, canonical, so that writing over an input can be refused.
    pub files: Vec<PathBuf>,
}

impl Scene {
    /// Error of the command line for an `error` of the medium of this index, with the medium's name. A command whose
    /// user chooses the wavelengths adds its remedy: see [`Error::with_remedy`].
    pub(crate) fn medium_error(&self, index: usize, error: &MediumError) -> Error {
        let NamedMedium { name, medium } = &self.media[index];
        let line = format!("{}: material {name}: {}", self.name, medium.describe(error));
        match error {
            MediumError::OutOfRange { .. } => Error::no_data(line),
            _ => Error::failed(line),
        }
    }
}

/// Coherence between the periods of a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Periods {
    /// Periods are exact copies of one another: light leaves in sharp diffraction orders.
    Coherent,
    /// Periods differ at random, in height for example: light from different periods does not interfere, and each order
    /// spreads over the directions between its neighbours.
    Random,
}

/// Geometry of a scene. [`Shape::of_mesh`] alone decides which kind a mesh is, and makes the check of that kind.
#[derive(Clone, Debug)]
pub enum Shape {
    /// Plane layers.
    Stack {
        /// Medium in which light arrives.
        ambient: MediumIndex,
        /// Layers from the top, repetitions written out.
        layers: Vec<Layer>,
        /// Medium or mirror under the last layer.
        substrate: Below,
    },
    /// A mesh of horizontal planes, periodic in x and y.
    Planes(FlatCell),
    /// A mesh of other facets, periodic in x and y: it scatters light.
    Mesh(ClosedCell),
}

impl Shape {
    /// Checks a mesh and decides its kind. `interfaces` are what its triangles count, `media` what these divide.
    ///
    /// # Errors
    /// One line that names the first facet at fault, the place and the remedy: no command traces a mesh with a hole.
    pub fn of_mesh(
        mesh: Mesh,
        period_nm: [f64; 2],
        interfaces: Vec<NamedInterface>,
        media: &[NamedMedium],
    ) -> Result<Self> {
        match FlatCell::new(&mesh, period_nm, &interfaces, media)? {
            Some(flat) => Ok(Self::Planes(flat)),
            None => ClosedCell::new(mesh, period_nm, interfaces, media).map(Self::Mesh),
        }
    }

    /// Polygons of a cell, also of one of horizontal planes; `None` for a stack.
    #[must_use]
    pub fn polygons(&self) -> Option<&ClosedCell> {
        match self {
            Self::Stack { .. } => None,
            Self::Planes(flat) => Some(flat.polygons()),
            Self::Mesh(closed) => Some(closed),
        }
    }
}
