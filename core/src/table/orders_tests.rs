//! Tests of the look-up and the sampling of diffraction orders.

extern crate std;

use super::*;
use crate::table::Periodicity;
use crate::trace::random::Random;
use std::vec;
use std::vec::Vec;

const NM: [f32; 3] = [450.0, 550.0, 680.0];
const INDEX: [f32; 3] = [1.34, 1.33, 1.32];
const WEIGHTS: [[f32; 3]; 3] = [[0.1, 0.2, 0.7], [0.3, 0.6, 0.1], [0.6, 0.2, 0.2]];
const PERIOD: [f32; 2] = [1600.0, 740.0];

/// Rounding of a direction's component in single precision, from four operations on numbers up to 4.
const ROUNDING: f32 = 8.0 * f32::EPSILON;

/// Orders from −3 to 3 along each axis of the period, and strengths that differ everywhere.
struct Arrays {
    layout: OrderLayout,
    orders: Vec<[f32; 2]>,
    strength: Vec<f32>,
}

impl Arrays {
    fn new(periodicity: Periodicity) -> Self {
        let layout = OrderLayout::new([7, 5], periodicity, PERIOD).unwrap();
        let along = |repeats: bool| if repeats { -3..=3 } else { 0..=0 };
        let (x, y) = (along(periodicity != Periodicity::Y), along(periodicity != Periodicity::X));
        let orders: Vec<_> = x.flat_map(|m| y.clone().map(move |n| [m, n].map(|m: i8| f32::from(m)))).collect();
        let count = NM.len() * layout.count() * orders.len();
        let strength = (0..count).map(|i| (i * 7919 % 1009) as f32 / 1009.0).collect();
        Self { layout, orders, strength }
    }

    fn table(&self) -> OrderTable<'_> {
        let Self { layout, orders, strength } = self;
        let arrays = OrderArrays { orders, wavelength_nm: &NM, index: &INDEX, rgb_weights: &WEIGHTS, strength };
        OrderTable::new(*layout, &arrays).unwrap()
    }
}

const ALL: [Periodicity; 3] = [Periodicity::X, Periodicity::Y, Periodicity::Both];

/// Directions over the whole hemisphere, the normal and grazing ones among them.
fn directions() -> impl Iterator<Item = Vec3> {
    (0..60).map(|i| {
        let (cos, phi) = (1.0 - 0.0166 * i as f32, 2.4 * i as f32);
        let sin = (1.0 - cos * cos).sqrt();
        Vec3::new(sin * phi.cos(), sin * phi.sin(), cos)
    })
}

/// Each order of each wavelength from each direction: table, view, wavelength, order.
fn each(mut visit: impl FnMut(&OrderTable<'_>, &OrderView<'_>, Vec3, usize, usize)) {
    for arrays in ALL.map(Arrays::new) {
        let table = arrays.table();
        for wo in directions() {
            let view = table.view(wo).unwrap();
            for wavelength in 0..table.wavelength_count() {
                (0..table.order_count()).for_each(|order| visit(&table, &view, wo, wavelength, order));
            }
        }
    }
}

#[test]
fn directions_obey_the_grating_equation_and_evanescent_orders_are_never_returned() {
    let (mut travelling, mut evanescent) = (0, 0);
    each(|table, view, wo, wavelength, order| {
        let nm = f64::from(NM[wavelength]) / f64::from(INDEX[wavelength]);
        let numbers = table.order(order).map(f64::from);
        let [x, y] = [0, 1].map(|axis| numbers[axis] * nm / f64::from(PERIOD[axis]) - f64::from(wo[axis]));
        let up_squared = 1.0 - x * x - y * y;
        match view.light(wavelength, order) {
            Some(DiffractedLight { direction, efficiency }) => {
                travelling += 1;
                // A squared cosine below the rounding of squares may have either sign.
                assert!(up_squared > -f64::from(ROUNDING), "{numbers:?} {wo}");
                assert!((f64::from(direction.x) - x).abs().max((f64::from(direction.y) - y).abs()) < ROUNDING.into());
                assert!((direction.length() - 1.0).abs() < ROUNDING && direction.z > 0.0, "{direction}");
                assert!(efficiency >= 0.0 && efficiency.is_finite());
            }
            None => {
                evanescent += 1;
                assert!(up_squared < f64::from(ROUNDING), "{numbers:?} {wo}");
            }
        }
    });
    assert!(travelling > 1000 && evanescent > 1000, "{travelling} {evanescent}");
}

