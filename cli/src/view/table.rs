//! The table of a page.

use glam::Vec3;
use goniochrome::colour::{Quadrature, RgbSpace};
use goniochrome::microfacet::{Distribution, Finish, Masking};
use goniochrome::table::{FacetLobe, ScatterLayout, ScatterSampler, ScatterTable as Lookup};
use serde_json::{Value, json};

use super::{orders, pack};
use crate::colour::visible_weights;
use crate::support::direction::direction;
use crate::support::error::{Error, Result};
use crate::support::memory::filled;
use crate::table::Table;
use crate::table::metadata::MetadataKey;
use crate::table::mirror::MirrorTable;
use crate::table::scatter::{ScatterTable, warp_pairs};

/// Steps of θ from 0° to 90° in a mirror-like table: tenths of a degree, so that tables of whole degrees lose nothing.
const STEPS: u32 = 900;

/// Parts of a step between the incident directions of a table of scattered light, along θ and along φ: the page
/// prepares its samples at these directions of the viewer, and interpolates them.
const VIEWS_PER_STEP: u32 = 4;

/// Largest number of directions of the viewer. Larger tables have fewer to a step.
const MAX_VIEWS: usize = 16384;

/// Normals of tabulated facets at which pages look: groups of two rings of three normals.
const NORMALS: u32 = 192;
const RING: u32 = 3;
/// Steps from group to group, by Roberts' R2 sequence.
const SHIFT: [f64; 2] = [0.754_877_666_246_692_7, 0.569_840_290_998_053_2];

/// Steps of √cos θ and of φ in tables of what directions see of tabulated facets.
const SEEN_STEPS: u32 = 64;
const SEEN_SECTORS: u32 = 48;

/// A table of any kind. A finish is that of a mirror-like one.
pub(super) fn packed(table: &Table, finish: Option<Finish<'_>>, is_sheet: bool) -> Result<Value> {
    match table {
        Table::Mirror(mirror) => mirror_like(mirror, finish, is_sheet, &facts(table)),
        Table::Scatter(scatter) => scattering(scatter, &facts(table)),
        Table::Orders(orders) => orders::packed(orders, &facts(table)),
    }
}

/// The facts that the page shows of any table.
fn facts(table: &Table) -> Value {
    let metadata = table.metadata();
    let known = |key: MetadataKey| metadata.get(key).unwrap_or_default();
    json!({
        "name": table.name(),
        "model": known(MetadataKey::Model),
        "illuminant": known(MetadataKey::Illuminant),
        "papersColours": metadata.screen_space() == RgbSpace::Paper,
    })
}

fn mirror_like(table: &MirrorTable, finish: Option<Finish<'_>>, is_sheet: bool, facts: &Value) -> Result<Value> {
    // In equal steps of the angle, for each thickness.
    let steps = |colours: &[[f32; 3]]| {
        let rgb = table.metadata.screen_rgb(colours);
        let rows = rgb.chunks(table.theta_deg.len()).flat_map(|rgb| {
            let shown = MirrorTable { theta_deg: table.theta_deg.clone(), rgb: rgb.to_vec(), ..MirrorTable::default() };
            (0..=STEPS).flat_map(move |step| shown.rgb_at(90.0 * f64::from(step) / f64::from(STEPS)))
        });
        pack::floats(rows)
    };
    Ok(json!({
        "kind": "mirror",
        "facts": facts,
        "theta": table.theta_deg,
        "wavelength": table.wavelength_nm,
        "s": pack::floats(table.reflectance_s.iter().copied()),
        "p": pack::floats(table.reflectance_p.iter().copied()),
        "lookup": steps(table.colours()?),
        "through": is_sheet.then(|| steps(&table.rgb_transmitted)),
        "thickness": table.thickness.as_ref().map(|axis| json!({ "layer": axis.layer, "nm": axis.nm })),
        "facets": finish.filter(|finish| finish.distribution().is_none()).map(|finish| facets(&finish)),
        "finish": {
            "roughness": finish.and_then(|finish| finish.alpha()).unwrap_or([0.0; 2]),
            "beckmann": finish.is_some_and(|finish| finish.distribution() == Some(Distribution::Beckmann)),
            "compensated": finish.is_some_and(|finish| finish.compensation().is_some()),
            "separable": finish.is_some_and(|finish| finish.masking() == Masking::Separable),
        },
    }))
}

