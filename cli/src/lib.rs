//! Library behind the `goniochrome` command: scenes, estimation with threads, files and pictures.

pub mod args;
pub mod bumpy;
pub mod coherent;
pub mod colours;
pub mod commands;
pub mod comparison;
pub mod diffraction;
pub mod error;
pub mod estimate;
pub mod export;
pub mod grid;
pub mod groups;
pub mod html;
pub mod output;
pub mod parallel;
pub mod picture;
pub mod planar;
pub mod progress;
pub mod sampling;
pub mod scatter;
pub mod scatter_estimate;
pub mod scatter_table;
pub mod scene;
pub mod table;
pub mod table_file;
