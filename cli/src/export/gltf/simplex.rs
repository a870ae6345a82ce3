//! The downhill simplex method of Nelder and Mead (1965) in the unit cube.
//!
//! Only the fit of six numbers needs it; the crates that offer it bring more dependencies than this file has lines.

/// Minimises a function on [0, 1]ⁿ from a start and a first step in each coordinate; returns the smallest value and its
/// place.
///
/// Points outside are moved to the cube's surface. The search ends when the simplex is smaller than `width`, or after
/// `iterations` steps.
pub fn minimise<const N: usize>(
    f: impl Fn(&[f64; N]) -> f64,
    start: [f64; N],
    step: f64,
    width: f64,
    iterations: usize,
) -> (f64, [f64; N]) {
    let value = |point: [f64; N]| {
        let point = point.map(|x| x.clamp(0.0, 1.0));
        (f(&point), point)
    };
    let mut simplex = vec![value(start)];
    for i in 0..N {
        let mut point = start;
        // The step leads inwards where the start lies on the surface.
        point[i] += if start[i] + step > 1.0 { -step } else { step };
        simplex.push(value(point));
    }
    for _ in 0..iterations {
        simplex.sort_by(|a, b| a.0.total_cmp(&b.0));
        let (best, worst) = (simplex[0], simplex[N]);
        let distances = simplex.iter().flat_map(|(_, point)| point.iter().zip(&best.1).map(|(a, b)| (a - b).abs()));
        if distances.fold(0.0, f64::max) < width {
            break;
        }
        let centre: [f64; N] =
            std::array::from_fn(|i| simplex[..N].iter().map(|corner| corner.1[i]).sum::<f64>() / N as f64);
        let along = |t: f64| value(std::array::from_fn(|i| centre[i] + t * (centre[i] - worst.1[i])));
        let reflected = along(1.0);
        let next = if reflected.0 < best.0 {
            let expanded = along(2.0);
            if expanded.0 < reflected.0 { expanded } else { reflected }
        } else if reflected.0 < simplex[N - 1].0 {
            reflected
        } else {
            along(if reflected.0 < worst.0 { 0.5 } else { -0.5 })
        };
        if next.0 < worst.0 {
            simplex[N] = next;
        } else {
            for corner in &mut simplex[1..] {
                *corner = value(std::array::from_fn(|i| 0.5 * (corner.1[i] + best.1[i])));
            }
        }
    }
    simplex.into_iter().min_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or((f64::NAN, start))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_curved_valley_is_followed_to_its_floor() {
        // Rosenbrock's, scaled into the cube; the floor is at (0.75, 0.75).
        let valley = |&[x, y]: &[f64; 2]| {
            let (x, y) = (4.0 * x - 2.0, 4.0 * y - 2.0);
            (1.0 - x).powi(2) + 100.0 * (y - x * x).powi(2)
        };
        let (min, place) = minimise(valley, [0.1, 0.9], 0.1, 1e-9, 2000);
        assert!(min < 1e-12 && place.iter().all(|x| (x - 0.75).abs() < 1e-6), "{min} {place:?}");
    }

    #[test]
    fn a_minimum_outside_is_met_on_the_surface() {
        let slope = |p: &[f64; 3]| (p[0] - 2.0).powi(2) + (p[1] + 1.0).powi(2) + (p[2] - 0.5).powi(2);
        let (_, place) = minimise(slope, [1.0, 0.5, 0.9], 0.1, 1e-9, 2000);
        for (got, want) in place.into_iter().zip([1.0, 0.0, 0.5]) {
            assert!((got - want).abs() < 1e-6, "{place:?}");
        }
    }
}
