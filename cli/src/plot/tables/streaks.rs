//! Picture of the outgoing hemisphere of a table of diffraction orders: each order is a streak of colour.

use glam::{DVec2, DVec3};
use goniochrome::colour::{Quadrature, VISIBLE_NM};
use goniochrome::table::{OrderTable as Lookup, OrderView};

use super::orders::{Place, order_name, place, unweighted, view};
use crate::colour::{visible_weights, xyz_to_rgb};
use crate::plot::Picture;
use crate::plot::disc::{Disc, Mark, MarkShape, marked_disc};
use crate::plot::encode::in_gamut;
use crate::support::direction::direction;
use crate::support::error::{Error, Result};
use crate::table::orders::OrderTable;

/// Angle of the light, unless the user names another.
const THETA_DEG: f64 = 30.0;
/// Half the width of a streak.
const HALF_WIDTH_DEG: f64 = 2.0;
/// Radius of the spot of order (0, 0).
const SPOT_DEG: f64 = 4.5;
/// Share of a half width within which a streak has its full brightness.
const CORE: f64 = 0.6;
/// Distance of the name of an order from its streak, for names of no width.
const NAME_DEG: f64 = 5.0;
/// Half the width of a letter of a name.
const LETTER_DEG: f64 = 1.6;
/// Least brightness of an order with a name, over that of the brightest.
const MIN_NAMED: f64 = 0.01;
/// Wavelengths at which a name may stand beside its streak, the best first.
const NAMED_NM: [f64; 6] = [550.0, 500.0, 600.0, 450.0, 650.0, 400.0];

/// Linear RGB of light at whole nanometres of the visible range, its brightest component 1 within the gamut.
struct Rainbow(Vec<[f32; 3]>);

impl Rainbow {
    fn new(table: &OrderTable) -> Result<Self> {
        let [first, last] = VISIBLE_NM;
        let nm: Vec<f64> = (first..=last).map(f64::from).collect();
        let matrix = xyz_to_rgb(table.metadata.screen_space());
        let weights = visible_weights(&nm, table.metadata.illuminant(), Quadrature::Sampled)?;
        let rgb: Vec<[f32; 3]> =
            weights.into_iter().map(|xyz| (matrix * DVec3::from_array(xyz)).as_vec3().to_array()).collect();
        let brightest = rgb.iter().flat_map(|rgb| in_gamut(*rgb)).fold(0.0, f64::max) as f32;
        Ok(Self(rgb.into_iter().map(|rgb| rgb.map(|c| c / brightest)).collect()))
    }

    /// Colour of a wavelength; black where it is invisible.
    fn at(&self, nm: f64) -> [f32; 3] {
        let [first, last] = VISIBLE_NM.map(f64::from);
        if !(first..=last).contains(&nm) {
            return [0.0; 3];
        }
        let below = ((nm - first) as usize).min(self.0.len() - 2);
        let t = (nm - first) as f32 - below as f32;
        std::array::from_fn(|c| self.0[below][c] + t * (self.0[below + 1][c] - self.0[below][c]))
    }
}

/// The orders that light from one direction leaves in.
struct Streaks<'a> {
    table: &'a OrderTable,
    view: OrderView<'a>,
    /// Tangential component of the mirror direction.
    mirror: DVec2,
    /// Wavelengths in the medium above, in nanometres.
    in_medium_nm: Vec<f64>,
    rainbow: Rainbow,
}

impl<'a> Streaks<'a> {
    fn new(table: &'a OrderTable, lookup: Lookup<'a>, theta_deg: f64, phi_deg: f64) -> Result<Self> {
        let wi = direction(theta_deg.to_radians(), phi_deg.to_radians());
        Ok(Self {
            table,
            view: view(lookup, theta_deg, phi_deg)?,
            mirror: -wi.truncate(),
            in_medium_nm: table.wavelength_nm.iter().zip(&table.index_above).map(|(nm, n)| nm / n).collect(),
            rainbow: Rainbow::new(table)?,
        })
    }

    /// Tangential component that an order adds for each nanometre of the wavelength in the medium.
    fn step(&self, order: usize) -> DVec2 {
        let [m, n] = self.table.orders[order].map(f64::from);
        let [x, y] = self.table.layout.period_nm().map(f64::from);
        DVec2::new(m / x, n / y)
    }

    /// Vacuum wavelength of a place.
    fn nm(&self, (below, t): Place) -> f64 {
        let known = &self.table.wavelength_nm;
        known.get(below + 1).map_or(known[below], |next| known[below] + f64::from(t) * (next - known[below]))
    }

    /// Colour of an order at a wavelength, and the direction in which it leaves; `None` where it is evanescent.
    fn light(&self, place: Place, order: usize) -> Option<([f32; 3], DVec3)> {
        let light = self.view.light_between(place.0, place.1, order)?;
        let colour = self.rainbow.at(self.nm(place)).map(|c| c * light.efficiency);
        Some((colour, light.direction.as_dvec3()))
    }

