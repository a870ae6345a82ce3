//! The stages of an estimate as pieces of work. Criterion times them, callgrind counts their instructions, and `limits`
//! compares them with the machine's limits. Each checks its result before it is measured.

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

/// A piece of work of a stage, and the amount that one run does.
#[derive(Clone, Debug)]
pub struct Work {
    /// The stage's name, such as "stack".
    pub stage: &'static str,
    /// The name within the stage, such as "prepare".
    pub name: &'static str,
    /// The unit of the amount, such as "wavelength·layers" or "rays".
    pub unit: &'static str,
    /// The number of units that one run does.
    pub amount: f64,
}

/// A visitor of a stage: it is called with each piece of work and a function that runs it once.
pub type Visit<'v> = &'v mut dyn FnMut(&Work, &mut dyn FnMut());

/// A stage for one kind of lanes.
pub type Stage = fn(Visit<'_>);
