//! Cross-sections of surfaces.

use num_complex::Complex64;

use crate::error::WaveError;

/// Layer in which the index depends on x alone, piecewise constant.
#[derive(Clone, Debug, PartialEq)]
pub struct Slice {
    /// Thickness, positive.
    pub thickness_nm: f64,
    /// Positions along x where the medium changes, ascending, in [0, period). Empty where the slice has one medium.
    pub edges_nm: Vec<f64>,
    /// Index of each medium: `eta[i]` lies from edge i to edge i + 1, the last from the last edge over the period's end
    /// to the first. One for each edge, and one where there is no edge.
    pub eta: Vec<Complex64>,
}

/// Surface that is periodic along x and does not depend on y, as layers between two half-spaces.
#[derive(Clone, Debug, PartialEq)]
pub struct Profile {
    /// Period Λ along x.
    pub period_nm: f64,
    /// Index of the half-space above, in which light arrives; real.
    pub above: f64,
    /// Index of the half-space below.
    pub below: Complex64,
    /// Layers from the top.
    pub slices: Vec<Slice>,
}

impl Profile {
    /// Checks what the solvers assume.
    ///
    /// # Errors
    /// [`WaveError::Profile`] if a length is not positive, edges do not ascend within a period, or the number of media
    /// does not fit the edges.
    pub fn check(&self) -> Result<(), WaveError> {
        let whole = |slice: &Slice| {
            positive(slice.thickness_nm)
                && fits(&slice.edges_nm, self.period_nm, slice.eta.len())
                && slice.eta.iter().all(|&eta| is_index(eta))
        };
        let half_spaces = positive(self.above) && is_index(self.below);
        let sound = positive(self.period_nm) && half_spaces && self.slices.iter().all(whole);
        if sound { Ok(()) } else { Err(WaveError::Profile) }
    }
}

fn positive(length: f64) -> bool {
    length > 0.0 && length.is_finite()
}

/// Whether edges ascend within a period, each with one of `count` parts; one part where there is no edge.
fn fits(edges: &[f64], period: f64, count: usize) -> bool {
    count == edges.len().max(1)
        && edges.iter().all(|edge| (0.0..period).contains(edge))
        && edges.is_sorted_by(|a, b| a < b)
}

/// Whether a complex index is one of a medium that does not amplify.
fn is_index(eta: Complex64) -> bool {
    eta.is_finite() && eta.re >= 0.0 && eta.im >= 0.0 && eta.norm_sqr() > 0.0
}

/// Surface that is one interface z = h(x) between two media, periodic along x.
#[derive(Clone, Debug, PartialEq)]
pub struct Graph {
    /// Period Λ along x.
    pub period_nm: f64,
    /// Index above the interface, in which light arrives; real.
    pub above: f64,
    /// Index below the interface.
    pub below: Complex64,
    /// Corners (x, h) of the interface over one period, x ascending in [0, period]; straight lines join them, and the
    /// last to the first of the next period. Two corners of one x are a vertical wall. At least one corner.
    pub points_nm: Vec<[f64; 2]>,
}

impl Graph {
    /// Checks what the solvers assume.
    ///
    /// # Errors
    /// [`WaveError::Profile`] if the period is not positive, an index is not one, there is no corner, or corners do not
    /// ascend within a period.
    pub fn check(&self) -> Result<(), WaveError> {
        let positive = |length: f64| length > 0.0 && length.is_finite();
        let inside = |&[x, h]: &[f64; 2]| (0.0..=self.period_nm).contains(&x) && h.is_finite();
        let sound = positive(self.period_nm)
            && positive(self.above)
            && is_index(self.below)
            && !self.points_nm.is_empty()
            && self.points_nm.iter().all(inside)
            && self.points_nm.is_sorted_by(|a, b| a[0] <= b[0]);
        if sound { Ok(()) } else { Err(WaveError::Profile) }
    }
}

/// Layer of a surface with two periods: strips along x, within each of which the index depends on x alone.
#[derive(Clone, Debug, PartialEq)]
pub struct CrossedSlice {
    /// Thickness, positive.
    pub thickness_nm: f64,
    /// Positions along y where the strips meet, ascending, in [0, period). Empty where one strip fills the slice.
    pub strip_edges_nm: Vec<f64>,
    /// Strips: `strips[j]` lies from strip edge j to j + 1, the last over the period's end. Their thickness does not
    /// count.
    pub strips: Vec<Strip>,
}

/// Strip of a [`CrossedSlice`]: media along x, as in a [`Slice`].
#[derive(Clone, Debug, PartialEq)]
pub struct Strip {
    /// Positions along x where the medium changes, ascending, in [0, period). Empty where the strip has one medium.
    pub edges_nm: Vec<f64>,
    /// Index of each medium, as in [`Slice::eta`].
    pub eta: Vec<Complex64>,
}

/// Surface that is periodic along x and along y, as layers between two half-spaces.
#[derive(Clone, Debug, PartialEq)]
pub struct CrossedProfile {
    /// Periods along x and along y.
    pub period_nm: [f64; 2],
    /// Index of the half-space above, in which light arrives; real.
    pub above: f64,
    /// Index of the half-space below.
    pub below: Complex64,
    /// Layers from the top.
    pub slices: Vec<CrossedSlice>,
}

impl CrossedProfile {
    /// Checks what the solvers assume.
    ///
    /// # Errors
    /// [`WaveError::Profile`] if a length is not positive, edges do not ascend within a period, or the number of strips
    /// or media does not fit the edges.
    pub fn check(&self) -> Result<(), WaveError> {
        let [period_x, period_y] = self.period_nm;
        let whole = |strip: &Strip| {
            fits(&strip.edges_nm, period_x, strip.eta.len()) && strip.eta.iter().all(|&eta| is_index(eta))
        };
        let sound = self.period_nm.into_iter().all(positive)
            && positive(self.above)
            && is_index(self.below)
            && self.slices.iter().all(|slice| {
                positive(slice.thickness_nm)
                    && fits(&slice.strip_edges_nm, period_y, slice.strips.len())
                    && slice.strips.iter().all(whole)
            });
        if sound { Ok(()) } else { Err(WaveError::Profile) }
    }
}
