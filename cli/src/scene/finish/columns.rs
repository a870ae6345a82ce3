//! Distributions of normals as columns of text: θ_m in degrees and D, or θ_m, φ_m and D.

use goniochrome::microfacet::FacetTable;

use super::owned::OwnedFacets;
use crate::scene::diagnostics::SourceText;
use crate::support::error::Result;

/// Rings of a table that depends on θ_m alone, and rings and sectors of one that depends on φ_m too.
const RINGS: usize = 256;
const GRID: [usize; 2] = [96, 72];

/// Rows of one angle θ_m in degrees: azimuths in degrees and D, from a line.
struct Ring {
    theta: f64,
    line: usize,
    values: Vec<[f64; 2]>,
}

/// Reads facets from columns of text, separated by commas, semicolons, tabs or blanks. The first line may name them;
/// empty lines and lines that begin with `#` are skipped.
///
/// θ_m increases from row to row, or from ring to ring, each of which has the azimuths of the first. D is linear
/// between them, constant below the first θ_m, and 0 beyond the last; it may have any unit.
pub(super) fn parse(source: &SourceText<'_>) -> Result<OwnedFacets> {
    let mut rings: Vec<Ring> = Vec::new();
    let mut columns = 0;
    for (line, text) in source.text.lines().enumerate().map(|(i, text)| (i + 1, text.trim())) {
        if text.is_empty() || text.starts_with('#') {
            continue;
        }
        let fields = text.split([',', ';', '\t', ' ']).filter(|field| !field.is_empty());
        let numbers: Option<Vec<f64>> =
            fields.map(|field| field.parse().ok().filter(|x: &f64| x.is_finite())).collect();
        let [theta, phi, density] = match numbers.as_deref() {
            Some(&[theta, density]) => [theta, 0.0, density],
            Some(&[theta, phi, density]) => [theta, phi, density],
            // A line of names.
            None if rings.is_empty() && text.starts_with(|c: char| c.is_alphabetic()) => continue,
            _ => return Err(source.refuse_line(line, "write theta_deg, D or theta_deg, phi_deg, D, each finite")),
        };
        let count = numbers.map_or(0, |numbers| numbers.len());
        if columns != 0 && columns != count {
            return Err(source.refuse_line(line, format_args!("{count} columns, after rows of {columns}")));
        }
        columns = count;
        if !(0.0..=90.0).contains(&theta) {
            return Err(source.refuse_line(line, format_args!("theta_deg is {theta}; it is from 0 to 90")));
        }
        if density < 0.0 {
            return Err(source.refuse_line(line, format_args!("D is {density}; a density is not negative")));
        }
        match rings.last_mut() {
            Some(ring) if ring.theta == theta && columns == 3 => ring.values.push([phi, density]),
            Some(ring) if ring.theta >= theta => {
                return Err(source.refuse_line(line, "theta_deg must increase; sort the rows by it"));
            }
            _ => rings.push(Ring { theta, line, values: vec![[phi, density]] }),
        }
    }
    let Some(first) = rings.first() else {
        return Err(source.refuse_line(1, "no rows; write theta_deg, D or theta_deg, phi_deg, D in each"));
    };
    let azimuths: Vec<f64> = first.values.iter().map(|[phi, _]| *phi).collect();
    let turns = azimuths.last().map_or(0.0, |last| last - azimuths[0]);
    if !azimuths.is_sorted_by(|a, b| a < b) || turns > 360.0 {
        return Err(source.refuse_line(first.line, "phi_deg must increase within a ring, by at most 360"));
    }
    for ring in &rings {
        if !ring.values.iter().map(|[phi, _]| phi).eq(&azimuths) {
            let theta = ring.theta;
            return Err(source.refuse_line(
                ring.line,
                format_args!("the rows of theta_deg {theta} have other azimuths than the first; write a full grid"),
            ));
        }
    }
    let size = if azimuths.len() == 1 { [RINGS, 1] } else { GRID };
    let nodes: Vec<f32> = (0..=size[0])
        .flat_map(|ring| {
            let theta = FacetTable::sin_square(size[0], ring).sqrt().asin().to_degrees();
            (0..size[1]).map(move |sector| [theta, 360.0 * sector as f64 / size[1] as f64])
        })
        .map(|[theta, phi]| at(&rings, theta, phi) as f32)
        .collect();
    OwnedFacets::new(size, &nodes).map_err(|error| source.refuse_line(first.line, error))
}

/// D at angles in degrees.
fn at(rings: &[Ring], theta: f64, phi: f64) -> f64 {
    let above = rings.partition_point(|ring| ring.theta < theta);
    let around = |ring: &Ring| round(&ring.values, phi);
    match (above.checked_sub(1).and_then(|below| rings.get(below)), rings.get(above)) {
        (Some(low), Some(high)) => {
            let part = (theta - low.theta) / (high.theta - low.theta);
            around(low) + part * (around(high) - around(low))
        }
        (None, Some(ring)) => around(ring),
        _ => 0.0,
    }
}

/// D at an azimuth in degrees, linear between those of a ring, which go on after a turn.
fn round(values: &[[f64; 2]], phi: f64) -> f64 {
    let start = values[0][0];
    let phi = start + (phi - start).rem_euclid(360.0);
    let above = values.partition_point(|[at, _]| *at <= phi);
    let [from, low] = values[above.saturating_sub(1)];
    let [to, high] = values.get(above).copied().unwrap_or([start + 360.0, values[0][1]]);
    if to > from { low + (phi - from) / (to - from) * (high - low) } else { low }
}
