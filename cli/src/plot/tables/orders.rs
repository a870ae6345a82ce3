//! Pictures of tables of diffraction orders: streaks of colour, efficiencies over wavelength and angle, colour of all
//! orders together.

use goniochrome::colour::{Quadrature, xyz};
use goniochrome::simd::complex::Polarised;
use goniochrome::table::{OrderTable as Lookup, OrderView, Periodicity};

use crate::colour::visible_weights;
use crate::plot::Picture;
use crate::plot::chromaticity::{ColourAt, chromaticity};
use crate::plot::heat_map::{HeatAxis, heat_map};
use crate::plot::line_chart::{Dash, LineOptions, PALETTE, Series, line_chart};
use crate::support::direction::direction;
use crate::support::error::{Error, Result};
use crate::table::mirror::neighbours;
use crate::table::orders::{LookupArrays, OrderTable};

/// Largest step between plotted wavelengths, in nanometres: efficiencies between those of the table have exact cosines.
const STEP_NM: f64 = 2.0;
/// Largest number of orders in one chart, that of distinct colours.
const MAX_CURVES: usize = PALETTE.len();
/// Largest number of orders in one chart whose s and p are drawn beside their mean.
const MAX_POLARISED: usize = 3;
/// Wavelength of a chart over the angle, unless the user names another, in nanometres.
const WAVELENGTH_NM: f64 = 550.0;

/// Place between the wavelengths of a table: the index of the nearest one below, and the fraction of the way to the
/// next.
pub(super) type Place = (usize, f32);

/// Place of a value among increasing ones, held at their ends.
pub(super) fn place(known: &[f64], value: f64) -> Place {
    let (below, _, t) = neighbours(known, value);
    (below, t as f32)
}

