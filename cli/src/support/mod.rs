//! What every part of the program stands on: errors, files, threads, memory and words for the terminal.

pub mod direction;
pub mod text;
pub mod error;
pub mod memory;
pub mod parallel;
pub mod output;
pub mod progress;
