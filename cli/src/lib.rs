//! Library behind the `goniochrome` command: scenes, estimation with threads, files and pictures.
//!
//! Each module uses only those declared above it.

pub mod support;
pub(crate) mod obj;
pub mod scene;
pub mod colour;
pub mod table;
pub mod solve;
pub mod plot;
pub mod export;
pub mod render;
pub(crate) mod view;
pub(crate) mod paper;
pub mod commands;

/// The example of README.md, compiled as a documentation test.
#[cfg(doctest)]
#[doc = include_str!("../../README.md")]
struct Readme;
