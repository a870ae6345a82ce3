//! A planar cell: facets that are whole horizontal planes, borrowed from the caller and checked once.
//!
//! The paper defines a thin film in this way ("polygons representing two planes", section 4.1). A planar cell is a
//! [`Stack`] that is given by the heights of its planes.

use crate::geometry::facet::{CellError, Facet};
use crate::optics::interface::{Below, Interface};
use crate::optics::stack::{Film, Stack, StackError, StackMemory};
use glam::DVec3;

/// A checked planar cell: its facets are finite and in order from the top, and neighbours agree on the medium between
/// them.
#[derive(Clone, Copy, Debug)]
pub struct PlanarCell<'a> {
    facets: &'a [Facet],
    interfaces: &'a [Interface],
}

impl<'a> PlanarCell<'a> {
    /// Checks the facets, given from the top.
    ///
    /// # Errors
    /// [`CellError`], with the first offending facet: there are none, one is not finite or not a horizontal plane
    /// facing upwards, names a missing interface, lies above its predecessor, or has another medium above it than the
    /// predecessor has below.
    pub fn new(facets: &'a [Facet], interfaces: &'a [Interface]) -> Result<Self, CellError> {
        if facets.is_empty() {
            return Err(CellError::Empty);
        }
        let mut predecessor: Option<(f64, Below)> = None;
        for (facet, f) in facets.iter().enumerate() {
            if !(f.normal.is_finite() && f.anchor_nm.is_finite()) {
                return Err(CellError::NotFinite { facet });
            }
            let Some(interface) = interfaces.get(usize::from(f.interface)) else {
                return Err(CellError::NoInterface { facet });
            };
            if f.normal != DVec3::Z {
                return Err(CellError::Tilted { facet });
            }
            if let Some((z_nm, below)) = predecessor {
                if f.anchor_nm.z > z_nm {
                    return Err(CellError::OutOfOrder { facet });
                }
                if below != Below::Medium(interface.above) {
                    return Err(CellError::MediaDiffer { facet });
                }
            }
            predecessor = Some((f.anchor_nm.z, interface.below));
        }
        Ok(Self { facets, interfaces })
    }

    /// The facets, in order from the top.
    #[must_use]
    pub fn facets(&self) -> &'a [Facet] {
        self.facets
    }

    /// The cell as a planar multilayer.
    ///
    /// # Errors
    /// [`StackError::Memory`] if `memory` holds fewer planes than the cell has facets.
    pub fn stack<'m>(&self, memory: StackMemory<'m>) -> Result<Stack<'m>, StackError> {
        let interface = |facet: &Facet| self.interfaces[usize::from(facet.interface)];
        let layers = self.facets.windows(2).map(|pair| Film {
            medium: interface(&pair[1]).above,
            thickness_nm: pair[0].anchor_nm.z - pair[1].anchor_nm.z,
        });
        let (first, last) = (&self.facets[0], &self.facets[self.facets.len() - 1]);
        Stack::new(interface(first).above, layers, interface(last).below, memory)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::optics::stack::StackArrays;

    const FILM: [Interface; 2] =
        [Interface { above: 0, below: Below::Medium(1) }, Interface { above: 1, below: Below::Medium(0) }];

    #[test]
    fn two_planes_are_a_film() {
        let facets = [Facet::horizontal(10.0, 0), Facet::horizontal(-290.0, 1)];
        let cell = PlanarCell::new(&facets, &FILM).unwrap();
        let mut arrays = StackArrays::<2>::new();
        let stack = cell.stack(arrays.memory()).unwrap();
        assert_eq!(stack.planes(), 2);
        assert_eq!(stack.film(0), Film { medium: 1, thickness_nm: 300.0 });
        assert_eq!(stack.substrate(), Below::Medium(0));
    }

    #[test]
    fn a_layer_is_as_thick_as_its_heights_say() {
        let interfaces =
            [Interface { above: 0, below: Below::Medium(1) }, Interface { above: 1, below: Below::Medium(0) }];
        let heights = [0.0, -58.510_638_297_872_34, -152.688_718_571_845_8];
        let facets: [Facet; 3] = core::array::from_fn(|i| Facet::horizontal(heights[i], (i % 2) as u16));
        let mut arrays = StackArrays::<3>::new();
        let stack = PlanarCell::new(&facets, &interfaces).unwrap().stack(arrays.memory()).unwrap();
        for j in 0..2 {
            assert_eq!(stack.film(j).thickness_nm, heights[j] - heights[j + 1]);
        }
    }

    #[test]
    fn what_is_wrong_is_named_by_facet() {
        let at = Facet::horizontal;
        let check = |facets: &[Facet]| PlanarCell::new(facets, &FILM).unwrap_err();
        assert_eq!(check(&[]), CellError::Empty);
        assert_eq!(check(&[at(0.0, 0), at(f64::NAN, 1)]), CellError::NotFinite { facet: 1 });
        assert_eq!(check(&[at(0.0, 0), at(-1.0, 2)]), CellError::NoInterface { facet: 1 });
        assert_eq!(check(&[at(0.0, 0), at(1.0, 1)]), CellError::OutOfOrder { facet: 1 });
        assert_eq!(check(&[at(0.0, 0), at(-1.0, 0)]), CellError::MediaDiffer { facet: 1 });
        let tilted = Facet { normal: DVec3::new(0.6, 0.0, 0.8), ..at(0.0, 0) };
        assert_eq!(check(&[tilted]), CellError::Tilted { facet: 0 });
    }
}
