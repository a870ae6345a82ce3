//! A planar scene as a multilayer, in the form that the planar tracer and the closed form take.

use goniochrome::geometry::facet::Facet;
use goniochrome::geometry::planar_cell::PlanarCell;
use goniochrome::optics::interface::{Below, Interface};
use goniochrome::optics::medium::{Medium, MediumIndex};
use goniochrome::optics::stack::{Boundary, Film, Stack, StackMemory};

use crate::scene::{Layer, Plane, Scene, Shape, ThicknessSpread};
use crate::solve::groups::media_of;
use crate::support::error::{Error, Result};

/// A planar scene as a multilayer: the layers of its stack, or the planes of its mesh.
#[derive(Debug, Clone)]
pub struct PlanarScene<'s> {
    scene: &'s Scene,
    ambient: MediumIndex,
    layers: Vec<Film>,
    substrate: Below,
    spreads: Vec<Spread>,
}

/// Gaussian variation of thickness that some layers share.
#[derive(Debug, Clone, PartialEq)]
pub struct Spread {
    /// Standard deviation of each layer.
    sigma_nm: f64,
    /// The entry of the scene file.
    entry: u32,
    /// Places of the layers.
    layers: Vec<usize>,
}

/// Standard deviations to either side over which thicknesses are averaged. Beyond lie 6e-7 of a Gaussian.
pub(super) const SPREAD_SIGMAS: f64 = 5.0;

/// Memory that a [`Stack`] borrows: its interfaces, films and boundaries.
#[derive(Debug)]
pub struct StackBuffer {
    interfaces: Vec<Interface>,
    films: Vec<Film>,
    boundaries: Vec<Boundary>,
}

impl StackBuffer {
    fn for_planes(planes: usize) -> Self {
        Self {
            interfaces: vec![Interface { above: 0, below: Below::Mirror }; planes],
            films: vec![Film { medium: 0, thickness_nm: 0.0 }; planes],
            boundaries: vec![Boundary::default(); planes],
        }
    }
}

impl<'s> PlanarScene<'s> {
    /// Takes the planes of a scene: those of a mesh, or those between the layers of a stack.
    ///
    /// # Errors
    /// A mesh of tilted facets.
    pub fn new(scene: &'s Scene) -> Result<Self> {
        let planar = match &scene.shape {
            // Thicknesses as written: differences of heights would be rounded.
            Shape::Stack { ambient, layers, substrate } => {
                let film = |layer: &Layer| Film { medium: layer.medium, thickness_nm: layer.thickness_nm };
                Self {
                    scene,
                    ambient: *ambient,
                    layers: layers.iter().map(film).collect(),
                    substrate: *substrate,
                    spreads: spreads(scene, layers)?,
                }
            }
            Shape::Planes(flat) => Self::of_planes(scene, flat.planes())?,
            Shape::Mesh(_) => {
                return Err(Error::failed(format_args!(
                    "{}: has tilted facets, which scatter light; use estimate for its BRDF table and colours, scatter or orders \
                     for one direction of the light",
                    scene.name
                )));
            }
        };
        planar.stack(&mut planar.buffer())?;
        Ok(planar)
    }

    fn of_planes(scene: &'s Scene, planes: &[Plane]) -> Result<Self> {
        let mut interfaces: Vec<Interface> = Vec::new();
        let mut facets = Vec::with_capacity(planes.len());
        for &Plane { z_nm, interface } in planes {
            let place = interfaces.iter().position(|known| *known == interface).unwrap_or_else(|| {
                interfaces.push(interface);
                interfaces.len() - 1
            });
            let place = u16::try_from(place).map_err(|_| Error::failed("the scene has more than 65535 interfaces"))?;
            facets.push(Facet::horizontal(z_nm, place));
        }
        let named = |error: &dyn std::fmt::Display| Error::failed(format_args!("{}: {error}", scene.name));
        let cell = PlanarCell::new(&facets, &interfaces).map_err(|error| named(&error))?;
        let StackBuffer { mut interfaces, mut films, mut boundaries } = StackBuffer::for_planes(facets.len());
        let memory = StackMemory { interfaces: &mut interfaces, films: &mut films, boundaries: &mut boundaries };
        let stack = cell.stack(memory).map_err(|error| named(&error))?;
        let layers = (0..stack.planes() - 1).map(|j| stack.film(j)).collect();
        Ok(Self { scene, ambient: stack.ambient(), layers, substrate: stack.substrate(), spreads: Vec::new() })
    }

