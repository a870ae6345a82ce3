//! Pictures of tables.

pub mod mirror;
pub mod facets;
pub mod lobes;
pub mod scatter;
pub mod orders;
mod streaks;

use crate::plot::Picture;
use crate::support::error::Result;
use crate::table::Table;

/// The hemisphere of a table as a disc: the colour of every direction of a mirror-like surface; for a cell, where the
/// light from (θ, φ) goes, in all directions or in diffraction orders.
///
/// # Errors
/// A table without colours; more than one angle for a cell.
pub fn disc(table: &Table, theta_deg: Option<&[f64]>, phi_deg: f64) -> Result<Picture> {
    match table {
        Table::Mirror(mirror) => mirror::disc(mirror, table.name()),
        Table::Scatter(scatter) => lobes::outgoing(scatter, table.name(), theta_deg, phi_deg),
        Table::Orders(orders) => streaks::outgoing(orders, table.name(), theta_deg, phi_deg),
    }
}
