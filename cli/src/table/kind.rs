//! A table of any kind: mirror-like, scattering, or of diffraction orders.

use crate::support::error::{Error, Result};
use crate::table::metadata::Metadata;
use crate::table::mirror::MirrorTable;
use crate::table::orders::OrderTable;
use crate::table::scatter::ScatterTable;

/// BRDF table of any kind.
#[derive(Debug, Clone, PartialEq)]
pub enum Table {
    /// Table of a mirror-like surface.
    Mirror(MirrorTable),
    /// Table of a cell of tilted facets.
    Scatter(ScatterTable),
    /// Table of the diffraction orders of a periodic surface.
    Orders(OrderTable),
}

impl From<MirrorTable> for Table {
    fn from(table: MirrorTable) -> Self {
        Self::Mirror(table)
    }
}

impl From<ScatterTable> for Table {
    fn from(table: ScatterTable) -> Self {
        Self::Scatter(table)
    }
}

impl From<OrderTable> for Table {
    fn from(table: OrderTable) -> Self {
        Self::Orders(table)
    }
}

impl Table {
    /// Checks that the table's arrays fit together and hold possible values.
    ///
    /// # Errors
    /// Names the first array of a wrong length, wavelength or angle out of order, or value that no BRDF has.
    pub fn check(&self) -> Result<()> {
        match self {
            Self::Mirror(table) => table.check(),
            Self::Scatter(table) => table.check(),
            Self::Orders(table) => table.check(),
        }
    }

    /// Provenance of the table: scene, model, colour space.
    #[must_use]
    pub fn metadata(&self) -> &Metadata {
        match self {
            Self::Mirror(table) => &table.metadata,
            Self::Scatter(table) => &table.metadata,
            Self::Orders(table) => &table.metadata,
        }
    }

    /// Name of the scene that the table was made from, or `table` where it is unknown.
    #[must_use]
    pub fn name(&self) -> &str {
        self.metadata().scene_name()
    }

    /// Vacuum wavelengths in nanometres, strictly increasing and positive.
    #[must_use]
    pub fn wavelength_nm(&self) -> &[f64] {
        match self {
            Self::Mirror(table) => &table.wavelength_nm,
            Self::Scatter(table) => &table.wavelength_nm,
            Self::Orders(table) => &table.wavelength_nm,
        }
    }

    /// Linear RGB: ρ of each angle of a mirror-like table, f in 1/sr of each pair of directions of a scattering one.
    ///
    /// # Errors
    /// A mirror-like table without a visible wavelength has no colours. Those of orders depend on the light.
    pub fn rgb(&self) -> Result<&[[f32; 3]]> {
        match self {
            Self::Mirror(table) => table.colours(),
            Self::Scatter(table) => Ok(&table.rgb),
            Self::Orders(_) => Err(no_values()),
        }
    }

    /// Unpolarised spectra, `[angle or pair of directions][wavelength]`: ρ or f of the directions that [`Table::rgb`]
    /// has the colours of.
    ///
    /// # Errors
    /// Diffraction orders leave in directions of their own at each wavelength.
    pub fn spectra(&self) -> Result<Vec<f32>> {
        match self {
            Self::Mirror(table) => Ok(table.unpolarised().map(|reflectance| reflectance as f32).collect()),
            Self::Scatter(table) => Ok((0..table.layout.count()).flat_map(|pair| table.spectrum(pair)).collect()),
            Self::Orders(_) => Err(no_values()),
        }
    }
}

/// Error of what asks a table of diffraction orders for values of f.
fn no_values() -> Error {
    Error::failed(
        "diffraction orders have no values per solid angle; this needs a table of films or of scattered light",
    )
}
