//! The lobes of flat facets that a table holds, found by a few rays.

use goniochrome::geometry::mesh_cell::MeshCell;
use goniochrome::geometry::side::Side;
use goniochrome::measure::bins::Histogram;
use goniochrome::simd::ray_lanes::RayLanes;
use goniochrome::table::{FacetLobe, HalfVectorGrid, HalfVectorWarp, ScatterLayout};
use goniochrome::trace::sobol::sobol;

use crate::solve::batches::sequence;
use crate::solve::cell_table::worker::lobe_directions;
use crate::solve::groups::Group;
use crate::solve::mesh_scene::MeshScene;
use crate::solve::scatter::{Paths, RayLight, Workspace, trace_rays};
use crate::support::direction::direction;

/// Starting rays of each incident direction.
const RAYS: u32 = 256;
/// The smallest share of the light, averaged over incident directions, of a lobe that is kept. Weaker ones count in
/// boxes.
const MIN_SHARE: f64 = 2e-4;
/// The largest number of lobes that are kept: renderers look each up.
const MAX_LOBES: usize = 64;

/// Light in lobes.
struct LobeLight<'l> {
    nodes: usize,
    power: &'l mut [f64],
}

impl Histogram for LobeLight<'_> {
    fn add(&mut self, lane: usize, side: Side, bin: usize, power: f64) {
        if let (0, Side::Above, Some(lobe)) = (lane, side, bin.checked_sub(self.nodes)) {
            self.power[lobe] += power;
        }
    }
}

/// Those of the `possible` lobes that hold a noticeable share of the light, strongest first. They are found without
/// interference, at the middle wavelengths, from the incident directions of `layout`.
pub(super) fn lobes_with_light<V: RayLanes>(
    mesh_scene: &MeshScene<'_>,
    cell: MeshCell<'_>,
    groups: &[Group<'_, V>],
    layout: &ScatterLayout,
    warp: HalfVectorWarp<'_>,
    possible: &[FacetLobe],
    seed: u32,
) -> Vec<FacetLobe> {
    if possible.is_empty() {
        return Vec::new();
    }
    let Some((media, _)) = groups.get(groups.len() / 2) else { return Vec::new() };
    let mut memory = Workspace::<V>::new(mesh_scene);
    let mut power = vec![0.0; possible.len()];
    for incident in 0..layout.incident_count() {
        let [theta, phi] = layout.incident(incident);
        let wi = direction(theta, phi);
        let directions = lobe_directions(possible, wi);
        let grid = HalfVectorGrid::new(*layout, warp, wi, &directions);
        let sequence = sequence(seed, incident as u32);
        let light = RayLight { cell, media: *media, wi, paths: Paths::Alone, grid: &grid, sequence };
        let nodes = layout.node_count();
        let mut histogram = LobeLight { nodes, power: &mut power };
        trace_rays(&light, (0..RAYS).map(|ray| (ray, sobol(ray, sequence))), &mut memory, &mut histogram);
    }
    let least = MIN_SHARE * f64::from(RAYS) * layout.incident_count() as f64;
    let mut found: Vec<_> = possible.iter().zip(power).filter(|(_, power)| *power >= least).collect();
    found.sort_by(|a, b| b.1.total_cmp(&a.1));
    found.into_iter().take(MAX_LOBES).map(|(lobe, _)| *lobe).collect()
}
