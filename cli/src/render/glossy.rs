//! Surfaces that reflect into many directions, as one viewer sees them: tables of scattered light, and mirror-like
//! tables with a finish.
//!
//! The viewer is the incident direction, in evaluation and in sampling: f is reciprocal.

use glam::{DVec3, Vec3, Vec3Swizzles};
use goniochrome::microfacet::{Finish, Lobe};

use super::body::{Body, SurfaceHit};
use super::mirror_like::{Between, MirrorLike};
use super::viewed::{SampledTable, TableTowards, ViewedTable};

/// A surface that reflects into many directions.
#[derive(Debug)]
pub(super) enum Glossy<'a> {
    Table(SampledTable<'a>),
    Finish(FinishedMirror<'a>),
}

/// A mirror-like table on rough facets.
#[derive(Debug)]
pub(super) struct FinishedMirror<'a> {
    pub finish: Finish<'a>,
    /// ρ(θ_d).
    pub mirror: &'a MirrorLike,
}

/// Memory for a [`Glossy`] surface as one viewer sees it.
#[derive(Debug, Default)]
pub(super) struct Viewed {
    viewer: Vec3,
    table: ViewedTable,
    /// Thickness of a film.
    between: Between,
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

    /// Prepares the surface at a hit for a viewer above the horizon.
    pub fn look(&self, body: &Body<'_>, hit: &SurfaceHit, viewer: Vec3, viewed: &mut Viewed) {
        viewed.viewer = viewer;
        match self {
            Self::Table(table) => viewed.table.look(table, viewer),
            Self::Finish(finished) => viewed.between = finished.mirror.at(body, hit),
        }
    }

    /// Whether light goes through the surface.
    pub fn is_sheet(&self) -> bool {
        matches!(self, Self::Finish(finished) if finished.mirror.is_sheet())
    }

    /// Writes the transmittance of a sheet for the viewer's direction to `out`, by normals drawn with `points`.
    ///
    /// The interfaces of a film are parallel to each other, whatever the slope of the film. So light goes straight on
    /// through each facet, and a sheet lets through the mean of T(θ_d) over the facets that the viewer sees.
    pub fn transmit(&self, viewed: &Viewed, points: &[[f32; 2]], part: &mut [f32], out: &mut [f32]) {
        out.fill(0.0);
        let Self::Finish(FinishedMirror { finish, mirror }) = self else { return };
        let mut add = |share: f32, cosine: f32| {
            part.fill(share);
            let theta_deg = f64::from(cosine).clamp(0.0, 1.0).acos().to_degrees();
            mirror.transmit(viewed.between, theta_deg, part);
            out.iter_mut().zip(&*part).for_each(|(sum, part)| *sum += part);
        };
        // Of shares whose sum differs from 1 by chance, the rest has the transmittance of the smooth sheet.
        let mut rest = 1.0;
        for &u in points {
            let m = finish.draw_normal(viewed.viewer, u);
            let share = visible_share(finish, viewed.viewer, m) / points.len() as f32;
            rest -= share;
            add(share, viewed.viewer.dot(m));
        }
        if finish.distribution().is_none() {
            add(rest, viewed.viewer.z);
        }
    }

    /// What is known of a direction towards the light; `None` where nothing is reflected.
    pub fn towards(&self, viewed: &Viewed, direction: Vec3) -> Option<Towards> {
        match self {
            Self::Table(table) => Some(Towards::Table(viewed.table.towards(table, direction))),
            Self::Finish(finished) => {
                finished.finish.lobe(viewed.viewer, direction).map(|lobe| Towards::Finish(direction, lobe))
            }
        }
    }

    /// Draws a direction towards the light by `u`, uniform in [0, 1)²; `None` for a draw without light.
    pub fn sample(&self, viewed: &Viewed, u: [f32; 2]) -> Option<Towards> {
        match self {
            Self::Table(table) => viewed.table.sample(table, u).map(Towards::Table),
            Self::Finish(finished) => {
                let direction = finished.finish.sample(viewed.viewer, u)?;
                let lobe = finished.finish.lobe(viewed.viewer, direction).filter(|lobe| lobe.pdf > 0.0)?;
                Some(Towards::Finish(direction, lobe))
            }
        }
    }

    /// Writes f cos θ of the light's direction to `out`, for each channel.
    pub fn reflect(&self, viewed: &Viewed, towards: &Towards, out: &mut [f32]) {
        match (self, towards) {
            (Self::Table(_), Towards::Table(towards)) => viewed.table.reflect(towards, out),
            (Self::Finish(finished), Towards::Finish(direction, lobe)) => {
                out.fill(lobe.value * direction.z);
                finished.mirror.reflect(viewed.between, f64::from(lobe.cos_d).acos().to_degrees(), out);
                finished.mirror.add_returned(viewed.between, lobe.multiple * direction.z, out);
            }
            _ => out.fill(0.0),
        }
    }
}

/// Density of the normals that a viewer sees over that of [`Finish::draw_normal`], which draws tabulated facets by
/// D cos θ_m, turned by half a turn about z where they are not seen.
fn visible_share(finish: &Finish<'_>, viewer: Vec3, m: Vec3) -> f32 {
    if finish.distribution().is_some() {
        return 1.0;
    }
    let turned = (-m.xy()).extend(m.z);
    let density = finish.density(m);
    let drawn = density + if viewer.dot(turned) < 0.0 { finish.density(turned) } else { 0.0 };
    if drawn > 0.0 && m.z > 0.0 {
        density * viewer.dot(m).max(0.0) / (drawn * m.z * finish.visible_area(viewer))
    } else {
        0.0
    }
}
