//! The program as its users meet it: files and arguments in; files, one line of error and an exit code out.

mod agreement;
mod cells;
mod colours;
mod destinations;
mod disk_full;
mod exports;
mod figures;
mod meshes;
mod presets;
mod scenes;
mod tables;
mod usage;
mod user;
