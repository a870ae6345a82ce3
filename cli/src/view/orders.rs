//! The table of diffraction orders of a page.

use goniochrome::colour::{Quadrature, VISIBLE_NM};
use goniochrome::table::{OrderLayout, Periodicity};
use serde_json::{Value, json};

use super::pack;
use crate::colour::visible_weights;
use crate::support::error::{Error, Result};
use crate::table::mirror::neighbours;
use crate::table::orders::OrderTable;

/// Wavelengths at which one picture looks; the shader holds at most 16.
const GROUPS: usize = 8;
/// Number of pictures, a power of two, whose wavelengths together are evenly spread.
const PICTURES: usize = 32;
/// Nodes along α and along a half of β for colours in even light.
const ALBEDO_NODES: [u32; 2] = [192, 64];
/// Orders that the shader holds: (0, 0), and 32 times four.
const MAX_ORDERS: usize = 129;
/// Wavelengths between which pictures look. The 0.6 % of white light that lies beyond counts at the ends.
const SEEN_NM: [f64; 2] = [400.0, 700.0];

pub(super) fn packed(table: &OrderTable, facts: &Value) -> Result<Value> {
    let (illuminant, space) = (table.metadata.illuminant(), table.metadata.screen_space());
    let rgb = |wavelength_nm: &[f64]| -> Result<Vec<[f64; 3]>> {
        let weights = visible_weights(wavelength_nm, illuminant, Quadrature::Interpolated)?;
        Ok(weights.into_iter().map(|xyz| space.from_xyz(xyz)).collect())
    };
    let weights = rgb(&table.wavelength_nm)?;
    let strengths = table.unpolarised();
    let (count, nodes, wavelengths) = (table.orders.len(), table.layout.count(), table.wavelength_nm.len());
    let lit = |order: usize| strengths.iter().skip(order).step_by(count).any(|&x| x > 0.0);
    let zeroth = |order: &usize| table.orders[*order] == [0, 0];
    let shown: Vec<usize> =
        (0..count).filter(zeroth).chain((0..count).filter(|order| !zeroth(order) && lit(*order))).collect();
    if shown.len() > MAX_ORDERS {
        return Err(Error::failed(format_args!(
            "the surface has {} orders, more than the {MAX_ORDERS} of a page; `goniochrome render` draws it",
            shown.len()
        )));
    }
    let medium = Medium { wavelength_nm: &table.wavelength_nm, index: &table.index_above };
    let (looks, range) = medium.looked_at();
    let per_look = looks.len() as f64 / (range[1] - range[0]);
    let look = |(&nm, rgb): (&f64, [f64; 3])| {
        let (below, above, share) = neighbours(&table.wavelength_nm, nm);
        let layer = (below as f64 + share * (above - below) as f64 + 0.5) / wavelengths as f64;
        [rgb[0] * per_look, rgb[1] * per_look, rgb[2] * per_look, layer].map(|x| x as f32)
    };
    let response: Vec<f32> = looks.iter().zip(rgb(&looks)?).flat_map(look).collect();

    let arrays = table.arrays(weights.iter().copied());
    let lookup = arrays.table()?;
    // Without lines β has two halves.
    let halves = if table.layout.periodicity().has_lines() { 1 } else { 2 };
    let albedo_nodes = [ALBEDO_NODES[0], halves * ALBEDO_NODES[1]];
    let albedo = OrderLayout::new(albedo_nodes, table.layout.periodicity(), table.layout.period_nm())
        .map_err(Error::failed)
        .map(|nodes| (0..nodes.count()).map(move |node| nodes.direction(node).as_vec3()))?
        .flat_map(|wo| {
            let view = lookup.view(wo);
            coloured(&weights, |w| view.map_or(0.0, |view| view.albedo(w)))
        });
    let zero = shown.first().copied().unwrap_or(0);
    let mirrored = (0..nodes).flat_map(|node| coloured(&weights, |w| strengths[(w * nodes + node) * count + zero]));
    let strength = |(w, order, node): (usize, usize, usize)| strengths[(w * nodes + node) * count + order];
    let shown_orders = &shown;
    let places = (0..wavelengths)
        .flat_map(|w| shown_orders.iter().flat_map(move |&order| (0..nodes).map(move |node| (w, order, node))));
    Ok(json!({
        "kind": "orders",
        "facts": facts,
        "nodes": table.layout.nodes(),
        "lines": match table.layout.periodicity() {
            Periodicity::X => 1,
            Periodicity::Y => 2,
            Periodicity::Both => 0,
        },
        "period": table.layout.period_nm(),
        "orders": shown.iter().map(|&order| table.orders[order]).collect::<Vec<_>>(),
        "wavelength": table.wavelength_nm,
        "index": table.index_above,
        "rgbWeights": pack::floats(weights.iter().flatten().map(|w| *w as f32)),
        "response": pack::floats(response),
        "range": range,
        "albedoNodes": albedo_nodes,
        "albedo": pack::halves(albedo),
        "mirrored": pack::halves(mirrored),
        "groups": GROUPS,
        "pictures": PICTURES,
        "strengths": pack::halves(places.map(strength)),
    }))
}

