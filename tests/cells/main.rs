//! Tests of polygon cells: against programs that share no code with this one, the planar tracer and laws of physics.

mod coherences;
mod general_path;
mod geometric;
mod gratings;
mod height_field;
mod interpolation;
mod laws;
mod order_error;
#[path = "../random.rs"]
mod random;
mod reciprocity;
mod registers;
mod rippled_films;
mod scene;
