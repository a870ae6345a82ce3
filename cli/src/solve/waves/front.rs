//! The plane front face of a thick plate over a structure, as over the tracks of a disc.
//!
//! The plate is much thicker than light is coherent, so that powers add. Light passes the face by Fresnel's formulas,
//! with one wavevector along the surface on both sides, so that each order keeps its number. What the face sends back,
//! wholly beyond the critical angle, meets the structure again in its order and is diffracted again: with b the powers
//! that leave the structure and a those that first reach it, b = P (a + R b), for the efficiencies P of the structure
//! between all orders and polarisations that travel in the plate, and the reflectances R of the face. s and p of an
//! order add as powers, which leaves out how they interfere where an order meets the structure a second time.

use goniochrome_waves::response::{Order, Response};

use crate::solve::waves::powers::{DirectionPowers, OrderPower, is_opaque};

/// Share of the light that a repeated reflection may still carry when the sum ends.
const NEGLIGIBLE: f64 = 1e-12;
/// Bound on repeated reflections: a plate that loses 0.1 % each time is below [`NEGLIGIBLE`] after 28 000.
const MAX_REFLECTIONS: usize = 30_000;

/// Front face of a plate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct FrontFace {
    /// Index of the medium in front.
    pub outside: f64,
    /// Index of the plate.
    pub plate: f64,
}

/// Response of the structure to light in one order, by its number.
pub(super) struct OrderResponse {
    pub number: i32,
    /// Length of its wavevector along the surface, in units of k₀.
    pub tangential: f64,
    pub response: Response,
}

impl FrontFace {
    /// Cosines outside and in the plate at a wavevector along the surface; 0 where the wave is evanescent.
    fn cosines(self, tangential: f64) -> [f64; 2] {
        [self.outside, self.plate].map(|n| (1.0 - (tangential / n).powi(2)).max(0.0).sqrt())
    }

    /// Transmittance of the face in s and in p over the cosine outside; finite at the critical angle.
    fn transmittance_over_cosine(self, tangential: f64) -> [f64; 2] {
        let [outside, plate] = self.cosines(tangential);
        let part = |front: f64, back: f64, n: f64| n * plate / (front + back).powi(2);
        let four = 4.0 * self.outside * self.plate;
        [part(self.outside * outside, self.plate * plate, four), part(self.outside * plate, self.plate * outside, four)]
    }

    /// Transmittance of the face in s and in p.
    fn transmittance(self, tangential: f64) -> [f64; 2] {
        let [outside, _] = self.cosines(tangential);
        self.transmittance_over_cosine(tangential).map(|t| t * outside)
    }

    /// Powers of orders outside for light that arrives outside in order 0.
    pub fn seen(self, structure: &[OrderResponse]) -> DirectionPowers {
        let Some(arriving) = structure.iter().position(|order| order.number == 0) else {
            return DirectionPowers::default();
        };
        let tangential = structure[arriving].tangential;
        let [cos_i, _] = self.cosines(tangential);
        let place = |number: i32| structure.iter().position(|order| order.number == number);
        // Power of a plate's order and polarisation by those of another.
        let scattered = |power: &[[f64; 2]]| {
            let mut sum = vec![[0.0; 2]; structure.len()];
            for (from, arriving) in structure.iter().zip(power) {
                let response = &from.response;
                for order in &response.reflected {
                    let Some(to) = place(from.number + number(order)) else { continue };
                    for (jones, power) in order.jones.iter().zip(arriving) {
                        for (sum, amplitude) in sum[to].iter_mut().zip(jones) {
                            *sum += power * amplitude.norm_sqr() * order.vertical.re / response.incident_vertical;
                        }
                    }
                }
            }
            sum
        };
        let reflectance: Vec<[f64; 2]> =
            structure.iter().map(|order| self.transmittance(order.tangential).map(|t| 1.0 - t)).collect();
        let total = |power: &[[f64; 2]]| power.as_flattened().iter().sum::<f64>();
        let entering = self.transmittance(tangential);
        let mut powers = DirectionPowers::default();
        let mut numbers: Vec<i32> = structure.iter().map(|order| order.number).collect();
        numbers.sort_unstable();
        powers.reflected.extend(numbers.iter().map(|&number| blank(number)));
        for polarisation in 0..2 {
            let mut on_structure = vec![[0.0; 2]; structure.len()];
            on_structure[arriving][polarisation] = entering[polarisation];
            let (mut leaving, mut meeting) = (vec![[0.0; 2]; structure.len()], vec![[0.0; 2]; structure.len()]);
            for _ in 0..MAX_REFLECTIONS {
                add(&mut meeting, &on_structure);
                let up = scattered(&on_structure);
                add(&mut leaving, &up);
                on_structure =
                    up.iter().zip(&reflectance).map(|(power, face)| [power[0] * face[0], power[1] * face[1]]).collect();
                if total(&on_structure) < NEGLIGIBLE {
                    break;
                }
            }
            for (order, leaving) in structure.iter().zip(&leaving) {
                let [cos_o, _] = self.cosines(order.tangential);
                let per_cosine = self.transmittance_over_cosine(order.tangential);
                let over_cosine = leaving[0] * per_cosine[0] + leaving[1] * per_cosine[1];
                let Some(power) = powers.reflected.iter_mut().find(|power| power.index[0] == order.number) else {
                    continue;
                };
                power.efficiency[polarisation] = over_cosine * cos_o;
                // e over 4 c_i c_o/(c_i + c_o)², with c_o = 0 beyond the horizon.
                let strength = over_cosine * (cos_i + cos_o).powi(2) / (4.0 * cos_i);
                power.strength[polarisation] = if cos_o > 0.0 { strength } else { strength.min(1.0) };
                if order.number == 0 {
                    power.efficiency[polarisation] += 1.0 - entering[polarisation];
                    power.strength[polarisation] = power.efficiency[polarisation];
                }
            }
            self.transmit(structure, &meeting, polarisation, cos_i, &mut powers);
        }
        powers
    }

