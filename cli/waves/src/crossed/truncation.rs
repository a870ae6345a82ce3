//! Truncations that grow along both axes together.

use crate::light::Light;
use crate::profile::CrossedProfile;

/// Least first level. The change from level 2 to 3 says little: an error bar from it is wrong for 1 of 8 random
/// surfaces.
const MIN_LEVEL: usize = 3;

/// Largest orders [M_x, M_y] of a level: in proportion to the periods, so that details along both axes are as fine, and
/// about (2 · level + 1)² orders in all. At equal periods both are the level.
#[must_use]
pub fn truncation(period_nm: [f64; 2], level: usize) -> [usize; 2] {
    shares(period_nm).map(|share| ((level as f64 * share).round() as usize).max(1))
}

/// Level to begin with: at least 3, and enough to keep all orders that travel above or below the surface.
///
/// With it, [`converge`](crate::convergence::converge) chooses the truncation of a surface with two periods:
///
/// ```
/// use goniochrome_waves::Complex64;
/// use goniochrome_waves::convergence::{Goal, converge};
/// use goniochrome_waves::crossed::{CrossedModes, first_level, truncation};
/// use goniochrome_waves::light::Light;
/// use goniochrome_waves::profile::{CrossedProfile, CrossedSlice, Strip};
///
/// // Pillars of glass, 150 nm square and 100 nm high, on glass.
/// let glass = Complex64::from(1.5);
/// let profile = CrossedProfile {
///     period_nm: [300.0, 300.0],
///     above: 1.0,
///     below: glass,
///     slices: vec![CrossedSlice {
///         thickness_nm: 100.0,
///         strip_edges_nm: vec![0.0, 150.0],
///         strips: vec![
///             Strip { edges_nm: vec![0.0, 150.0], eta: vec![glass, 1.0.into()] },
///             Strip { edges_nm: vec![], eta: vec![1.0.into()] },
///         ],
///     }],
/// };
/// let light = Light { wavelength_nm: 550.0, tangential: [-0.5, 0.0] };
///
/// let goal = Goal { target: 5e-3, first: first_level(&profile, &light), limit: 8 };
/// let found = converge(goal, |level| {
///     let max_order = truncation(profile.period_nm, level);
///     Ok(vec![CrossedModes::new(&profile, &light, max_order)?.response()?])
/// })?;
/// assert!(found.met);
/// # Ok::<(), goniochrome_waves::WaveError>(())
/// ```
#[must_use]
pub fn first_level(profile: &CrossedProfile, light: &Light) -> usize {
    let index = profile.above.max(profile.below.re);
    let shares = shares(profile.period_nm);
    let levels = [0, 1].map(|axis| {
        // |k + mλ/Λ| ≤ n.
        let order = (index + light.tangential[axis].abs()) * profile.period_nm[axis] / light.wavelength_nm;
        (order.floor() / shares[axis]).ceil() as usize
    });
    levels[0].max(levels[1]).max(MIN_LEVEL)
}

/// Largest orders along both axes for each level.
fn shares([x, y]: [f64; 2]) -> [f64; 2] {
    let ratio = (x / y).sqrt();
    [ratio, ratio.recip()]
}
