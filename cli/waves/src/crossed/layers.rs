//! Recursion through the layers: reflection from the half-space below up, then the fields of the light from the top
//! down.

use num_complex::Complex64;

use crate::crossed::modes::{Modes, PlaneWaves};
use crate::error::WaveError;
use crate::linear::{Factors, Matrix, solve};

/// Waves of a layer.
#[derive(Clone, Copy, Debug)]
pub(super) enum Layer<'a> {
    /// Layer with a pattern.
    Pattern(&'a Modes),
    /// Layer of one medium.
    Medium(&'a PlaneWaves),
}

impl Layer<'_> {
    /// Factors of the waves from one end of the layer to the other, `thickness` in units of 1/k₀.
    fn passage(&self, thickness: f64) -> Vec<Complex64> {
        let vertical = match self {
            Self::Pattern(modes) => &modes.vertical,
            Self::Medium(waves) => &waves.vertical,
        };
        vertical.iter().map(|k_z| (Complex64::I * k_z * thickness).exp()).collect()
    }

    /// Electric fields of waves of the amplitudes `sum` and magnetic fields of those of `difference`.
    fn fields(&self, sum: &Matrix, difference: &Matrix) -> [Matrix; 2] {
        match self {
            Self::Pattern(modes) => [&modes.electric * sum, &modes.magnetic * difference],
            Self::Medium(waves) => [scaled(&waves.electric, sum), scaled(&waves.magnetic, difference)],
        }
    }

    /// Sum and difference of `u` times the magnetic and `t` times the electric fields of the waves that go down.
    fn mixed(&self, u: &[Complex64], t: &[Complex64]) -> [Matrix; 2] {
        let n = u.len();
        match self {
            Self::Pattern(Modes { electric: e, magnetic: h, .. }) => [
                Matrix::from_fn(n, n, |i, j| u[i] * h[(i, j)] + t[i] * e[(i, j)]),
                Matrix::from_fn(n, n, |i, j| u[i] * h[(i, j)] - t[i] * e[(i, j)]),
            ],
            Self::Medium(PlaneWaves { electric: e, magnetic: h, .. }) => {
                let diagonal = |i: usize, j: usize, value: Complex64| if i == j { value } else { Complex64::ZERO };
                [
                    Matrix::from_fn(n, n, |i, j| diagonal(i, j, u[i] * h[i] + t[i] * e[i])),
                    Matrix::from_fn(n, n, |i, j| diagonal(i, j, u[i] * h[i] - t[i] * e[i])),
                ]
            }
        }
    }

    /// Inverse of [`Layer::fields`].
    fn amplitudes(&self, electric: &Matrix, magnetic: &Matrix) -> Result<[Matrix; 2], WaveError> {
        match self {
            Self::Pattern(modes) => Ok([solve(&modes.electric, electric)?, solve(&modes.magnetic, magnetic)?]),
            Self::Medium(waves) => {
                let inverse = |all: &[Complex64]| all.iter().map(Complex64::inv).collect::<Vec<_>>();
                Ok([scaled(&inverse(&waves.electric), electric), scaled(&inverse(&waves.magnetic), magnetic)])
            }
        }
    }
}

/// Waves that go down below a plane, from those above it.
#[derive(Debug)]
enum Transfer<'a> {
    /// Each part of each order by itself.
    Diagonal(Vec<Complex64>),
    /// Below a pattern, above uniform media in which a wave of amplitude 1 has the fields `electric` and `magnetic`.
    Pattern { modes: &'a Modes, reflection: Matrix, electric: Vec<Complex64>, magnetic: Vec<Complex64> },
    /// Twice the inverse.
    Inverse(Factors),
}

impl Transfer<'_> {
    fn apply(&self, down: &Matrix) -> Result<Matrix, WaveError> {
        match self {
            Self::Diagonal(factors) => Ok(scaled(factors, down)),
            Self::Pattern { modes, reflection, electric, magnetic } => {
                let up = reflection * down;
                let [e, h] = Layer::Pattern(modes).fields(&(down + &up), &(down - &up));
                // Least squares of the two equations, since either factor can be 0.
                Ok(Matrix::from_fn(e.nrows(), e.ncols(), |i, j| {
                    let (u, t) = (electric[i], magnetic[i]);
                    (u.conj() * e[(i, j)] + t.conj() * h[(i, j)]) / (u.norm_sqr() + t.norm_sqr())
                }))
            }
            Self::Inverse(factors) => Ok(factors.solve(down)? * faer::Scale(Complex64::from(2.0))),
        }
    }
}