    /// Adds the orders that leave below, for light in one polarisation of which `meeting` meets the structure.
    fn transmit(
        self,
        structure: &[OrderResponse],
        meeting: &[[f64; 2]],
        polarisation: usize,
        cos_i: f64,
        powers: &mut DirectionPowers,
    ) {
        for (from, meeting) in structure.iter().zip(meeting) {
            if is_opaque(from.response.half_spaces[1]) {
                return;
            }
            for order in from.response.transmitted.iter().filter(|order| order.vertical.re > 0.0) {
                let index = from.number + number(order);
                let (k_i, k_t) = (self.outside * cos_i, order.vertical.re);
                let [s, p] = from.response.transmitted_efficiency(order);
                let found = s * meeting[0] + p * meeting[1];
                let place = match powers.transmitted.iter().position(|power| power.index[0] == index) {
                    Some(place) => place,
                    None => {
                        powers.transmitted.push(blank(index));
                        powers.transmitted.len() - 1
                    }
                };
                powers.transmitted[place].efficiency[polarisation] += found;
                powers.transmitted[place].strength[polarisation] += found * (k_i + k_t).powi(2) / (4.0 * k_i * k_t);
            }
        }
    }
}

/// Number of an order of lines.
fn number(order: &Order) -> i32 {
    order.index[0]
}

/// Order without light.
fn blank(number: i32) -> OrderPower {
    OrderPower { index: [number, 0], efficiency: [0.0; 2], strength: [0.0; 2] }
}

fn add(to: &mut [[f64; 2]], from: &[[f64; 2]]) {
    to.as_flattened_mut().iter_mut().zip(from.as_flattened()).for_each(|(to, from)| *to += from);
}

#[cfg(test)]
mod tests {
    use goniochrome_waves::Complex64;
    use goniochrome_waves::lamellar::Modes;
    use goniochrome_waves::profile::Profile;

    use super::*;

    /// Flat interface from the plate to a medium, at a wavevector along x.
    fn flat(plate: f64, below: Complex64, tangential: f64) -> OrderResponse {
        let profile = Profile { period_nm: 500.0, above: plate, below, slices: Vec::new() };
        let response = Modes::new(&profile, 600.0, tangential, 1).unwrap().response(0.0).unwrap();
        OrderResponse { number: 0, tangential, response }
    }

    #[test]
    fn a_plate_over_a_flat_face_adds_all_reflections_between_its_faces() {
        let (outside, plate) = (1.0, 1.58);
        for below in [Complex64::new(1.33, 0.0), Complex64::new(1.0, 6.5)] {
            for tangential in [0.0, 0.4, 0.9] {
                let order = flat(plate, below, tangential);
                let back = order.response.reflected_efficiency(&order.response.reflected[1]);
                let face = FrontFace { outside, plate };
                let front = face.transmittance(tangential).map(|t| 1.0 - t);
                let powers = face.seen(&[order]);
                for p in 0..2 {
                    let (r, s) = (front[p], back[p]);
                    // The geometric series of a thick plate.
                    let expected = r + (1.0 - r) * (1.0 - r) * s / (1.0 - r * s);
                    let found = powers.reflected[0].efficiency[p];
                    assert!((found - expected).abs() < 1e-10, "{below} {tangential} {p}: {found} {expected}");
                }
                let transmitted: f64 = powers.transmitted.iter().map(|power| power.efficiency[0]).sum();
                let sum = powers.reflected[0].efficiency[0] + transmitted;
                assert!(below.im > 0.0 || (sum - 1.0).abs() < 1e-10, "{sum}");
            }
        }
    }

    #[test]
    fn the_face_obeys_fresnel_and_is_total_beyond_the_critical_angle() {
        let face = FrontFace { outside: 1.0, plate: 1.5 };
        // Normal incidence: 4 n/(n + 1)².
        for t in face.transmittance(0.0) {
            assert!((t - 0.96).abs() < 1e-12);
        }
        assert_eq!(face.transmittance(1.2), [0.0; 2]);
        // Brewster's angle, tan θ = n: p passes wholly.
        let brewster = 1.5_f64.atan().sin();
        assert!((face.transmittance(brewster)[1] - 1.0).abs() < 1e-12);
        assert!(face.transmittance_over_cosine(1.2).iter().all(|t| t.is_finite() && *t > 0.0));
    }
}