/// The table seen from angles in degrees; a negative θ lies at the opposite azimuth. 90°, at which no light arrives,
/// counts as slightly less.
pub(super) fn view(table: Lookup<'_>, theta_deg: f64, phi_deg: f64) -> Result<OrderView<'_>> {
    /// Largest angle, at which efficiencies differ from those at 90° by less than a pixel.
    const GRAZING_DEG: f64 = 89.9;
    if theta_deg.abs() > 90.0 {
        return Err(Error::usage(format_args!("--theta {theta_deg}: the angle must lie in [0, 90] degrees")));
    }
    let theta = theta_deg.clamp(-GRAZING_DEG, GRAZING_DEG).to_radians();
    let wo = direction(theta, phi_deg.to_radians()).as_vec3();
    table.view(wo).ok_or_else(|| Error::failed("the light lies below the surface"))
}

/// The library's form of a table, without colours.
pub(super) fn unweighted(table: &OrderTable) -> LookupArrays {
    table.arrays(vec![[0.0; 3]; table.wavelength_nm.len()])
}

/// Name of an order: one number for lines, two for crossed periods.
pub(super) fn order_name(periodicity: Periodicity, [m, n]: [i32; 2]) -> String {
    let name = match periodicity {
        Periodicity::X => m.to_string(),
        Periodicity::Y => n.to_string(),
        Periodicity::Both => format!("({m}, {n})"),
    };
    name.replace('-', "−")
}

/// Wavelengths of the table and as many between them that none is further than [`STEP_NM`] from the next.
fn fine_wavelengths(table: &OrderTable) -> Vec<(f64, Place)> {
    let known = &table.wavelength_nm;
    let between = known.windows(2).enumerate().flat_map(|(w, pair)| {
        let steps = ((pair[1] - pair[0]) / STEP_NM).ceil().clamp(1.0, 1000.0);
        (0..steps as u32).map(move |i| {
            let t = f64::from(i) / steps;
            (pair[0] + t * (pair[1] - pair[0]), (w, t as f32))
        })
    });
    between.chain(known.last().map(|&last| (last, (known.len() - 1, 0.0)))).collect()
}

/// Efficiency of an order; NaN, which has no place in a chart, where it is evanescent.
fn efficiency(view: &OrderView<'_>, (wavelength, t): Place, order: usize) -> f64 {
    view.light_between(wavelength, t, order).map_or(f64::NAN, |light| light.efficiency.into())
}

/// Sum of the efficiencies of all orders.
fn albedo(table: &OrderTable, view: &OrderView<'_>, (wavelength, t): Place) -> f64 {
    let orders = 0..table.orders.len();
    orders.filter_map(|order| view.light_between(wavelength, t, order)).map(|light| f64::from(light.efficiency)).sum()
}

/// Indices of the orders that the user names; the table must hold them.
fn named(table: &OrderTable, orders: &[[i32; 2]]) -> Result<Vec<usize>> {
    let index = |order: &[i32; 2]| {
        table.orders.iter().position(|known| known == order).ok_or_else(|| {
            let [first, last] =
                [table.orders.first(), table.orders.last()].map(|order| order.copied().unwrap_or_default());
            let [m, n] = order;
            Error::usage(format_args!(
                "--order {m},{n}: the table holds {} orders, from {},{} to {},{}; name one of them",
                table.orders.len(),
                first[0],
                first[1],
                last[0],
                last[1]
            ))
        })
    };
    orders.iter().map(index).collect()
}

/// Points of a curve.
type Points = Vec<(f64, f64)>;

/// Chart of the efficiencies of orders, each a full curve for unpolarised light; few orders also have dashes for s and
/// dots for p. Without names, the strongest orders are drawn. `curve` gives an order's points for a look-up.
fn efficiencies(
    table: &OrderTable,
    title: &str,
    x_label: &str,
    orders: &[[i32; 2]],
    curve: &dyn Fn(Lookup<'_>, usize) -> Result<Points>,
) -> Result<Picture> {
    let arrays = unweighted(table);
    let mean = arrays.table()?;
    let curves = (0..table.orders.len()).map(|order| curve(mean, order)).collect::<Result<Vec<Points>>>()?;
    let strength = |order: usize| curves[order].iter().map(|point| point.1).fold(0.0, f64::max);
    let travelling = (0..curves.len()).filter(|&order| strength(order) > 0.0).count();
    let mut shown = named(table, orders)?;
    if shown.is_empty() {
        shown.extend(0..curves.len());
        shown.retain(|&order| strength(order) > 0.0);
        shown.sort_by(|a, b| strength(*b).total_cmp(&strength(*a)));
        shown.truncate(MAX_CURVES);
        shown.sort_unstable();
    }
    let polarised = if shown.len() > MAX_POLARISED {
        None
    } else {
        let [s, p] = [&table.reflected.s, &table.reflected.p].map(|only| {
            let reflected = Polarised { s: only.clone(), p: only.clone() };
            unweighted(&OrderTable { reflected, ..table.clone() })
        });
        Some([(s, Dash::Long, "s"), (p, Dash::Short, "p")])
    };
    let mut series = Vec::new();
    for (&order, colour) in shown.iter().zip(PALETTE.iter().cycle()) {
        let name = order_name(table.layout.periodicity(), table.orders[order]);
        let one = |label, dash, points| Series { label, colour: (*colour).to_owned(), points, dash };
        series.push(one(format!("order {name}"), Dash::None, curves[order].clone()));
        for (arrays, dash, letter) in polarised.iter().flatten() {
            series.push(one(format!("{name} {letter}"), *dash, curve(arrays.table()?, order)?));
        }
    }
    let left_out = travelling.saturating_sub(shown.len());
    let title = match left_out {
        0 => title.to_owned(),
        _ if orders.is_empty() => format!("{title}, the strongest {} of {travelling} orders", shown.len()),
        _ => format!("{title}, {} of {travelling} orders", shown.len()),
    };
    Ok(line_chart(&title, x_label, "Efficiency", &series, LineOptions::default()))
}

/// Efficiencies against the wavelength, for light from one direction.
///
/// # Errors
/// An angle beyond 90°, an order that the table lacks.
pub fn spectra(table: &OrderTable, name: &str, theta_deg: f64, phi_deg: f64, orders: &[[i32; 2]]) -> Result<Picture> {
    let wavelengths = fine_wavelengths(table);
    let curve = |lookup: Lookup<'_>, order: usize| {
        let view = view(lookup, theta_deg, phi_deg)?;
        Ok(wavelengths.iter().map(|&(nm, place)| (nm, efficiency(&view, place, order))).collect())
    };
    let title = format!("{name}: light from θ = {theta_deg}°, φ = {phi_deg}°");
    efficiencies(table, &title, "Wavelength (nm)", orders, &curve)
}

/// Efficiencies against the angle of incidence, in the plane of one azimuth and at one wavelength. Angles below 0 are
/// those of light from the opposite azimuth.
///
/// # Errors
/// A wavelength outside the table, an order that the table lacks.
pub fn over_angle(
    table: &OrderTable,
    name: &str,
    wavelength_nm: Option<f64>,
    phi_deg: f64,
    orders: &[[i32; 2]],
) -> Result<Picture> {
    let known = &table.wavelength_nm;
    let [first, last] = [known.first(), known.last()].map(|nm| nm.copied().unwrap_or_default());
    let nm = wavelength_nm.unwrap_or_else(|| WAVELENGTH_NM.clamp(first, last));
    if !(first..=last).contains(&nm) {
        return Err(Error::usage(format_args!("--wavelength {nm}: the table goes from {first} to {last} nm")));
    }
    let place = place(known, nm);
    let curve = |lookup: Lookup<'_>, order: usize| {
        let point = |half: i32| {
            let theta = 0.5 * f64::from(half);
            Ok((theta, efficiency(&view(lookup, theta, phi_deg)?, place, order)))
        };
        (-180..=180).map(point).collect()
    };
    let title = format!("{name}: light of {nm} nm in the plane φ = {phi_deg}°");
    efficiencies(table, &title, "Angle of incidence; negative from the opposite azimuth, °", orders, &curve)
}

