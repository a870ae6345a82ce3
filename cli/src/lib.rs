//! Library behind the `goniochrome` command: scenes, estimation with threads, files and pictures.

pub mod error;
pub mod html;
pub mod output;
pub mod picture;
pub mod table;
pub mod table_file;
