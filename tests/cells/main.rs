//! Polygon cells against programs that share no code with this one, and against the planar tracer.

mod coherences;
mod general_path;
mod geometric;
mod gratings;
mod height_field;
mod laws;
mod order_error;
mod reciprocity;
mod scene;
