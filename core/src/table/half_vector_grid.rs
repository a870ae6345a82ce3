//! Exits of rays counted in the boxes and lobes of a scatter table.

use super::layout::ScatterLayout;
use super::warp::HalfVectorWarp;
use crate::measure::bins::DirectionGrid;
use glam::{DVec3, Vec3};

/// Direction of a lobe of flat facets for one direction of the light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LobeDirection {
    /// Unit direction in which the lobe leaves.
    pub direction: DVec3,
    /// Index of the lobe.
    pub lobe: usize,
}

/// Places of a [`ScatterTable`](super::ScatterTable) as a grid of outgoing directions, for one direction of the light.
///
/// An exit within [`HalfVectorGrid::MAX_LOBE_DISTANCE`] of a lobe's direction counts there, any other in the box of its
/// half vector ([`ScatterLayout::nearest_node`]).
#[derive(Clone, Copy, Debug)]
pub struct HalfVectorGrid<'a> {
    layout: ScatterLayout,
    warp: HalfVectorWarp<'a>,
    wi: Vec3,
    origin: f32,
    lobes: &'a [LobeDirection],
}

impl<'a> HalfVectorGrid<'a> {
    /// Largest distance of the unit direction of an exit from that of its lobe: the rounding of single precision over a
    /// hundred hits.
    pub const MAX_LOBE_DISTANCE: f64 = 1e-5;

    /// Grid for light from the unit vector `wi`. `lobes` holds the lobes above the horizon, by increasing x of their
    /// directions.
    #[must_use]
    pub fn new(layout: ScatterLayout, warp: HalfVectorWarp<'a>, wi: DVec3, lobes: &'a [LobeDirection]) -> Self {
        let wi = wi.as_vec3();
        Self { layout, warp, wi, origin: layout.origin(wi), lobes }
    }

    /// Lobe of a direction, if it leaves in one.
    fn lobe(&self, direction: DVec3) -> Option<usize> {
        let first = self.lobes.partition_point(|lobe| lobe.direction.x < direction.x - Self::MAX_LOBE_DISTANCE);
        let near = self.lobes.get(first..).unwrap_or(&[]).iter();
        near.take_while(|lobe| lobe.direction.x <= direction.x + Self::MAX_LOBE_DISTANCE)
            .find(|lobe| lobe.direction.distance(direction) <= Self::MAX_LOBE_DISTANCE)
            .map(|lobe| lobe.lobe)
    }
}

impl DirectionGrid for HalfVectorGrid<'_> {
    fn count(&self) -> usize {
        self.layout.places()
    }

    fn index(&self, direction: DVec3) -> usize {
        let direction = direction.with_z(direction.z.abs()).normalize_or_zero();
        if let Some(lobe) = self.lobe(direction) {
            return self.layout.node_count() + lobe;
        }
        let [x, y] = self.warp.warped(self.wi, direction.as_vec3(), self.origin).place;
        self.layout.nearest_node(x.into(), y.into())
    }
}
