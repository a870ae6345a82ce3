//! Foundations of every part of the program: errors, files, threads, memory and text for the terminal.

pub(crate) mod direction;
pub(crate) mod text;
pub mod error;
pub(crate) mod memory;
pub(crate) mod parallel;
pub(crate) mod input;
pub mod grey_map;
pub(crate) mod output;
pub(crate) mod progress;