#[test]
fn light_returns_by_the_order_by_which_it_came() {
    each(|table, view, wo, wavelength, order| {
        let Some(light) = view.light(wavelength, order) else { return };
        // cos θ of a nearly grazing direction loses digits: dz = −(x dx + y dy)/z.
        let slack = ROUNDING * (1.0 + 1.0 / wo.z);
        let back = table.view(light.direction).unwrap().light(wavelength, order);
        let back = back.unwrap_or_else(|| panic!("{wo} is seen from {light:?}"));
        assert!((back.direction - wo).abs().max_element() < slack, "{} for {wo}", back.direction);
    });
}

#[test]
fn efficiencies_are_strengths_times_the_factor_of_both_directions() {
    for arrays in ALL.map(Arrays::new) {
        let table = arrays.table();
        for node in 0..table.layout().count() {
            let wo = table.layout().direction(node).as_vec3();
            // The last nodes of both angles are 0.02 degrees above the horizon, where one rounding moves the cosine.
            let view = table.view(wo).unwrap();
            for wavelength in 0..3 {
                for order in 0..table.order_count() {
                    let Some(light) = view.light(wavelength, order) else { continue };
                    let strength =
                        arrays.strength[(wavelength * table.layout().count() + node) * table.order_count() + order];
                    let mirror = table.order(order) == [0, 0];
                    let (i, o) = (wo.z, light.direction.z);
                    let expected = strength * 4.0 * i * o / (i + o).powi(2);
                    // Weights of the node, which sum to 1, are right within the rounding of angles: 1e-4 at most
                    // (see `nodes_interpolate_to_themselves`).
                    assert!((light.efficiency - expected).abs() < 1e-4, "{light:?} for {expected}");
                    assert_eq!(mirror, (light.direction - Vec3::new(-wo.x, -wo.y, wo.z)).length() < 1e-3);
                }
            }
        }
    }
}

#[test]
fn a_flat_surface_is_a_mirror() {
    let layout = OrderLayout::new([31, 16], Periodicity::X, PERIOD).unwrap();
    let reflectance = |cos: f32| 0.04 + 0.96 * (1.0 - cos).powi(5);
    let strength: Vec<f32> = (0..layout.count()).map(|node| reflectance(layout.direction(node).z as f32)).collect();
    let arrays = OrderArrays {
        orders: &[[0.0; 2]],
        wavelength_nm: &[550.0],
        index: &[1.0],
        rgb_weights: &[[1.0; 3]],
        strength: &strength,
    };
    let table = OrderTable::new(layout, &arrays).unwrap();
    for wo in directions().filter(|wo| wo.z > 0.1) {
        let view = table.view(wo).unwrap();
        let light = view.light(0, 0).unwrap();
        assert!((light.direction - Vec3::new(-wo.x, -wo.y, wo.z)).length() < ROUNDING * (1.0 + 1.0 / wo.z));
        // Linear interpolation over steps h of 5.93° in two angles: h²/8 = 0.00134 times the second derivative,
        // 0.96 (20 (1 − cos θ)³ sin²θ + 5 (1 − cos θ)⁴ cos θ), at most 3.8 for cos θ > 0.4, a step beyond 0.5.
        assert!(wo.z < 0.5 || (light.efficiency - reflectance(wo.z)).abs() < 2.0 * 0.00134 * 3.8, "{light:?} at {wo}");
        assert_eq!(view.albedo(0), light.efficiency);
        assert_eq!(view.probability(0, 0), 1.0);
        assert_eq!(view.sample(0, 0.7).map(|sample| (sample.order, sample.probability)), Some((0, 1.0)));
    }
}

