//! The light that arrives.

/// Plane wave from above, by its wavelength and its tangential wavevector.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Light {
    /// Vacuum wavelength λ.
    pub wavelength_nm: f64,
    /// Tangential wavevector (k_x, k_y) in units of k₀, along the direction of travel: −n (wi_x, wi_y).
    pub tangential: [f64; 2],
}