/// Efficiency of one order, or else of all together, over the wavelength and the angle of incidence in the plane of one
/// azimuth.
///
/// # Errors
/// A table of one wavelength, several orders, an order that the table lacks.
pub fn map(table: &OrderTable, name: &str, phi_deg: f64, orders: &[[i32; 2]]) -> Result<Picture> {
    if table.wavelength_nm.len() < 2 {
        return Err(Error::usage("--kind map: the table has one wavelength; a map needs two or more"));
    }
    let order = match named(table, orders)?[..] {
        [] => None,
        [order] => Some(order),
        _ => return Err(Error::usage("--order: a map shows one order, or all together; name one")),
    };
    let arrays = unweighted(table);
    let lookup = arrays.table()?;
    let wavelengths = fine_wavelengths(table);
    let theta: Vec<f64> = (-360..=360).map(|quarter| 0.25 * f64::from(quarter)).collect();
    let mut values = Vec::with_capacity(theta.len() * wavelengths.len());
    for &theta in &theta {
        let view = view(lookup, theta, phi_deg)?;
        let at = |place| order.map_or_else(|| albedo(table, &view, place), |order| efficiency(&view, place, order));
        values.extend(wavelengths.iter().map(|&(_, place)| at(place)));
    }
    let (what, bar) = match order {
        Some(order) => (format!("order {}", order_name(table.layout.periodicity(), table.orders[order])), "Efficiency"),
        None => ("all reflected orders".to_owned(), "Albedo"),
    };
    let nm: Vec<f64> = wavelengths.iter().map(|(nm, _)| *nm).collect();
    Ok(heat_map(
        &format!("{name}: {what}, light at φ = {phi_deg}°"),
        HeatAxis { label: "Wavelength (nm)", coordinates: &nm },
        HeatAxis { label: "Angle of incidence, °", coordinates: &theta },
        &values,
        bar,
        None,
    ))
}