#[test]
fn lines_are_mirror_symmetric() {
    for (periodicity, flip) in
        [(Periodicity::X, Vec3::new(1.0, -1.0, 1.0)), (Periodicity::Y, Vec3::new(-1.0, 1.0, 1.0))]
    {
        let arrays = Arrays::new(periodicity);
        let table = arrays.table();
        for wo in directions() {
            let (view, mirrored) = (table.view(wo).unwrap(), table.view(flip * wo).unwrap());
            for order in 0..table.order_count() {
                let light = view.light(1, order);
                let image = light.map(|light| DiffractedLight { direction: flip * light.direction, ..light });
                assert_eq!(mirrored.light(1, order), image);
            }
        }
    }
}

#[test]
fn between_wavelengths_directions_are_exact_and_strengths_linear() {
    each(|table, view, wo, wavelength, order| {
        assert_eq!(view.light_between(wavelength, 0.0, order), view.light(wavelength, order));
        let last = wavelength + 1 == NM.len();
        let next = if last { wavelength } else { wavelength + 1 };
        let (t, mix) = (0.375f32, |at: [f32; 3]| at[wavelength] + 0.375 * (at[next] - at[wavelength]));
        let Some(light) = view.light_between(wavelength, t, order) else { return };
        let [m, n] = table.order(order).map(|m| m as f32);
        let nm = mix(NM) / mix(INDEX);
        assert!((light.direction.x - (m * nm / PERIOD[0] - wo.x)).abs() < ROUNDING);
        assert!((light.direction.y - (n * nm / PERIOD[1] - wo.y)).abs() < ROUNDING);
        let [Some(a), Some(b)] = [wavelength, next].map(|wavelength| view.light(wavelength, order)) else { return };
        let strength = |light: DiffractedLight| light.efficiency / match_factor(light.direction.z, wo.z);
        let expected = strength(a) + t * (strength(b) - strength(a));
        assert!((strength(light) - expected).abs() < 16.0 * f32::EPSILON, "{light:?} between {a:?} and {b:?}");
    });
    let arrays = Arrays::new(Periodicity::X);
    let table = arrays.table();
    let view = table.view(Vec3::Z).unwrap();
    let end = view.light_between(0, 1.0, 4).unwrap();
    let next = view.light(1, 4).unwrap();
    assert!(
        (end.direction - next.direction).length() < ROUNDING && (end.efficiency - next.efficiency).abs() < ROUNDING
    );
    assert_eq!(view.light_between(0, 7.0, 4), Some(end));
}

