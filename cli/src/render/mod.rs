//! Pictures of a surface on a lit body: what `goniochrome render` draws, and `goniochrome view` shows.
//!
//! The shared parts read and write no files: [`mesh`] (what is lit), [`camera`] (from where it is seen), [`environment`] (by what
//! it is lit).
//!
//! The world is right-handed with z up. Directions are unit vectors; `wo` points to the viewer and `wi` to the light.

pub mod camera;
pub mod environment;
mod latlong;
pub mod mesh;
mod obj;
pub mod studio;
mod teapot;
