//! The program as its users meet it: files and arguments in; files, one line of error and an exit code out.

mod agreement;
mod blob;
mod cells;
mod colours;
mod destinations;
mod disk_full;
mod figures;
mod meshes;
mod presets;
mod scenes;
mod tables;
mod usage;
mod user;
