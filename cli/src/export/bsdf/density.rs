//! Piecewise linear densities on [0, 1], and the places at which their integral is equally spaced.
//!
//! A density is one axis of the warp that renderers build from the `vndf` of RGL's tensor files (`Marginal2D` in
//! Mitsuba 3).

/// A density on [0, 1] by equally spaced samples, ends included; all are positive, and not normalised.
#[derive(Clone, Debug)]
pub struct Density(pub Vec<f64>);

/// The place in an interval of density a to b at which the integral from its start is `part`.
fn place(a: f64, b: f64, part: f64) -> f64 {
    let root = (a * a + 2.0 * part * (b - a)).max(0.0).sqrt();
    (2.0 * part / (a + root)).clamp(0.0, 1.0)
}

impl Density {
    /// The uniform density.
    #[must_use]
    pub fn uniform() -> Self {
        Self(vec![1.0; 2])
    }

    /// The `count` places, both ends among them, that have equal shares of the density between them, each with the
    /// density there over its mean.
    #[must_use]
    pub fn nodes(&self, count: usize) -> Vec<(f64, f64)> {
        let last = self.0.len() - 1;
        let part = |i: usize| 0.5 * (self.0[i] + self.0[i + 1]);
        let total: f64 = (0..last).map(part).sum();
        let (mut interval, mut before) = (0, 0.0);
        let node = |i: usize| {
            let target = total * i as f64 / (count - 1) as f64;
            while interval + 1 < last && before + part(interval) < target {
                before += part(interval);
                interval += 1;
            }
            let [a, b] = [self.0[interval], self.0[interval + 1]];
            let rest = place(a, b, target - before);
            ((interval as f64 + rest) / last as f64, (a + rest * (b - a)) * last as f64 / total)
        };
        (0..count).map(node).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nodes_lie_close_where_the_density_is_high() {
        let density = Density(vec![1.0, 3.0, 0.5, 2.0]);
        const COUNT: usize = 2001;
        let nodes = density.nodes(COUNT);
        assert_eq!(nodes[0].0, 0.0);
        assert!((nodes[COUNT - 1].0 - 1.0).abs() < 1e-12);
        for pair in nodes.windows(2) {
            let [(from, a), (to, b)] = [pair[0], pair[1]];
            // The trapezoidal rule, exact but for the interval that holds a kink of the density.
            let share = 0.5 * (a + b) * (to - from) * (COUNT - 1) as f64;
            assert!((share - 1.0).abs() < 2e-3, "{from} to {to}: {share}");
        }
        let uniform = Density::uniform().nodes(5);
        assert_eq!(uniform, [(0.0, 1.0), (0.25, 1.0), (0.5, 1.0), (0.75, 1.0), (1.0, 1.0)]);
    }
}
