//! The stages of an estimate as pieces of work: defined once, then timed by criterion, counted in instructions, and set against
//! the machine's limits. Each checks its result before it is measured.

mod bvh;
mod cell;
mod coherence;
mod colour;
mod interface;
mod phase;
mod planar;
mod stack;
mod table;

pub use bvh::{bvh, incoherent};
pub use cell::cell;
pub use coherence::coherence;
pub use colour::colour;
pub use interface::interface;
pub use phase::phase;
pub use planar::planar;
pub use stack::stack;
pub use table::table;

/// What one run of a piece of work does.
#[derive(Clone, Debug)]
pub struct Work {
    /// Such as "stack".
    pub stage: &'static str,
    /// Within the stage.
    pub name: &'static str,
    /// What is counted: "wavelength·layers", "rays".
    pub unit: &'static str,
    /// Units of one run.
    pub amount: f64,
}

/// Called with each piece of work of a stage and what runs it once.
pub type Visit<'v> = &'v mut dyn FnMut(&Work, &mut dyn FnMut());

/// A stage with one kind of lanes.
pub type Stage = fn(Visit<'_>);
