//! Surfaces that reflect into many directions, as one viewer sees them: tables of scattered light, and mirror-like
//! tables with a finish.
//!
//! The viewer is the incident direction, in evaluation and in sampling: f is reciprocal.

use glam::{DVec3, Vec3};
use goniochrome::microfacet::{Finish, Lobe};

use super::viewed::{SampledTable, TableTowards, ViewedTable};
use crate::table::mirror::neighbours;

/// A surface that reflects into many directions.
#[derive(Debug)]
pub(super) enum Glossy<'a> {
    Table(SampledTable<'a>),
    Finish(FinishedMirror<'a>),
}

/// A mirror-like table on rough facets.
#[derive(Debug)]
pub(super) struct FinishedMirror<'a> {
    pub finish: Finish,
    /// Angles of the table in degrees.
    pub theta_deg: &'a [f64],
    /// ρ(θ_d), `[theta][channel]`.
    pub values: &'a [f32],
}

/// Memory for a [`Glossy`] surface as one viewer sees it.
#[derive(Debug, Default)]
pub(super) struct Viewed {
    viewer: Vec3,
    table: ViewedTable,
}

/// A direction towards the light.
#[derive(Clone, Copy, Debug)]
pub(super) enum Towards {
    Table(TableTowards),
    Finish(Vec3, Lobe),
}

impl Towards {
    /// Unit vector in the frame of the surface.
    pub fn direction(&self) -> DVec3 {
        match self {
            Self::Table(towards) => towards.direction.as_dvec3(),
            Self::Finish(direction, _) => direction.as_dvec3(),
        }
    }

    /// Density per solid angle with which [`Glossy::sample`] draws it.
    pub fn pdf(&self) -> f64 {
        match self {
            Self::Table(towards) => towards.pdf.into(),
            Self::Finish(_, lobe) => lobe.pdf.into(),
        }
    }
}

impl Glossy<'_> {
    /// Number of lobes of flat facets.
    pub fn lobes(&self) -> usize {
        match self {
            Self::Table(table) => table.table.layout().lobes(),
            Self::Finish(_) => 0,
        }
    }

    /// Direction of a facet lobe for a viewer, if it is seen; writes its reflectance in each channel.
    pub fn reflected(&self, viewer: Vec3, lobe: usize, out: &mut [f32]) -> Option<Vec3> {
        match self {
            Self::Table(table) => table.table.reflected(viewer, lobe, out),
            Self::Finish(_) => None,
        }
    }

    /// Prepares the surface for a viewer above the horizon.
    pub fn look(&self, viewer: Vec3, viewed: &mut Viewed) {
        viewed.viewer = viewer;
        if let Self::Table(table) = self {
            viewed.table.look(table, viewer);
        }
    }

    /// What is known of a direction towards the light; `None` where nothing is reflected.
    pub fn towards(&self, viewed: &Viewed, direction: Vec3) -> Option<Towards> {
        match self {
            Self::Table(table) => Some(Towards::Table(viewed.table.towards(table, direction))),
            Self::Finish(mirror) => {
                mirror.finish.lobe(viewed.viewer, direction).map(|lobe| Towards::Finish(direction, lobe))
            }
        }
    }

    /// Draws a direction towards the light by `u`, uniform in [0, 1)²; `None` for a draw without light.
    pub fn sample(&self, viewed: &Viewed, u: [f32; 2]) -> Option<Towards> {
        match self {
            Self::Table(table) => viewed.table.sample(table, u).map(Towards::Table),
            Self::Finish(mirror) => {
                let direction = mirror.finish.sample(viewed.viewer, u)?;
                let lobe = mirror.finish.lobe(viewed.viewer, direction).filter(|lobe| lobe.pdf > 0.0)?;
                Some(Towards::Finish(direction, lobe))
            }
        }
    }

    /// Writes f cos θ of the light's direction to `out`, for each channel.
    pub fn reflect(&self, viewed: &Viewed, towards: &Towards, out: &mut [f32]) {
        match (self, towards) {
            (Self::Table(_), Towards::Table(towards)) => viewed.table.reflect(towards, out),
            (Self::Finish(mirror), Towards::Finish(direction, lobe)) => {
                out.fill(lobe.value * direction.z);
                reflect(mirror.theta_deg, mirror.values, f64::from(lobe.cos_d).acos().to_degrees(), out);
            }
            _ => out.fill(0.0),
        }
    }
}

/// Multiplies each channel by ρ(θ), linear between the table's angles and constant beyond them.
pub(super) fn reflect(theta_deg: &[f64], values: &[f32], at_deg: f64, throughput: &mut [f32]) {
    let channels = throughput.len();
    let (below, above, weight) = neighbours(theta_deg, at_deg);
    let weight = weight as f32;
    let (low, high) = (&values[below * channels..][..channels], &values[above * channels..][..channels]);
    for ((through, low), high) in throughput.iter_mut().zip(low).zip(high) {
        *through *= low + weight * (high - low);
    }
}