/// Tabulated facets: normals that the core draws, each with D there and at the normal turned by half a turn about z;
/// and the squared roughness e of the GGX facets of which a direction sees as much area σ, by e = 4 σ (σ − cos
/// θ)/sin²θ.
fn facets(finish: &Finish<'_>) -> Value {
    let normals = (0..NORMALS).flat_map(|i| {
        let (group, look) = (i / (2 * RING), i % (2 * RING));
        let [x, y] = SHIFT.map(|step| f64::from(group) * step);
        let u = [f64::from(look % 2) / 2.0 + 0.25 + y, f64::from(look) / f64::from(2 * RING) + x];
        let m = finish.draw_normal(Vec3::Z, u.map(|u| u.fract() as f32));
        [m.x, m.y, finish.density(m), finish.density(Vec3::new(-m.x, -m.y, m.z))]
    });
    let sectors = if finish.is_isotropic() { 1 } else { SEEN_SECTORS };
    let seen = (0..=SEEN_STEPS).flat_map(|step| {
        // Every direction sees all of a surface from straight above, whatever its roughness.
        let part = f64::from(step).min(f64::from(SEEN_STEPS) - 0.1) / f64::from(SEEN_STEPS);
        let theta = (part * part).max(f64::from(f32::EPSILON)).acos();
        (0..sectors).map(move |sector| {
            let w = direction(theta, std::f64::consts::TAU * f64::from(sector) / f64::from(sectors)).as_vec3();
            let area = finish.visible_area(w);
            4.0 * area * (area - w.z) / (w.x * w.x + w.y * w.y)
        })
    });
    json!({
        "normals": pack::floats(normals),
        "views": [SEEN_STEPS + 1, sectors],
        "seen": pack::floats(seen),
    })
}

fn scattering(table: &ScatterTable, facts: &Value) -> Result<Value> {
    let rgb = table.metadata.screen_rgb(&table.rgb);
    let prepared = table.lookup(rgb.into_flattened(), 3)?;
    let lookup = prepared.table()?;
    let layout = table.layout;
    let mut cumulative = filled(0.0, ScatterSampler::required_len(&layout), "sampling the table")?;
    ScatterSampler::new(&lookup, &mut cumulative).map_err(Error::failed)?;
    // Halves end at 65504, and are precise near 1.
    let largest = prepared.values().iter().fold(0.0_f32, |largest, x| largest.max(x.abs()));
    let scale = if largest > 0.0 { largest } else { 1.0 };
    let spectral = table.spectral_lookup()?;
    let spectral = spectral.table()?;
    let mut albedo = Vec::new();
    for incident in 0..layout.incident_count() {
        let [theta, phi] = layout.incident(incident);
        let mut of_incident = vec![0.0; table.wavelength_nm.len()];
        spectral.albedo(direction(theta, phi).as_vec3(), &mut of_incident);
        albedo.extend(of_incident);
    }
    let views = views(&layout);
    let scattered = (0..views.incident_count()).flat_map(|view| {
        let [theta, phi] = views.incident(view);
        scattered(&lookup, direction(theta, phi).as_vec3())
    });
    let weights = visible_weights(&table.wavelength_nm, table.metadata.illuminant(), Quadrature::Interpolated)?;
    let space = table.metadata.screen_space();
    let [pairs_u, pairs_v] = warp_pairs(&table.warp)?;
    Ok(json!({
        "kind": "scatter",
        "facts": facts,
        "incident": layout.incident_sides(),
        "halfVectors": layout.square_sides(),
        "warp": [pack::floats(pairs_u), pack::floats(pairs_v)],
        "lobes": pack::floats(table.lobes.iter().flat_map(FacetLobe::to_numbers)),
        "wavelength": table.wavelength_nm,
        "rgbWeights": pack::floats(weights.iter().flat_map(|&xyz| space.from_xyz(xyz)).map(|w| w as f32)),
        "albedo": pack::floats(albedo),
        "views": views.incident_sides(),
        "scattered": pack::floats(scattered),
        "scale": scale,
        "atlas": pack::halves(prepared.values().iter().map(|x| x / scale)),
        "cumulative": pack::floats(cumulative.iter().copied()),
    }))
}

/// Directions of the viewer at which the page prepares its samples, as the incident directions of a layout.
fn views(layout: &ScatterLayout) -> ScatterLayout {
    let [rows, columns] = layout.incident_sides();
    let finer = |parts: u32| {
        let columns = if layout.is_isotropic() { 1 } else { columns * parts };
        ScatterLayout::new([(rows - 1) * parts + 1, columns], [2, 1], 0).ok()
    };
    let fits = |views: &ScatterLayout| views.incident_count() <= MAX_VIEWS;
    (1..=VIEWS_PER_STEP).rev().filter_map(finer).find(fits).unwrap_or(*layout)
}

/// Albedo for light from `wi` times cos θ_i, without the lobes.
fn scattered(table: &Lookup<'_>, wi: Vec3) -> [f32; 3] {
    let mut rgb = [0.0; 3];
    table.albedo(wi, &mut rgb);
    for lobe in 0..table.layout().lobes() {
        let mut part = [0.0; 3];
        table.reflected(wi, lobe, &mut part);
        (0..3).for_each(|channel| rgb[channel] -= part[channel]);
    }
    rgb.map(|x| x * wi.z)
}
