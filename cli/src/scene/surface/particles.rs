//! Closed particles in a layer of binder between two planes, with or without a film on top.
//!
//! The binder is `depth_nm` deep, from z = 0 down to the plane `base`. Without a film its surface is the plane `top`;
//! with `film_nm` the plane `film` is its surface and `top` lies that far above. The binder is divided into `count` =
//! [nx, ny, nz] boxes, each with one `particle` at a random place that keeps it inside. An "ellipsoid" is an
//! icosahedron whose faces are divided in four `subdivisions` (2) times, a "flake" a hexagonal plate. `radii_nm` are
//! half their extents along their own x, y, z. A particle is turned at random about z and then tilted by a random
//! angle, at most `tilt_deg`, about a random horizontal axis. Its normals point into the binder: `above` is the binder,
//! `below` the particle.

use std::collections::HashMap;
use std::f64::consts::{FRAC_PI_3, TAU};

use glam::{DQuat, DVec3};

use super::builder::{Builder, bounded};
use super::keys::{count, counts, length, list, positive, within};
use super::random::RandomSequence;
use crate::scene::toml_value::TomlTable;
use crate::support::error::Result;

/// Fraction of its box that each particle leaves free on every side, so that none touch.
const MARGIN: f64 = 0.01;

pub(super) fn interfaces(table: &TomlTable<'_>) -> &'static [&'static str] {
    if table.get("film_nm").is_some() { &["top", "base", "particle", "film"] } else { &["top", "base", "particle"] }
}

pub(super) fn build(table: &TomlTable<'_>, builder: &mut Builder<'_>) -> Result<()> {
    let keys = ["kind", "shape", "radii_nm", "count", "depth_nm", "film_nm", "tilt_deg", "subdivisions", "seed"];
    table.allow(&keys)?;
    let shape = table.require("shape", "\"ellipsoid\" or \"flake\"")?;
    let [x, y, z] = list::<3>(&table.require("radii_nm", "radii_nm = [100, 100, 100]")?)?;
    let radii = DVec3::new(positive(&x)?, positive(&y)?, positive(&z)?);
    let boxes = counts::<3>(table, "count", 1000)?;
    let depth_nm = length(table, "depth_nm")?;
    let film_nm = table.get("film_nm").map(|item| positive(&item)).transpose()?;
    let tilt = table.get("tilt_deg").map_or(Ok(0.0), |item| within(&item, [0.0, 90.0]))?.to_radians();
    let subdivisions = table.get("subdivisions").map_or(Ok(2), |item| count(&item, [0, 5]))?;
    let mut random = RandomSequence::read(table)?;
    let (points, faces) = match shape.text()? {
        "ellipsoid" => sphere(subdivisions),
        "flake" => plate(),
        other => {
            return Err(shape.refuse(format_args!("{other:?} is unknown; write \"ellipsoid\" or \"flake\"")));
        }
    };
    let particles = boxes.iter().map(|&n| u64::from(n)).product::<u64>();
    bounded(table, 8 + particles * faces.len() as u64)?;

    builder.plane(film_nm.unwrap_or(0.0), 0);
    if film_nm.is_some() {
        builder.plane(0.0, 3);
    }
    builder.plane(-depth_nm, 1);
    let size = DVec3::new(builder.period_nm[0], builder.period_nm[1], depth_nm) / DVec3::from(boxes.map(f64::from));
    for k in 0..boxes[2] {
        for j in 0..boxes[1] {
            for i in 0..boxes[0] {
                let direction = random.between(0.0, TAU);
                let tilted =
                    DQuat::from_axis_angle(DVec3::new(direction.cos(), direction.sin(), 0.0), tilt * random.unit());
                let turned = tilted * DQuat::from_rotation_z(random.between(0.0, TAU));
                let corners: Vec<DVec3> = points.iter().map(|&p| turned * (p * radii)).collect();
                let low = corners.iter().fold(DVec3::INFINITY, |low, &p| low.min(p));
                let high = corners.iter().fold(DVec3::NEG_INFINITY, |high, &p| high.max(p));
                let free = size * (1.0 - 2.0 * MARGIN) - (high - low);
                if free.min_element() < 0.0 {
                    let extent = high - low;
                    return Err(table.refuse(format_args!(
                        "a particle of {:.0} by {:.0} by {:.0} nm does not fit its box of {:.0} by {:.0} by {:.0} nm; lower count or radii_nm",
                        extent.x, extent.y, extent.z, size.x, size.y, size.z
                    )));
                }
                let place = DVec3::new(random.unit(), random.unit(), random.unit());
                let origin = DVec3::new(f64::from(i), f64::from(j), f64::from(k)) * size - DVec3::Z * depth_nm;
                let shift = origin + size * MARGIN + free * place - low;
                let numbers: Vec<u32> = corners.iter().map(|&p| builder.vertex(p + shift)).collect();
                for face in &faces {
                    builder.triangle(face.map(|corner| numbers[corner]), 2);
                }
            }
        }
    }
    Ok(())
}

/// Vertices and triangles of a closed body.
type Polyhedron = (Vec<DVec3>, Vec<[usize; 3]>);

/// Unit sphere of 20 · 4ⁿ triangles.
fn sphere(subdivisions: u32) -> Polyhedron {
    let golden = 0.5 * (1.0 + 5f64.sqrt());
    let mut points: Vec<DVec3> = Vec::new();
    for (a, b) in [(1.0, golden), (-1.0, golden), (1.0, -golden), (-1.0, -golden)] {
        points.extend([DVec3::new(0.0, a, b), DVec3::new(a, b, 0.0), DVec3::new(b, 0.0, a)].map(DVec3::normalize));
    }
    // Faces join three corners an edge apart, 63.4°; corners further apart are at 116.6° or opposite.
    let near = |p: DVec3, q: DVec3| p.dot(q) > 0.1;
    let mut faces = Vec::new();
    for i in 0..12 {
        for j in i + 1..12 {
            for k in j + 1..12 {
                let (p, q, r) = (points[i], points[j], points[k]);
                if near(p, q) && near(q, r) && near(r, p) {
                    faces.push(if p.dot(q.cross(r)) > 0.0 { [i, j, k] } else { [i, k, j] });
                }
            }
        }
    }
    for _ in 0..subdivisions {
        let mut middles: HashMap<[usize; 2], usize> = HashMap::new();
        let mut middle = |a: usize, b: usize| {
            *middles.entry([a.min(b), a.max(b)]).or_insert_with(|| {
                points.push((points[a] + points[b]).normalize());
                points.len() - 1
            })
        };
        faces = faces
            .into_iter()
            .flat_map(|[a, b, c]| {
                let [ab, bc, ca] = [middle(a, b), middle(b, c), middle(c, a)];
                [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
            })
            .collect();
    }
    (points, faces)
}

/// Hexagonal plate of half-extents 1.
fn plate() -> Polyhedron {
    let corner = |i: u32, z: f64| DVec3::new((FRAC_PI_3 * f64::from(i)).cos(), (FRAC_PI_3 * f64::from(i)).sin(), z);
    let points = (0..6).map(|i| corner(i, 1.0)).chain((0..6).map(|i| corner(i, -1.0))).collect();
    let mut faces = Vec::new();
    for i in 1..5 {
        faces.extend([[0, i, i + 1], [6, 7 + i, 6 + i]]);
    }
    for i in 0..6 {
        let next = (i + 1) % 6;
        faces.extend([[i, 6 + i, 6 + next], [i, 6 + next, next]]);
    }
    (points, faces)
}