    /// Memory for [`PlanarScene::stack`].
    #[must_use]
    pub fn buffer(&self) -> StackBuffer {
        StackBuffer::for_planes(self.layers.len() + 1)
    }

    /// The scene as a multilayer.
    ///
    /// # Errors
    /// A buffer of another scene; a buffer of this scene never fails.
    pub fn stack<'b>(&self, buffer: &'b mut StackBuffer) -> Result<Stack<'b>> {
        let StackBuffer { interfaces, films, boundaries } = buffer;
        let memory = StackMemory { interfaces, films, boundaries };
        Stack::new(self.ambient, self.layers.iter().copied(), self.substrate, memory)
            .map_err(|error| Error::failed(format_args!("{}: {error}", self.scene.name)))
    }

    /// The media, in the scene's order.
    #[must_use]
    pub fn media(&self) -> Vec<Medium<'s>> {
        media_of(self.scene)
    }

    /// The longest optical path across the layers: Σ n d, with the largest n of each layer in a range of wavelengths.
    ///
    /// # Errors
    /// A medium without data in the range.
    pub fn longest_optical_path_nm(&self, [first, last]: [f64; 2]) -> Result<f64> {
        const MAX_PROBES: u32 = 16;
        let mut buffer = self.buffer();
        let stack = self.stack(&mut buffer)?;
        let media = self.media();
        let mut largest = Vec::with_capacity(media.len());
        for (index, medium) in media.iter().enumerate() {
            let mut max_index: f64 = 0.0;
            for i in 0..=MAX_PROBES {
                let nm = first + (last - first) * f64::from(i) / f64::from(MAX_PROBES);
                max_index = max_index.max(medium.eta(nm).map_err(|error| self.scene.medium_error(index, &error))?.re);
            }
            largest.push(max_index);
        }
        let path = |j| largest[usize::from(stack.film(j).medium)] * stack.film(j).thickness_nm;
        Ok((0..stack.planes() - 1).map(path).sum())
    }

    /// The variations of thickness over the surface; empty for most scenes.
    #[must_use]
    pub fn spreads(&self) -> &[Spread] {
        &self.spreads
    }

    /// The scene at a place where thicknesses differ from their means by so many standard deviations, one number for
    /// each of [`PlanarScene::spreads`].
    #[must_use]
    pub(super) fn at_place(&self, deviations: &[f64]) -> Self {
        let mut place = self.clone();
        for (spread, deviation) in place.spreads.drain(..).zip(deviations) {
            for layer in spread.layers {
                place.layers[layer].thickness_nm += deviation * spread.sigma_nm;
            }
        }
        place
    }

    /// The number of layers between the outer media.
    #[must_use]
    pub fn layers(&self) -> usize {
        self.layers.len()
    }

    /// The scene.
    #[must_use]
    pub fn scene(&self) -> &'s Scene {
        self.scene
    }
}

/// The variations of the layers of a stack.
///
/// # Errors
/// One that would make a thickness negative.
fn spreads(scene: &Scene, layers: &[Layer]) -> Result<Vec<Spread>> {
    let mut spreads: Vec<Spread> = Vec::new();
    for (place, layer) in layers.iter().enumerate() {
        let Some(ThicknessSpread { sigma_nm, entry }) = layer.spread else { continue };
        let most = layer.thickness_nm / SPREAD_SIGMAS;
        if sigma_nm > most {
            return Err(Error::failed(format_args!(
                "{}: layer {}: spread_nm {sigma_nm} is more than a fifth of the thickness {} nm, which would fall below 0; \
                 it is at most {most}",
                scene.name,
                place + 1,
                layer.thickness_nm
            )));
        }
        match spreads.iter_mut().find(|spread| spread.entry == entry) {
            Some(spread) => spread.layers.push(place),
            None => spreads.push(Spread { sigma_nm, entry, layers: vec![place] }),
        }
    }
    Ok(spreads)
}