/// The path of the colour of all orders together over the angle, with the colours at `theta_deg` marked.
///
/// # Errors
/// None of the wavelengths is visible; an angle beyond 90°.
pub fn colour_path(table: &OrderTable, name: &str, theta_deg: &[f64], phi_deg: f64) -> Result<Picture> {
    let light = table.metadata.illuminant();
    let weights = visible_weights(&table.wavelength_nm, light, Quadrature::Interpolated)?;
    let arrays = unweighted(table);
    let lookup = arrays.table()?;
    let at = |theta_deg: f64| {
        let view = view(lookup, theta_deg, phi_deg)?;
        let reflected = (0..table.wavelength_nm.len()).map(|w| f64::from(view.albedo(w)));
        Ok(ColourAt { theta_deg, xyz: xyz(&weights, reflected) })
    };
    let path = (0..90).map(|theta| at(f64::from(theta))).collect::<Result<Vec<_>>>()?;
    let marked = theta_deg.iter().map(|&theta| at(theta)).collect::<Result<Vec<_>>>()?;
    let title = format!("{name}: colour of all reflected light over the angle of incidence, φ = {phi_deg}°");
    Ok(chromaticity(&title, light, &path, &marked))
}

#[cfg(test)]
mod tests {
    use goniochrome::table::match_factor;

    use super::*;
    use crate::table::orders::tests::sample;

    #[test]
    fn curves_are_the_efficiencies_of_orders_that_travel() {
        let table = sample();
        let arrays = unweighted(&table);
        let lookup = arrays.table().unwrap();
        // At 60° order 1 of 700 nm travels where sin 60° − λ/Λ > −1; order −1 nowhere.
        let view = view(lookup, 60.0, 0.0).unwrap();
        let wavelengths = fine_wavelengths(&table);
        assert_eq!((wavelengths[0].0, wavelengths[75].0), (450.0, 600.0));
        for &(nm, place) in &wavelengths {
            assert!(efficiency(&view, place, 0).is_nan(), "{nm}");
            let outgoing = nm / 700.0 - 60_f64.to_radians().sin();
            let factor = match_factor(0.5, (1.0 - outgoing * outgoing).sqrt() as f32);
            let strength = efficiency(&view, place, 2) / f64::from(factor);
            // Strengths of the sample lie between 0.05 and 0.41.
            assert!((0.05..0.42).contains(&strength), "{nm}: {strength}");
            let sum = efficiency(&view, place, 1) + efficiency(&view, place, 2);
            assert!((albedo(&table, &view, place) - sum).abs() < 1e-6, "{nm}");
        }
        let svg = spectra(&table, "lines", 60.0, 0.0, &[]).unwrap();
        let svg = svg.svg();
        assert!(svg.contains(">order 0<") && svg.contains(">order 1<") && !svg.contains(">order −1<"));
        assert!(svg.contains(">1 s<") && svg.contains("stroke-dasharray=\"2 3\""));
    }

    #[test]
    fn what_the_table_lacks_is_refused() {
        let table = sample();
        let refusal = |picture: Result<Picture>| picture.unwrap_err().to_string();
        assert!(refusal(spectra(&table, "", 0.0, 0.0, &[[2, 0]])).contains("3 orders, from -1,0 to 1,0"));
        assert!(refusal(spectra(&table, "", 91.0, 0.0, &[])).contains("[0, 90]"));
        assert!(refusal(over_angle(&table, "", Some(700.0), 0.0, &[])).contains("from 450 to 600 nm"));
        assert!(refusal(map(&table, "", 0.0, &[[0, 0], [1, 0]])).contains("one order"));
        let one = OrderTable { wavelength_nm: vec![500.0], ..sample() };
        assert!(refusal(map(&one, "", 0.0, &[])).contains("two or more"));
    }

    #[test]
    fn orders_have_names() {
        assert_eq!(order_name(Periodicity::X, [-1, 0]), "−1");
        assert_eq!(order_name(Periodicity::Y, [0, 2]), "2");
        assert_eq!(order_name(Periodicity::Both, [-1, 2]), "(−1, 2)");
    }
}
