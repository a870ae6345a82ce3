//! Tests of the program as its users see it: they give it files and arguments, and get files, or one line of error and
//! an exit code.

mod agreement;
mod blob;
mod bounds;
mod cells;
mod colours;
mod destinations;
mod discs;
mod disk_full;
mod drawn_scenes;
mod exports;
mod figures;
mod finishes;
mod hits;
mod kills;
mod lookup;
mod meshes;
mod order_files;
mod parts;
mod plain_text;
mod presets;
#[path = "../random.rs"]
mod random;
mod render;
mod render_orders;
mod render_scatter;
mod scenes;
mod sheets;
mod spreads;
mod tables;
mod tabulated_finishes;
mod tilted;
mod usage;
mod user;
mod view;
mod waves;
