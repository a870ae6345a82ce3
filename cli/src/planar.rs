//! A scene as a planar cell: what the tracer and the closed form are given.

use goniochrome::cell::{Cell, Facet};
use goniochrome::interface::{Below, Interface};
use goniochrome::medium::Medium;
use goniochrome::stack::{Boundary, Film, Stack, StackMemory};

use crate::error::{Error, Result};
use crate::scene::{Scene, Shape};

/// The facets of a planar scene, from the top, and what they divide.
#[derive(Debug, Clone)]
pub struct Planar<'s> {
    scene: &'s Scene,
    facets: Vec<Facet>,
    interfaces: Vec<Interface>,
}

/// Memory that a [`Stack`] borrows.
#[derive(Debug)]
pub struct StackBuffer {
    interfaces: Vec<Interface>,
    films: Vec<Film>,
    boundaries: Vec<Boundary>,
}

impl<'s> Planar<'s> {
    /// The planes of a scene: those of a mesh, or those between the layers of a stack.
    ///
    /// # Errors
    /// A mesh of tilted facets.
    pub fn new(scene: &'s Scene) -> Result<Self> {
        let planes: Vec<(f64, Interface)> = match &scene.shape {
            Shape::Stack { ambient, layers, substrate } => {
                let mut z_nm = 0.0;
                let mut above = *ambient;
                let mut planes = Vec::with_capacity(layers.len() + 1);
                for layer in layers {
                    planes.push((z_nm, Interface { above, below: Below::Medium(layer.medium) }));
                    z_nm -= layer.thickness_nm;
                    above = layer.medium;
                }
                planes.push((z_nm, Interface { above, below: *substrate }));
                planes
            }
            Shape::Planes(flat) => flat.planes().iter().map(|plane| (plane.z_nm, plane.interface)).collect(),
            Shape::Mesh(_) => {
                return Err(Error::failed(format_args!(
                    "{}: has tilted facets, which scatter light; use estimate for its BRDF table and colours, scatter or orders \
                     for one direction of the light",
                    scene.name
                )));
            }
        };
        let mut interfaces: Vec<Interface> = Vec::new();
        let mut facets = Vec::with_capacity(planes.len());
        for (z_nm, interface) in planes {
            let place = interfaces.iter().position(|known| *known == interface).unwrap_or_else(|| {
                interfaces.push(interface);
                interfaces.len() - 1
            });
            let place = u16::try_from(place).map_err(|_| Error::failed("the scene has more than 65535 interfaces"))?;
            facets.push(Facet::horizontal(z_nm, place));
        }
        let planar = Self { scene, facets, interfaces };
        planar.cell()?;
        Ok(planar)
    }

    /// The checked cell.
    fn cell(&self) -> Result<Cell<'_>> {
        let named = |error| Error::failed(format_args!("{}: {error}", self.scene.name));
        Cell::new(&self.facets, &self.interfaces).map_err(named)
    }

    /// Memory for [`Planar::stack`].
    #[must_use]
    pub fn buffer(&self) -> StackBuffer {
        let planes = self.facets.len();
        StackBuffer {
            interfaces: vec![Interface { above: 0, below: Below::Mirror }; planes],
            films: vec![Film { medium: 0, thickness_nm: 0.0 }; planes],
            boundaries: vec![Boundary::default(); planes],
        }
    }

    /// The scene as a multilayer.
    ///
    /// # Errors
    /// None for a buffer of this scene.
    pub fn stack<'b>(&self, buffer: &'b mut StackBuffer) -> Result<Stack<'b>> {
        let StackBuffer { interfaces, films, boundaries } = buffer;
        let memory = StackMemory { interfaces, films, boundaries };
        self.cell()?.stack(memory).map_err(|error| Error::failed(format_args!("{}: {error}", self.scene.name)))
    }

    /// The media, in the scene's order.
    #[must_use]
    pub fn media(&self) -> Vec<Medium<'s>> {
        self.scene.media.iter().map(|named| named.medium.borrow()).collect()
    }

    /// Σ n d of the layers, with the largest n that each shows in a range of wavelengths.
    ///
    /// # Errors
    /// If a medium has no data there.
    pub fn longest_optical_path_nm(&self, [first, last]: [f64; 2]) -> Result<f64> {
        const PROBES: u32 = 16;
        let mut buffer = self.buffer();
        let stack = self.stack(&mut buffer)?;
        let media = self.media();
        let mut largest = Vec::with_capacity(media.len());
        for (index, medium) in media.iter().enumerate() {
            let mut most: f64 = 0.0;
            for i in 0..=PROBES {
                let nm = first + (last - first) * f64::from(i) / f64::from(PROBES);
                most = most.max(medium.eta(nm).map_err(|error| self.scene.medium_error(index, &error))?.re);
            }
            largest.push(most);
        }
        let path = |j| largest[usize::from(stack.film(j).medium)] * stack.film(j).thickness_nm;
        Ok((0..stack.planes() - 1).map(path).sum())
    }

    /// Layers between the outer media.
    #[must_use]
    pub fn layers(&self) -> usize {
        self.facets.len() - 1
    }

    /// The scene.
    #[must_use]
    pub fn scene(&self) -> &'s Scene {
        self.scene
    }
}
