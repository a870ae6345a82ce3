//! Library behind the `goniochrome` command: scenes, estimation with threads, files and pictures.

pub mod error;
pub mod scene;
