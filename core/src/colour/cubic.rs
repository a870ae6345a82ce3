//! Piecewise cubic interpolation between the samples of a spectrum.

/// Minimum distance of a neighbour from the interval, in widths of the interval. A nearer one is passed over for one
/// farther away: a cubic through samples much closer together than the interval is wide would magnify their differences
/// across it.
const MIN_NEIGHBOUR_DISTANCE: f64 = 0.25;

/// Cubic interpolant of a spectrum between two adjacent samples.
///
/// It is the Lagrange polynomial through both samples and one neighbour on each side, or two neighbours on one side at
/// an end of the samples. If fewer than four samples are far enough apart, the degree is lower; a single sample gives a
/// constant.
#[derive(Clone, Copy, Debug)]
pub struct SpectrumCubic {
    index: [usize; 4],
    node: [f64; 4],
    /// 1 / Π (x_i − x_j) over the other nodes; 0 for a node that is not used.
    scale: [f64; 4],
    order: usize,
}

impl SpectrumCubic {
    /// Interpolant between samples `interval` and `interval + 1`; `None` if there is no such interval.
    ///
    /// `samples` increases strictly.
    #[must_use]
    pub fn new(samples: &[f64], interval: usize) -> Option<Self> {
        let (&a, &b) = (samples.get(interval)?, samples.get(interval + 1)?);
        let reach = MIN_NEIGHBOUR_DISTANCE * (b - a);
        let left = |of: f64| samples.partition_point(|&x| x <= of - reach).checked_sub(1);
        let right = |of: f64| Some(samples.partition_point(|&x| x < of + reach)).filter(|&i| i < samples.len());
        let beyond = |place: Option<usize>, next: &dyn Fn(f64) -> Option<usize>| {
            place.and_then(|i| samples.get(i)).and_then(|&x| next(x))
        };
        let (below, above) = (left(a), right(b));
        let others = match (below, above) {
            (Some(_), Some(_)) => [below, above],
            (None, _) => [above, beyond(above, &right)],
            (_, None) => [below, beyond(below, &left)],
        };
        let mut cubic = Self { index: [interval; 4], node: [a; 4], scale: [0.0; 4], order: 0 };
        for index in [Some(interval), Some(interval + 1)].into_iter().chain(others).flatten() {
            cubic.push(index, *samples.get(index)?);
        }
        Some(cubic.scaled())
    }

    /// Constant interpolant: for a single sample, and beyond the first and the last of several.
    #[must_use]
    pub fn constant(index: usize) -> Self {
        Self { index: [index; 4], node: [0.0; 4], scale: [1.0, 0.0, 0.0, 0.0], order: 1 }
    }

    fn push(&mut self, index: usize, node: f64) {
        if let (Some(at), Some(x)) = (self.index.get_mut(self.order), self.node.get_mut(self.order)) {
            (*at, *x) = (index, node);
            self.order += 1;
        }
    }

    fn scaled(mut self) -> Self {
        let nodes = self.node;
        for (i, (scale, &node)) in self.scale.iter_mut().zip(&nodes).enumerate().take(self.order) {
            let others = nodes.iter().take(self.order).enumerate().filter(|(j, _)| *j != i);
            *scale = 1.0 / others.map(|(_, &other)| node - other).product::<f64>();
        }
        self
    }

    /// Indices of the samples that the interpolant goes through. Unused places, whose share is 0, repeat one of them.
    #[must_use]
    pub fn index(&self) -> [usize; 4] {
        self.index
    }

    /// Share of each sample of [`SpectrumCubic::index`] in the value at `x`. The shares add up to 1.
    #[must_use]
    #[inline]
    pub fn shares(&self, x: f64) -> [f64; 4] {
        let mut from_node = [1.0; 4];
        for (d, &node) in from_node.iter_mut().zip(&self.node).take(self.order) {
            *d = x - node;
        }
        let [d0, d1, d2, d3] = from_node;
        let [s0, s1, s2, s3] = self.scale;
        let (low, high) = (d0 * d1, d2 * d3);
        [s0 * (d1 * high), s1 * (d0 * high), s2 * (low * d3), s3 * (low * d2)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn value(samples: &[f64], interval: usize, x: f64, f: impl Fn(f64) -> f64) -> f64 {
        let cubic = SpectrumCubic::new(samples, interval).unwrap();
        cubic.shares(x).iter().zip(cubic.index()).map(|(share, i)| share * f(samples[i])).sum()
    }

    #[test]
    fn cubics_are_exact_for_cubics() {
        let samples = [400.0, 411.0, 450.0, 460.0, 500.0, 570.0];
        let f = |x: f64| 1.0 + x * (2e-3 - x * (1e-5 - 3e-8 * x));
        for (interval, x) in [(0, 400.0), (0, 405.0), (2, 455.0), (4, 530.0), (4, 570.0)] {
            let got = value(&samples, interval, x, f);
            assert!((got - f(x)).abs() < 1e-12, "{x}: {got}");
        }
    }

    #[test]
    fn crowded_neighbours_are_not_magnified() {
        // One of four samples 10⁻³ nm apart stands out by 1. The wide intervals beside them must not continue its slope
        // of 1000 per nm.
        let samples = [400.0, 410.0, 420.0, 420.001, 420.002, 420.003, 430.0, 440.0];
        let f = |x: f64| if (x - 420.001).abs() < 1e-9 { 1.0 } else { 0.0 };
        for (interval, x) in [(0, 405.0), (1, 415.0), (5, 425.0), (6, 435.0)] {
            let got = value(&samples, interval, x, f);
            assert!(got.abs() < 1e-12, "{x}: {got}");
        }
    }

    #[test]
    fn few_samples_lower_the_degree() {
        assert!((value(&[400.0, 500.0], 0, 425.0, |x| x) - 425.0).abs() < 1e-12);
        assert!((value(&[400.0, 450.0, 500.0], 1, 490.0, |x| x * x) - 490.0 * 490.0).abs() < 1e-9);
        assert!(SpectrumCubic::new(&[400.0], 0).is_none() && SpectrumCubic::new(&[], 0).is_none());
        assert_eq!(SpectrumCubic::constant(7).shares(500.0), [1.0, 0.0, 0.0, 0.0]);
    }

    #[test]
    fn shares_add_to_one_on_any_samples() {
        let mut samples = [0.0; 40];
        let (mut seed, mut at) = (1_u64, 380.0);
        for sample in &mut samples {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            at += libm::exp2(-14.0 * (seed >> 40) as f64 / 16_777_216.0);
            *sample = at;
        }
        for interval in 0..samples.len() - 1 {
            let cubic = SpectrumCubic::new(&samples, interval).unwrap();
            for t in [0.0, 0.25, 0.5, 1.0] {
                let shares = cubic.shares(samples[interval] + t * (samples[interval + 1] - samples[interval]));
                let size: f64 = shares.iter().map(|share| share.abs()).sum();
                assert!((shares.iter().sum::<f64>() - 1.0).abs() < 1e-9 && size < 4.0, "{interval} {shares:?}");
            }
        }
    }
}