/// Linear RGB of a reflectance at each wavelength.
fn coloured(weights: &[[f64; 3]], reflectance: impl Fn(usize) -> f32) -> [f32; 3] {
    let mut sum = [0.0; 3];
    for (w, weight) in weights.iter().enumerate() {
        let reflectance = f64::from(reflectance(w));
        (0..3).for_each(|c| sum[c] += weight[c] * reflectance);
    }
    sum.map(|x| x as f32)
}

/// The medium above the surface.
struct Medium<'a> {
    wavelength_nm: &'a [f64],
    index: &'a [f64],
}

impl Medium<'_> {
    /// Wavelength in the medium.
    fn inside(&self, nm: f64) -> f64 {
        let (below, above, share) = neighbours(self.wavelength_nm, nm);
        nm / (self.index[below] + share * (self.index[above] - self.index[below]))
    }

    /// Wavelengths of all pictures, in the middles of steps over the visible part of the table that are equal in the
    /// medium, and the first and last of those steps' ends in the medium.
    fn looked_at(&self) -> (Vec<f64>, [f64; 2]) {
        let [mut first, mut last] = self.ends(SEEN_NM);
        if first >= last {
            [first, last] = self.ends(VISIBLE_NM.map(f64::from));
        }
        // A table of one wavelength.
        last = last.max(first + 1.0);
        let range = [first, last].map(|nm| self.inside(nm));
        let count = GROUPS * PICTURES;
        let place = |i: usize| (i as f64 + 0.5) / count as f64;
        let looks = (0..count).map(|i| {
            let wanted = range[0] + (range[1] - range[0]) * place(i);
            // Wavelengths grow in the medium as in vacuum.
            let (mut low, mut high) = (first, last);
            for _ in 0..48 {
                let middle = 0.5 * (low + high);
                if self.inside(middle) < wanted { low = middle } else { high = middle }
            }
            0.5 * (low + high)
        });
        let looks: Vec<f64> = looks.collect();
        if looks.is_sorted_by(|a, b| a < b) {
            return (looks, range);
        }
        // No real medium is so dispersive.
        ((0..count).map(|i| first + (last - first) * place(i)).collect(), range)
    }

    /// The part of the table between two wavelengths.
    fn ends(&self, [first, last]: [f64; 2]) -> [f64; 2] {
        [
            self.wavelength_nm.first().map_or(first, |nm| nm.max(first)),
            self.wavelength_nm.last().map_or(last, |nm| nm.min(last)),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wavelengths_are_looked_at_where_they_are_seen() {
        for (wavelength_nm, first, last) in
            [(vec![380.0, 780.0], 400.0, 700.0), (vec![450.0, 600.0], 450.0, 600.0), (vec![550.0], 550.0, 551.0)]
        {
            let index: Vec<f64> = wavelength_nm.iter().map(|nm| 1.5 + 20.0 / nm).collect();
            let medium = Medium { wavelength_nm: &wavelength_nm, index: &index };
            let (looks, range) = medium.looked_at();
            assert_eq!(looks.len(), GROUPS * PICTURES);
            assert!(looks.is_sorted() && looks[0] > first && looks[looks.len() - 1] < last, "{wavelength_nm:?}");
            let step = (range[1] - range[0]) / looks.len() as f64;
            let even = |(i, nm): (usize, &f64)| (medium.inside(*nm) - range[0]) / step - i as f64 - 0.5;
            assert!(looks.iter().enumerate().map(even).all(|off| off.abs() < 1e-6), "{wavelength_nm:?}");
        }
    }
}
