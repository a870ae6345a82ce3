//! Where the numbers of a table of facets lie.

use super::error::FinishError;
use super::limits::{MAX_RINGS, MAX_SECTORS};

/// Minimum number of sectors, except for 1.
const MIN_SECTORS: usize = 4;
/// Steps of √cos θ between nodes of visible areas.
pub(super) const VIEWS: usize = 256;

/// Numbers of a table of facets, in four sections: D; squared roughnesses e that directions see; probabilities of
/// normals within rings; integrals of D over sectors.
///
/// With more than one sector, rows of D and e go on around the azimuth, so that neighbours are read at once: a row of D
/// repeats its first number, one of e begins with its last and ends with its first two.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct FacetLayout {
    pub rings: usize,
    pub sectors: usize,
}

impl FacetLayout {
    /// Checks a number of rings and of sectors.
    pub fn new([rings, sectors]: [usize; 2]) -> Result<Self, FinishError> {
        let is_one = sectors == 1 || (MIN_SECTORS..=MAX_SECTORS).contains(&sectors);
        let fits = (1..=MAX_RINGS).contains(&rings) && is_one;
        fits.then_some(Self { rings, sectors }).ok_or(FinishError::Size)
    }

    /// Numbers in a row of D.
    #[inline]
    pub fn ring(self) -> usize {
        if self.sectors == 1 { 1 } else { self.sectors + 1 }
    }

    /// Numbers in a row of e.
    #[inline]
    pub fn view(self) -> usize {
        if self.sectors == 1 { 1 } else { self.sectors + 3 }
    }

    /// Place of the numbers e, of which there is a row for each step of √cos θ, ends included.
    #[inline]
    pub fn seen(self) -> usize {
        (self.rings + 1) * self.ring()
    }

    /// Place of the probabilities within rings.
    pub fn within(self) -> usize {
        self.seen() + (VIEWS + 1) * self.view()
    }

    /// Place of the integrals over sectors.
    pub fn turned(self) -> usize {
        self.within() + self.rings + 1
    }

    /// Number of all numbers.
    pub fn len(self) -> usize {
        self.turned() + (self.rings + 1) * self.sectors
    }

    /// Azimuth between sectors.
    pub fn step(self) -> f64 {
        core::f64::consts::TAU / self.sectors as f64
    }

    /// sin²θ_m of a ring.
    pub fn sin_square(self, ring: usize) -> f64 {
        let part = ring as f64 / self.rings as f64;
        part * part * part * part
    }
}