#[test]
fn probabilities_sum_to_one_and_draws_follow_them() {
    const DRAWS: usize = 1 << 16;
    let arrays = Arrays::new(Periodicity::Both);
    let table = arrays.table();
    let mut random = Random::new(0, 7);
    for wo in [Vec3::Z, Vec3::new(0.48, 0.6, 0.64), Vec3::new(-0.8, 0.1, 0.35f32.sqrt())] {
        let view = table.view(wo).unwrap();
        for wavelength in 0..NM.len() {
            let probability: Vec<f32> =
                (0..table.order_count()).map(|order| view.probability(wavelength, order)).collect();
            let sum: f32 = probability.iter().sum();
            assert!((sum - 1.0).abs() < table.order_count() as f32 * f32::EPSILON, "{sum}");
            let mut drawn = vec![0u32; table.order_count()];
            for _ in 0..DRAWS {
                let sample = view.sample(wavelength, random.next() as f32).unwrap();
                let light = view.light(wavelength, sample.order).unwrap();
                assert_eq!((sample.direction, sample.efficiency), (light.direction, light.efficiency));
                assert_eq!(sample.probability, probability[sample.order]);
                drawn[sample.order] += 1;
            }
            let expected = |order: usize| f64::from(probability[order]) * DRAWS as f64;
            assert!((0..drawn.len()).all(|order| drawn[order] == 0 || expected(order) > 0.0));
            // Pearson's statistic needs some expected draws in each class; rare orders count as one.
            let (common, rare): (Vec<_>, Vec<_>) =
                (0..drawn.len()).filter(|order| expected(*order) > 0.0).partition(|order| expected(*order) > 16.0);
            let mut classes: Vec<_> = common.iter().map(|order| (expected(*order), f64::from(drawn[*order]))).collect();
            classes.push(
                rare.iter().fold((0.0, 0.0), |(e, d), order| (e + expected(*order), d + f64::from(drawn[*order]))),
            );
            let classes: Vec<_> = classes.into_iter().filter(|(expected, _)| *expected > 0.0).collect();
            let chi2: f64 = classes.iter().map(|(expected, drawn)| (drawn - expected).powi(2) / expected).sum();
            let freedom: f64 = classes.len() as f64 - 1.0;
            // Five standard deviations of χ², √(2 · degrees of freedom), above its mean.
            assert!(chi2 < freedom + 5.0 * (2.0 * freedom).sqrt(), "χ² = {chi2} for {freedom} degrees of freedom");
            assert!(freedom >= 2.0);
        }
    }
}

#[test]
fn no_input_gives_anything_but_none_or_finite_light() {
    let arrays = Arrays::new(Periodicity::Both);
    let table = arrays.table();
    for wo in [Vec3::NEG_Z, Vec3::X, Vec3::NAN, Vec3::new(0.0, 0.0, f32::NAN), Vec3::ZERO] {
        assert_eq!(table.view(wo), None);
    }
    for wo in [Vec3::new(f32::NAN, 0.0, 1.0), Vec3::new(f32::INFINITY, 0.0, 1.0), Vec3::new(3.0, 3.0, 1.0)] {
        let view = table.view(wo).unwrap();
        assert!((0..49).all(|order| view.light(0, order).is_none() && view.probability(0, order) == 0.0));
        assert_eq!((view.albedo(0), view.sample(0, 0.5)), (0.0, None));
    }
    let view = table.view(Vec3::new(0.28, 0.0, 0.96)).unwrap();
    for (wavelength, order) in [(3, 0), (0, 49), (usize::MAX, 0), (0, usize::MAX)] {
        assert_eq!(view.light(wavelength, order), None);
        assert_eq!(view.light_between(wavelength, 0.5, order), None);
        assert_eq!(view.probability(wavelength, order), 0.0);
    }
    assert_eq!((view.albedo(3), view.sample(3, 0.5)), (0.0, None));
    assert_eq!(view.light_between(0, f32::NAN, 24), view.light(0, 24));
    assert_eq!(view.light_between(0, -1.0, 24), view.light(0, 24));
    assert_eq!((table.order(49), table.wavelength_nm(3), table.rgb_weight(3)), ([0; 2], 0.0, [0.0; 3]));
    assert_eq!((table.order(48), table.wavelength_nm(2), table.rgb_weight(2)), ([3; 2], 680.0, WEIGHTS[2]));
    for u in [0.0, 1.0f32.next_down(), 1.0, 2.0, -1.0, f32::NAN] {
        assert!(view.sample(0, u).unwrap().probability > 0.0);
    }
}

