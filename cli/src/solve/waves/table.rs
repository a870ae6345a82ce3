//! Tables of diffraction orders by waves.

use std::sync::OnceLock;
use std::sync::atomic::{AtomicUsize, Ordering};

use goniochrome::simd::complex::Polarised;
use goniochrome::table::OrderLayout;

use crate::scene::Scene;
use crate::solve::checkpoint::{Checkpoint, Identity};
use crate::solve::share::Share;
use crate::solve::waves::cell::{Accuracy, WaveCell};
use crate::solve::waves::powers::OrderPower;
use crate::support::error::Result;
use crate::support::memory::filled;
use crate::support::parallel;
use crate::table::metadata::Metadata;
use crate::table::orders::{OrderTable, check_order_size};

/// A request for a table of diffraction orders.
#[derive(Clone, Copy, Debug)]
pub struct OrderTableRequest {
    /// Grid of directions of the light.
    pub layout: OrderLayout,
    /// When an efficiency is good enough.
    pub accuracy: Accuracy,
    /// Worker threads; the result does not depend on it.
    pub threads: usize,
    /// The share of the columns of directions, one for each α and wavelength, to compute; all others are then left out.
    pub share: Option<Share>,
}

impl OrderTableRequest {
    /// The identity of a checkpoint: everything that decides its numbers.
    #[must_use]
    pub fn identity(&self, scene: &Scene, wavelength_nm: &[f64]) -> Identity {
        let identity = Identity::of_scene(scene).and("front", &scene.front);
        identity.and("waves", &(self.layout, self.accuracy)).and("wavelengths", &wavelength_nm)
    }
}

/// Table of orders, and whether every error bar meets the target.
#[derive(Clone, Debug, PartialEq)]
pub struct WaveTable {
    /// The table, without metadata.
    pub table: OrderTable,
    /// Whether every error bar meets the target.
    pub met: bool,
    /// Eigenvalue decompositions that were made: fewer than `layers`, since one serves all directions of one α and all
    /// equal layers.
    pub decompositions: usize,
    /// Layers of several media through which light was followed, over all directions, wavelengths and truncations.
    pub layers: usize,
}

/// Strengths of one wavelength for the directions of one α: reflected s and p, transmitted s and p, `[β][order]`, and
/// an error bar.
struct Row {
    strengths: [Vec<f32>; 4],
    error: f32,
}

impl Row {
    /// The number of bytes that [`Row::write`] returns for so many strengths.
    fn bytes(strengths: usize) -> usize {
        (4 * strengths + 1) * size_of::<f32>()
    }

    /// The bytes for a checkpoint, little endian: strengths, error.
    fn write(&self) -> Vec<u8> {
        let numbers = self.strengths.iter().flatten().chain([&self.error]);
        numbers.flat_map(|x| x.to_le_bytes()).collect()
    }

    /// Reads the bytes that [`Row::write`] returned.
    fn read(bytes: &[u8]) -> Self {
        let (words, _) = bytes.as_chunks();
        let numbers: Vec<f32> = words.iter().map(|word| f32::from_le_bytes(*word)).collect();
        let strengths = numbers.len() / 4;
        let part = |i: usize| numbers[i * strengths..(i + 1) * strengths].to_vec();
        Self { strengths: [part(0), part(1), part(2), part(3)], error: numbers[4 * strengths] }
    }
}

