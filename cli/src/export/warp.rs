//! From the unit square to itself, with a density that is bilinear between samples: rows by their marginal, then along the row.
//! The same map that renderers of RGL's tensor files build from a file's `vndf` (`Marginal2D` in Mitsuba 3).

/// A density on the unit square, ends of both axes included.
pub struct Warp<'v> {
    values: &'v [f64],
    width: usize,
    /// Integral from the row's start, in units of a sample's spacing; row by row.
    along: Vec<f64>,
    /// Integral from the first row.
    rows: Vec<f64>,
}

/// Running sums of trapezoids, from 0.
fn sums(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut before = None;
    let mut sum = 0.0;
    let step = |value: f64| {
        sum += before.replace(value).map_or(0.0, |before: f64| 0.5 * (before + value));
        sum
    };
    values.map(step).collect()
}

/// The interval of an increasing list that holds `at`.
fn interval(list: impl Fn(usize) -> f64, count: usize, at: f64) -> usize {
    (1..count - 1).take_while(|&i| list(i) < at).last().unwrap_or(0)
}

/// Where, in an interval of density a to b, the integral from its start is `part`.
fn place(a: f64, b: f64, part: f64) -> f64 {
    let root = (a * a + 2.0 * part * (b - a)).max(0.0).sqrt();
    if a + root > 0.0 { (2.0 * part / (a + root)).clamp(0.0, 1.0) } else { 0.0 }
}

impl<'v> Warp<'v> {
    /// `values[row * width + column]`, positive, at least two of each.
    pub fn new(values: &'v [f64], width: usize) -> Self {
        let along: Vec<f64> = values.chunks(width).flat_map(|row| sums(row.iter().copied())).collect();
        let rows = sums(along.chunks(width).map(|row| row[width - 1]));
        Self { values, width, along, rows }
    }

    /// The point of the square that a uniform point goes to, and the value of the density there.
    pub fn sample(&self, [x, y]: [f64; 2]) -> ([f64; 2], f64) {
        let (width, height) = (self.width, self.rows.len());
        let y = y * self.rows[height - 1];
        let row = interval(|i| self.rows[i], height, y);
        let total = |row: usize| self.along[row * width + width - 1];
        let v = place(total(row), total(row + 1), y - self.rows[row]);
        let between =
            |list: &[f64], column: usize| (1.0 - v) * list[row * width + column] + v * list[(row + 1) * width + column];
        let x = x * between(&self.along, width - 1);
        let column = interval(|i| between(&self.along, i), width, x);
        let [a, b] = [between(self.values, column), between(self.values, column + 1)];
        let u = place(a, b, x - between(&self.along, column));
        let scaled = |cell: usize, rest: f64, count: usize| (cell as f64 + rest) / (count - 1) as f64;
        ([scaled(column, u, width), scaled(row, v, height)], (1.0 - u) * a + u * b)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn areas_shrink_where_the_density_is_high() {
        let values: Vec<f64> = (0..12).map(|i| 1.0 + f64::from(i * 7 % 5)).collect();
        let warp = Warp::new(&values, 4);
        let mean = warp.rows[2] / (3.0 * 2.0);
        const STEP: f64 = 1e-6;
        for at in [[0.1, 0.2], [0.5, 0.5], [0.77, 0.31], [0.9, 0.9]] {
            let ([u, v], density) = warp.sample(at);
            let ([u_x, v_x], _) = warp.sample([at[0] + STEP, at[1]]);
            let ([u_y, v_y], _) = warp.sample([at[0], at[1] + STEP]);
            let area = ((u_x - u) * (v_y - v) - (v_x - v) * (u_y - u)) / (STEP * STEP);
            assert!((area * density / mean - 1.0).abs() < 1e-4, "{at:?}: {area} {density}");
        }
        assert_eq!(warp.sample([0.0, 0.0]).0, [0.0, 0.0]);
        let (end, _) = warp.sample([1.0, 1.0]);
        assert!(end.iter().all(|x| (x - 1.0).abs() < 1e-12));
    }
}