    /// Colour of all streaks in a direction. Order (0, 0), which does not depend on the wavelength, is not among them.
    fn colour(&self, wo: DVec3) -> [f32; 3] {
        let mut sum = [0.0; 3];
        for order in 0..self.table.orders.len() {
            let step = self.step(order);
            let offset = wo.truncate() - self.mirror;
            // A tangential component differs by no more than the angle.
            let across = offset.perp_dot(step) / step.length();
            if step == DVec2::ZERO || across.abs() > HALF_WIDTH_DEG.to_radians() {
                continue;
            }
            let nearest = place(&self.in_medium_nm, offset.dot(step) / step.length_squared());
            let Some((colour, direction)) = self.light(nearest, order) else { continue };
            let cover = cover(direction.angle_between(wo).to_degrees(), HALF_WIDTH_DEG);
            sum = std::array::from_fn(|c| sum[c] + cover * colour[c]);
        }
        sum
    }

    /// Orders with their brightest components and where it is, the brightest order first.
    fn brightest(&self) -> Vec<(usize, f64, f64)> {
        let [first, last] = VISIBLE_NM;
        let places: Vec<Place> = (first..=last).map(|nm| place(&self.table.wavelength_nm, nm.into())).collect();
        let mut orders: Vec<_> = (0..self.table.orders.len())
            .filter(|&order| self.table.orders[order] != [0, 0])
            .filter_map(|order| {
                let lights = places.iter().filter_map(|&place| Some((self.light(place, order)?.0, self.nm(place))));
                let component = |(rgb, nm): ([f32; 3], f64)| (in_gamut(rgb).into_iter().fold(0.0, f64::max), nm);
                let (most, nm) = lights.map(component).max_by(|a, b| a.0.total_cmp(&b.0))?;
                (most > 0.0).then_some((order, most, nm))
            })
            .collect();
        orders.sort_by(|a, b| b.1.total_cmp(&a.1));
        orders
    }

    /// Marks with the names of orders beside their streaks, where no other name stands.
    fn names(&self, orders: impl Iterator<Item = usize>) -> Vec<Mark> {
        let mut taken: Vec<(DVec2, f64)> = Vec::new();
        let mut marks = Vec::new();
        for order in orders {
            let at = |nm: f64| {
                let known = &self.table.wavelength_nm;
                let inside = known.first()? <= &nm && &nm <= known.last()?;
                let (below, _) = place(known, nm);
                let [start, end] = [0.0, 0.05].map(|t| Some(on_disc(self.light((below, t), order)?.1)));
                inside.then_some((start?, end? - start?))
            };
            let Some((point, along)) = NAMED_NM.iter().find_map(|&nm| at(nm)) else { continue };
            let side = along.normalize_or(DVec2::X).perp();
            // Above a streak, or right of one that is upright.
            let up = if side.y.abs() > 0.1 { side * side.y.signum() } else { side * side.x.signum() };
            let text = order_name(self.table.layout.periodicity(), self.table.orders[order]);
            let half_width = LETTER_DEG * text.chars().count() as f64;
            let beside = point + (NAME_DEG + half_width * up.x.abs()) * up;
            let apart = |other: &(DVec2, f64)| {
                let distance = (other.0 - beside).abs();
                distance.x > half_width + other.1 || distance.y > NAME_DEG
            };
            if beside.length() + half_width < 88.0 && taken.iter().all(apart) {
                taken.push((beside, half_width));
                let phi_deg = beside.to_angle().to_degrees();
                marks.push(Mark { theta_deg: beside.length(), phi_deg, shape: MarkShape::Text(text) });
            }
        }
        marks
    }
}

/// Place of a direction on the disc, in degrees from its centre.
fn on_disc(direction: DVec3) -> DVec2 {
    direction.truncate().normalize_or_zero() * direction.z.clamp(-1.0, 1.0).acos().to_degrees()
}

/// Brightness of a streak or spot at an angle from its middle: full in the core, 0 at the half width, smooth between.
fn cover(angle_deg: f64, half_width_deg: f64) -> f32 {
    let t = ((angle_deg / half_width_deg - CORE) / (1.0 - CORE)).clamp(0.0, 1.0);
    (1.0 - t * t * (3.0 - 2.0 * t)) as f32
}