/// Computes the table of a cell. `progress` is called after each of [`steps`]. Parts that the checkpoint holds are
/// taken from it, the others are added to it.
///
/// # Errors
/// A table that is too large, a medium without data at a wavelength, bodies that overlap, a period that needs more
/// orders than the accuracy allows, equations without a finite solution, a checkpoint that cannot be read or written.
pub fn wave_table(
    cell: &WaveCell<'_>,
    wavelength_nm: &[f64],
    request: &OrderTableRequest,
    checkpoint: Option<&Checkpoint>,
    progress: &(dyn Fn() + Sync),
) -> Result<WaveTable> {
    let layout = request.layout;
    let above = wavelength_nm.iter().map(|&nm| cell.index_above(nm)).collect::<Result<Vec<_>>>()?;
    let below = wavelength_nm.iter().map(|&nm| cell.index_below(nm)).collect::<Result<Vec<_>>>()?;
    let orders = travelling(cell, &layout, wavelength_nm, [&above, &below]);
    check_order_size(&layout, orders.len(), wavelength_nm.len())?;
    let [columns, across] = layout.nodes().map(|n| n as usize);
    let mut rows: Vec<Option<Row>> = (0..wavelength_nm.len() * columns).map(|_| None).collect();
    if let Some(checkpoint) = checkpoint {
        checkpoint.restore(Row::bytes(across * orders.len()), rows.len(), |part, bytes| {
            rows[part] = Some(Row::read(bytes));
            progress();
        })?;
    }
    let failure = OnceLock::new();
    let (decompositions, layers) = (AtomicUsize::new(0), AtomicUsize::new(0));
    // A surface that is its own mirror image sends light from −α into −m as it sends light from α into m.
    let mirrors = cell.mirrors()?;
    let mirrored = |part: usize| mirrors[0] && part % columns >= columns.div_ceil(2);
    let images = images(cell, &orders, [true, false]);
    let computed = rows.iter_mut().enumerate().filter(|(part, _)| !mirrored(*part)).enumerate();
    let shared = computed.filter(|(place, _)| request.share.is_none_or(|share| share.takes(*place)));
    let missing = shared.map(|(_, entry)| entry).filter(|(_, row)| row.is_none());
    parallel::for_each(
        request.threads,
        missing,
        || (),
        |(), (part, row)| {
            if failure.get().is_some() {
                return; // the table is refused already
            }
            let (wavelength, column) = (part / columns, part % columns);
            let found = row_of(cell, wavelength_nm[wavelength], column, &orders, mirrors, request);
            let kept = found.and_then(|(found, counts)| {
                decompositions.fetch_add(counts[0], Ordering::Relaxed);
                layers.fetch_add(counts[1], Ordering::Relaxed);
                checkpoint.map_or(Ok(()), |checkpoint| checkpoint.keep(part, &found.write()))?;
                *row = Some(found);
                Ok(())
            });
            if let Err(error) = kept {
                let _ = failure.set(error);
            }
            progress();
        },
    );
    if let Some(error) = failure.into_inner() {
        return Err(error);
    }
    let count = wavelength_nm.len() * layout.count();
    let blank = || filled(0.0, count * orders.len(), "the table");
    let mut strengths = [blank()?, blank()?, blank()?, blank()?];
    let mut error = filled(0.0, count, "the table")?;
    for part in 0..rows.len() {
        let (wavelength, column) = (part / columns, part % columns);
        let mirror = if mirrored(part) { part - column + (columns - 1 - column) } else { part };
        let Some(row) = &rows[mirror] else { continue };
        for beta in 0..across {
            let node = (wavelength * across + beta) * columns + column;
            error[node] = row.error;
            for (to, from) in strengths.iter_mut().zip(&row.strengths) {
                let to = &mut to[node * orders.len()..][..orders.len()];
                let from = &from[beta * orders.len()..][..orders.len()];
                for (order, &image) in images.iter().enumerate() {
                    to[order] = from[if mirrored(part) { image } else { order }];
                }
            }
        }
    }
    let met = error.iter().all(|error| f64::from(*error) <= request.accuracy.target);
    let [reflected_s, reflected_p, transmitted_s, transmitted_p] = strengths;
    let table = OrderTable {
        layout,
        orders,
        wavelength_nm: wavelength_nm.to_vec(),
        index_above: above,
        index_below: below,
        reflected: Polarised { s: reflected_s, p: reflected_p },
        transmitted: Polarised { s: transmitted_s, p: transmitted_p },
        error,
        metadata: Metadata::default(),
    };
    Ok(WaveTable { table, met, decompositions: decompositions.into_inner(), layers: layers.into_inner() })
}

/// Number of calls of `progress` by [`wave_table`].
#[must_use]
pub fn steps(layout: &OrderLayout, wavelengths: usize) -> usize {
    layout.nodes()[0] as usize * wavelengths
}

/// Orders that travel above or below the surface for light from any direction at any wavelength, ascending.
fn travelling(cell: &WaveCell<'_>, layout: &OrderLayout, wavelength_nm: &[f64], index: [&[f64]; 2]) -> Vec<[i32; 2]> {
    let mut max = [0i32; 2];
    let period_nm = cell.period_nm();
    for (place, nm) in wavelength_nm.iter().enumerate() {
        let densest = index[0][place].max(index[1][place]);
        for axis in 0..2 {
            let reach = (index[0][place] + densest) * period_nm[axis] / nm;
            max[axis] = max[axis].max(reach.min(MAX_ORDER) as i32);
        }
    }
    let varies = cell.varies();
    let range = |axis: usize| if varies[axis] { -max[axis]..=max[axis] } else { 0..=0 };
    let mut orders = Vec::new();
    for m in range(0) {
        for n in range(1) {
            let travels = (0..layout.count()).any(|node| {
                let wi = layout.direction(node);
                wavelength_nm.iter().enumerate().any(|(place, &nm)| {
                    let [x, y] = cell.order_tangential(wi, index[0][place], [m, n], nm);
                    x.hypot(y) < index[0][place].max(index[1][place])
                })
            });
            if travels {
                orders.push([m, n]);
            }
        }
    }
    orders
}

