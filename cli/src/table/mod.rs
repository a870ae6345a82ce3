//! BRDF tables as data, and their files.

pub mod statistics;
pub mod mirror;
pub mod scatter;
pub mod file;