/// Uppermost layer, with the amplitudes at its top of the waves that go up from those that go down.
#[derive(Debug)]
enum Top<'a> {
    /// Uniform, over nothing but uniform media: each part of each order reflects by itself.
    Media { waves: &'a PlaneWaves, reflection: Vec<Complex64> },
    /// Any layer, with at least one pattern in it or below.
    Patterned { layer: Layer<'a>, reflection: Matrix },
}

/// Layers between a plane and the half-space below it.
#[derive(Debug)]
pub(super) struct Stack<'a> {
    top: Top<'a>,
    /// Passage through each layer from the bottom, and what then goes on below it.
    steps: Vec<(Vec<Complex64>, Transfer<'a>)>,
}

impl<'a> Stack<'a> {
    /// Half-space alone.
    pub(super) fn new(below: &'a PlaneWaves) -> Self {
        let reflection = vec![Complex64::ZERO; below.vertical.len()];
        Self { top: Top::Media { waves: below, reflection }, steps: Vec::new() }
    }

    /// Puts a layer on top, `thickness` in units of 1/k₀.
    ///
    /// At the plane below it, let u and t be the electric and magnetic fields per wave that goes down below the plane.
    /// With P = W⁻¹u and Q = V⁻¹t of the layer's fields W and V, its reflection is (P − Q)(P + Q)⁻¹, and 2(P + Q)⁻¹ is
    /// what goes on. Where u and t are diagonal, (uV + tW)⁻¹(uV − tW) is the same with one inverse.
    ///
    /// # Errors
    /// [`WaveError::Singular`] if a reflection is not finite.
    pub(super) fn add(&mut self, layer: Layer<'a>, thickness: f64) -> Result<(), WaveError> {
        let passage = layer.passage(thickness);
        let (top, transfer) = match (&self.top, layer) {
            (Top::Media { waves: below, reflection }, Layer::Medium(waves)) => {
                let [u, t] = below.fields(reflection);
                let p = u.iter().zip(&waves.electric).map(|(u, e)| u / e);
                let q = t.iter().zip(&waves.magnetic).map(|(t, h)| t / h);
                let (r, factors): (Vec<_>, _) = p.zip(q).map(|(p, q)| ((p - q) / (p + q), 2.0 / (p + q))).unzip();
                let reflection = r.iter().zip(&passage).map(|(r, x)| x * r * x).collect();
                (Top::Media { waves, reflection }, Transfer::Diagonal(factors))
            }
            (Top::Media { waves: below, reflection }, Layer::Pattern(modes)) => {
                let [u, t] = below.fields(reflection);
                let [sum, difference] = layer.mixed(&u, &t);
                let r = solve(&sum, &difference)?;
                let reflection = passed(r.clone(), &passage);
                (
                    Top::Patterned { layer, reflection },
                    Transfer::Pattern { modes, reflection: r, electric: u, magnetic: t },
                )
            }
            (Top::Patterned { layer: below, reflection }, _) => {
                let identity = Matrix::identity(reflection.nrows(), reflection.ncols());
                let [u, t] = below.fields(&(&identity + reflection), &(&identity - reflection));
                let [p, q] = layer.amplitudes(&u, &t)?;
                let factors = Factors::new(&p + &q);
                let reflection = passed(factors.solve_left(&(p - q))?, &passage);
                (Top::Patterned { layer, reflection }, Transfer::Inverse(factors))
            }
        };
        self.top = top;
        self.steps.push((passage, transfer));
        Ok(())
    }

    /// Amplitudes of the waves that go up in the half-space above and that go down in the half-space below, for waves
    /// that go down in the half-space above (one column for each kind of light).
    ///
    /// # Errors
    /// [`WaveError::Singular`] if they are not finite.
    pub(super) fn illuminate(&self, above: &PlaneWaves, light: &Matrix) -> Result<[Matrix; 2], WaveError> {
        let (e, h) = (&above.electric, &above.magnetic);
        // (e V(1 − R) + h W(1 + R)) down = 2 e h light.
        let source = scaled(&e.iter().zip(h).map(|(e, h)| 2.0 * e * h).collect::<Vec<_>>(), light);
        let (layer, mut down, up) = match &self.top {
            Top::Media { waves, reflection } => {
                let [u, t] = waves.fields(reflection);
                let inverses = (0..e.len()).map(|i| (e[i] * t[i] + h[i] * u[i]).inv()).collect::<Vec<_>>();
                let down = scaled(&inverses, &source);
                let up = scaled(reflection, &down);
                (Layer::Medium(waves), down, up)
            }
            Top::Patterned { layer, reflection } => {
                let [sum, difference] = layer.mixed(e, h);
                let down = solve(&(sum - difference * reflection), &source)?;
                let up = reflection * &down;
                (*layer, down, up)
            }
        };
        let [electric, magnetic] = layer.fields(&(&down + &up), &(&down - &up));
        // From the field of which a plane wave of amplitude 1 has 1: magnetic in part p, electric in part s.
        let n = light.nrows() / 2;
        let reflected = Matrix::from_fn(2 * n, light.ncols(), |i, j| {
            if i < n { light[(i, j)] - magnetic[(i, j)] } else { electric[(i, j)] - light[(i, j)] }
        });
        for (passage, transfer) in self.steps.iter().rev() {
            down = transfer.apply(&scaled(passage, &down))?;
        }
        Ok([reflected, down])
    }
}

/// Rows of a matrix, each times its factor.
fn scaled(factors: &[Complex64], matrix: &Matrix) -> Matrix {
    Matrix::from_fn(matrix.nrows(), matrix.ncols(), |i, j| factors[i] * matrix[(i, j)])
}

/// Reflection at the bottom of a layer, taken to its top.
fn passed(mut reflection: Matrix, passage: &[Complex64]) -> Matrix {
    for (column, x_j) in reflection.col_iter_mut().zip(passage) {
        for (element, x_i) in column.iter_mut().zip(passage) {
            *element *= x_i * x_j;
        }
    }
    reflection
}