/// Place of the mirror image of each order. The list of orders is its own image, since the grid of directions is.
fn images(cell: &WaveCell<'_>, orders: &[[i32; 2]], across: [bool; 2]) -> Vec<usize> {
    let image = |(place, &order): (usize, &[i32; 2])| {
        orders.binary_search(&cell.mirrored_order(order, across)).unwrap_or(place)
    };
    orders.iter().enumerate().map(image).collect()
}

/// Bound on |m| before orders are counted: far more than a table holds.
const MAX_ORDER: f64 = 1000.0;

/// Strengths of one wavelength for all directions of one α; also the counts of decompositions and layers.
fn row_of(
    cell: &WaveCell<'_>,
    wavelength_nm: f64,
    column: usize,
    orders: &[[i32; 2]],
    mirrors: [bool; 2],
    request: &OrderTableRequest,
) -> Result<(Row, [usize; 2])> {
    let layout = request.layout;
    let [columns, across] = layout.nodes().map(|n| n as usize);
    let lights: Vec<_> = (0..across).map(|beta| layout.direction(beta * columns + column)).collect();
    let index = cell.index_above(wavelength_nm)?;
    let mut seconds: Vec<f64> = lights.iter().map(|&wi| cell.wavevector(wi, index)[1]).collect();
    // Lines have one half of β alone.
    let halved = mirrors[1] && !layout.periodicity().has_lines();
    if halved {
        seconds.truncate(across.div_ceil(2));
    }
    let found = cell.orders(wavelength_nm, cell.wavevector(lights[0], index)[0], &seconds, request.accuracy)?;
    let opaque = cell.index_below(wavelength_nm)? == 0.0;
    let blank = || vec![0.0; across * orders.len()];
    let mut strengths = [blank(), blank(), blank(), blank()];
    for (beta, powers) in found.directions.iter().enumerate() {
        let mut set = |kind: usize, orders_found: &[OrderPower]| {
            for OrderPower { index, strength, .. } in orders_found {
                let Ok(place) = orders.binary_search(index) else { continue };
                for (polarisation, strength) in strength.iter().enumerate() {
                    // Rounding may leave less than nothing.
                    let strength = strength.max(0.0) as f32;
                    strengths[2 * kind + polarisation][beta * orders.len() + place] = strength;
                }
            }
        };
        set(0, &powers.reflected);
        if !opaque {
            set(1, &powers.transmitted);
        }
    }
    if halved {
        let images = images(cell, orders, [false, true]);
        let width = orders.len();
        for strengths in &mut strengths {
            for beta in across.div_ceil(2)..across {
                for (order, &image) in images.iter().enumerate() {
                    strengths[beta * width + order] = strengths[(across - 1 - beta) * width + image];
                }
            }
        }
    }
    Ok((Row { strengths, error: found.error as f32 }, [found.decompositions, found.layers]))
}

#[cfg(test)]
mod tests {
    use goniochrome::table::Periodicity;

    use super::*;
    use crate::scene::parse;

    #[test]
    fn a_front_face_makes_other_work() {
        let scene = |front: &str| {
            let cell = "surface = { kind = \"grooves\", points_nm = [[0, 0], [200, 90], [400, 0]] }";
            let toml = format!(
                "[cell]\nperiod_nm = [400, 400]\n{cell}\n{front}\n[interface.grooves]\nabove = 1.5\nbelow = \"air\"\n"
            );
            parse("lines", &toml).unwrap()
        };
        let layout = OrderLayout::new([3, 3], Periodicity::X, [400.0; 2]).unwrap();
        let request = OrderTableRequest { layout, accuracy: Accuracy::TABLE, threads: 1, share: None };
        let identity = |front: &str| request.identity(&scene(front), &[550.0]);
        assert_eq!(identity(""), identity("# a comment"));
        assert_ne!(identity(""), identity("front = \"air\""));
    }
}
