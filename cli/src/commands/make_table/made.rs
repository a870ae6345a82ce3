//! What `estimate` makes.

use crate::solve::checkpoint::{Checkpoint, Identity};
use crate::table::Table;

/// What the options ask for.
pub(in super::super) enum Made {
    /// A table, its summary, and the checkpoint with its finished parts if it has an output.
    Table(Box<Table>, String, Option<Checkpoint>),
    /// A share of the parts of a table, in a checkpoint with this identity.
    Share(Checkpoint, Identity),
}
