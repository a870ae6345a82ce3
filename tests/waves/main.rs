//! Solvers of `goniochrome-waves` against independent programs and laws of physics.

mod crossed;
mod crossed_truncation;
mod data;
mod error_bars;
mod lamellar;
mod laws;
mod random;
mod chandezon;
