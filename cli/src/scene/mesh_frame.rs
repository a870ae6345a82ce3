//! Axes and unit of a cell's mesh file, and how its vertices become nanometres with z up.

use super::parts::MAX_LENGTH_NM;
use super::toml_value::TomlTable;
use crate::obj::Axes;
use crate::support::error::Result;

/// Axes and unit of a mesh file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct MeshFrame {
    /// Axis that points up.
    pub axes: Axes,
    /// Length of a unit of the file.
    pub unit_nm: f64,
}

impl Default for MeshFrame {
    fn default() -> Self {
        Self { axes: Axes::ZUp, unit_nm: 1.0 }
    }
}

impl MeshFrame {
    /// Reads the keys `axes` and `unit_nm` of a `[cell]`.
    pub fn read(cell: &TomlTable<'_>) -> Result<Self> {
        let mut frame = Self::default();
        if let Some(item) = cell.get("axes") {
            frame.axes = match item.text()? {
                "z-up" => Axes::ZUp,
                "y-up" => Axes::YUp,
                other => return Err(item.refuse(format_args!("{other:?} is unknown; write \"z-up\" or \"y-up\""))),
            };
        }
        if let Some(item) = cell.get("unit_nm") {
            frame.unit_nm = item.number()?;
            if frame.unit_nm <= 0.0 {
                return Err(
                    item.refuse("the unit of the mesh must be more than 0 nm; metres are 1e9, micrometres 1000")
                );
            }
        }
        Ok(frame)
    }

    /// Converts a vertex of the file to nanometres, z up.
    pub fn place(self, vertex: [f64; 3]) -> [f64; 3] {
        self.axes.turned(vertex).map(|x| self.unit_nm * x)
    }

    /// Message about a coordinate beyond [`MAX_LENGTH_NM`].
    pub fn too_long(self, coordinate_nm: f64) -> String {
        let unit = match self.unit_nm {
            1.0 => "units are nanometres unless [cell] has unit_nm".to_owned(),
            unit_nm => format!("unit_nm in [cell] is {unit_nm}"),
        };
        format!("coordinate {coordinate_nm} nm is more than {MAX_LENGTH_NM} nm, a metre; {unit}")
    }
}