#[test]
fn extreme_strengths_stay_finite() {
    let mut arrays = Arrays::new(Periodicity::X);
    for (value, draws) in [(0.0, false), (f32::from_bits(1), true), (MAX_MAGNITUDE, true)] {
        arrays.strength.fill(value);
        let table = arrays.table();
        for wo in directions() {
            let view = table.view(wo).unwrap();
            assert!(view.albedo(0).is_finite());
            match view.sample(0, 0.9) {
                Some(sample) => {
                    assert!(sample.probability > 0.0 && (sample.efficiency / sample.probability).is_finite());
                }
                None => assert!(!draws || view.albedo(0) == 0.0),
            }
        }
    }
    // One strong order among weak ones, whose probability is too small for single precision.
    arrays.strength.iter_mut().enumerate().for_each(|(i, s)| *s = if i % 7 == 3 { MAX_MAGNITUDE } else { 1e-20 });
    assert_eq!(arrays.table().view(Vec3::Z).unwrap().sample(0, 0.0).map(|sample| sample.order), Some(3));
}

#[test]
fn impossible_tables_are_refused() {
    let refusal = |change: fn(&mut OrderArrays<'_>)| {
        let own = Arrays::new(Periodicity::X);
        let Arrays { layout, orders, strength } = &own;
        let mut arrays = OrderArrays { orders, wavelength_nm: &NM, index: &INDEX, rgb_weights: &WEIGHTS, strength };
        change(&mut arrays);
        OrderTable::new(*layout, &arrays).unwrap_err()
    };
    assert_eq!(refusal(|a| a.orders = &[]), TableError::Shape);
    assert_eq!(refusal(|a| a.wavelength_nm = &[]), TableError::Shape);
    assert_eq!(refusal(|a| a.orders = &[[0.0; 2]]), TableError::Length { required: 3 * 35 });
    assert_eq!(refusal(|a| a.index = &INDEX[..2]), TableError::Length { required: 3 * 35 * 7 });
    assert_eq!(refusal(|a| a.rgb_weights = &WEIGHTS[..2]), TableError::Length { required: 3 * 35 * 7 });
    assert_eq!(refusal(|a| a.strength = &[0.5]), TableError::Length { required: 3 * 35 * 7 });
    const SEVEN: [[f32; 2]; 7] = [[0.0; 2]; 7];
    const fn with(numbers: [f32; 2]) -> [[f32; 2]; 7] {
        let mut orders = SEVEN;
        orders[2] = numbers;
        orders
    }
    const FRACTION: [[f32; 2]; 7] = with([0.5, 0.0]);
    const ACROSS: [[f32; 2]; 7] = with([1.0, 1.0]);
    const FAR: [[f32; 2]; 7] = with([2e6, 0.0]);
    const NAN: [[f32; 2]; 7] = with([f32::NAN, 0.0]);
    for change in [
        (|a| a.orders = &FRACTION) as fn(&mut OrderArrays<'_>),
        |a| a.orders = &ACROSS,
        |a| a.orders = &FAR,
        |a| a.orders = &NAN,
        |a| a.wavelength_nm = &[450.0, 450.0, 680.0],
        |a| a.wavelength_nm = &[0.0, 450.0, 680.0],
        |a| a.wavelength_nm = &[450.0, f32::NAN, 680.0],
        |a| a.wavelength_nm = &[450.0, 550.0, f32::INFINITY],
        |a| a.index = &[1.0, 0.0, 1.0],
        |a| a.index = &[1.0, f32::NAN, 1.0],
        |a| a.rgb_weights = &[[0.0; 3], [0.0; 3], [0.0, 0.0, f32::NAN]],
    ] {
        assert_eq!(refusal(change), TableError::Orders);
    }
    for strength in [f32::NAN, -0.1, f32::INFINITY, 2.0 * MAX_MAGNITUDE] {
        let mut own = Arrays::new(Periodicity::X);
        own.strength[11] = strength;
        let Arrays { layout, orders, strength } = &own;
        let arrays = OrderArrays { orders, wavelength_nm: &NM, index: &INDEX, rgb_weights: &WEIGHTS, strength };
        assert_eq!(OrderTable::new(*layout, &arrays), Err(TableError::Strength { index: 11 }));
    }
}
