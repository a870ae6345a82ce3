//! Library behind the `goniochrome` command: scenes, estimation with threads, files and pictures.
//!
//! Each module uses only those declared above it.

pub mod support;
pub mod obj;
pub mod scene;
pub mod colour;
pub mod table;
pub mod solve;
pub mod plot;
pub mod export;
pub mod render;
pub mod view;
pub mod paper;
pub mod commands;
