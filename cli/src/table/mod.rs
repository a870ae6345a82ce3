//! BRDF tables: their data, metadata and files.

pub mod statistics;
pub mod metadata;
pub mod finish;
pub mod mirror;
pub mod scatter;
pub mod orders;
mod kind;
pub mod file;

pub use kind::Table;
