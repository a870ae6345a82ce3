//! The program as its users meet it: files and arguments in; files, one line of error and an exit code out.

mod agreement;
mod blob;
mod bounds;
mod cells;
mod colours;
mod destinations;
mod disk_full;
mod drawn_scenes;
mod exports;
mod figures;
mod hits;
mod kills;
mod meshes;
mod plain_text;
mod presets;
mod render;
mod scenes;
mod tables;
mod tilted;
mod usage;
mod user;
mod view;
