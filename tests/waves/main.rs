//! Solvers of `goniochrome-waves` against independent programs and laws of physics.

mod data;
mod lamellar;