/// The disc of outgoing directions for light from one direction. Directions are exact; a streak has the colours of its
/// wavelengths times their efficiencies, and order (0, 0) is a spot with its colour.
///
/// # Errors
/// More than one angle of the light, an angle beyond 90°, no visible wavelength.
pub fn outgoing(table: &OrderTable, name: &str, theta_deg: Option<&[f64]>, phi_deg: f64) -> Result<Picture> {
    let &[theta_deg] = theta_deg.unwrap_or(&[THETA_DEG]) else {
        return Err(Error::usage("--theta: the disc of a cell shows the light of one direction; name one angle"));
    };
    let light = table.metadata.illuminant();
    let weights = visible_weights(&table.wavelength_nm, light, Quadrature::Interpolated)?;
    let arrays = unweighted(table);
    let streaks = Streaks::new(table, arrays.table()?, theta_deg, phi_deg)?;
    let zero = table.orders.iter().position(|order| *order == [0, 0]);
    let reflectance = |w: usize| zero.and_then(|zero| streaks.view.light(w, zero)).map_or(0.0, |l| l.efficiency.into());
    let xyz = goniochrome::colour::xyz(&weights, (0..weights.len()).map(reflectance));
    let spot = (xyz_to_rgb(table.metadata.screen_space()) * DVec3::from_array(xyz)).as_vec3().to_array();
    let mirror = direction(theta_deg.to_radians(), (phi_deg + 180.0).to_radians());
    let orders = streaks.brightest();
    let scale = orders.first().map_or(0.0, |(_, most, _)| most.recip() as f32);
    let rgb = |theta: f64, phi: f64| {
        let wo = direction(theta.to_radians(), phi.to_radians());
        let colour = streaks.colour(wo);
        let cover = cover(wo.angle_between(mirror).to_degrees(), SPOT_DEG);
        std::array::from_fn(|c| scale * colour[c] * (1.0 - cover) + spot[c] * cover)
    };
    let label = format!("{name}: light from θ = {theta_deg}°, φ = {phi_deg}°");
    let brightest = match orders.first() {
        Some(&(order, _, nm)) => {
            let (below, t) = place(&table.wavelength_nm, nm);
            let efficiency = streaks.view.light_between(below, t, order).map_or(0.0, |light| light.efficiency);
            let name = order_name(table.layout.periodicity(), table.orders[order]);
            format!(
                "streaks {}° wide, scaled to the brightest: order {name}, efficiency {efficiency:.3} at {nm:.0} nm",
                2.0 * HALF_WIDTH_DEG
            )
        }
        None => "no order but (0, 0) leaves the surface".to_owned(),
    };
    let notes = [brightest, "ring: the light, cross: its mirror direction, with the colour of order 0".to_owned()];
    let bright = orders.iter().filter(|(_, most, _)| f64::from(scale) * most >= MIN_NAMED);
    let mut marks = streaks.names(bright.map(|(order, ..)| *order));
    marks.extend([
        Mark { theta_deg, phi_deg, shape: MarkShape::Ring },
        Mark { theta_deg, phi_deg: phi_deg + 180.0, shape: MarkShape::Cross },
    ]);
    let disc = Disc { label: &label, rgb: &rgb, theta_max_deg: 90.0, azimuthal: true };
    Ok(marked_disc(&disc, &marks, &notes))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::table::orders::tests::sample;

    #[test]
    fn streaks_follow_the_grating_equation() {
        let table = sample();
        let arrays = unweighted(&table);
        let streaks = Streaks::new(&table, arrays.table().unwrap(), 20.0, 0.0).unwrap();
        let towards = |nm: f64| {
            let x: f64 = nm / 700.0 - 20_f64.to_radians().sin();
            DVec3::new(x, 0.0, (1.0 - x * x).sqrt())
        };
        for nm in [450.0, 530.0, 600.0] {
            let [r, g, b] = streaks.colour(towards(nm));
            let strongest = [r, g, b].iter().copied().fold(0.0, f32::max);
            let expected = if nm < 500.0 {
                b
            } else if nm < 580.0 {
                g
            } else {
                r
            };
            assert!(expected > 0.0 && expected >= strongest, "{nm}: {r} {g} {b}");
        }
        // Beside the streak, and beyond the ends of the table's wavelengths.
        let beside = DVec3::new(towards(530.0).x, 0.1, 0.0);
        let beside = DVec3 { z: (1.0 - beside.length_squared()).sqrt(), ..beside };
        assert_eq!([beside, towards(380.0), towards(650.0)].map(|wo| streaks.colour(wo)), [[0.0; 3]; 3]);
    }

    #[test]
    fn the_disc_names_its_orders_and_says_its_scale() {
        let svg = outgoing(&sample(), "lines", Some(&[20.0]), 0.0).unwrap();
        let svg = svg.svg();
        assert!(
            svg.contains(">1</text>") && svg.contains("streaks 4° wide, scaled to the brightest: order 1"),
            "{svg}"
        );
        let many = outgoing(&sample(), "lines", Some(&[20.0, 30.0]), 0.0).unwrap_err();
        assert!(many.to_string().contains("name one angle"));
        let infrared = OrderTable { wavelength_nm: vec![900.0, 950.0], ..sample() };
        assert!(outgoing(&infrared, "lines", None, 0.0).unwrap_err().to_string().contains("invisible"));
    }
}
