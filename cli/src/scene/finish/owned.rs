//! Finishes that own their memory.

use goniochrome::microfacet::{FacetTable, Finish, FinishError, Masking};

/// A finish with the memory of its facets.
#[derive(Clone, Debug, PartialEq)]
pub enum OwnedFinish {
    /// GGX or Beckmann facets.
    Analytic(Finish<'static>),
    /// Facets of a tabulated distribution.
    Tabulated(OwnedFacets, Masking),
}

impl OwnedFinish {
    /// The finish.
    #[must_use]
    pub fn finish(&self) -> Finish<'_> {
        match self {
            Self::Analytic(finish) => *finish,
            Self::Tabulated(facets, masking) => Finish::tabulated(facets.table(), *masking),
        }
    }
}

/// A tabulated distribution of normals with its memory.
#[derive(Clone, Debug, PartialEq)]
pub struct OwnedFacets {
    size: [usize; 2],
    memory: Vec<f32>,
}

impl OwnedFacets {
    /// Facets of a density D at the nodes of a table, `density[ring][sector]`, in any unit.
    ///
    /// # Errors
    /// As [`FacetTable::new`].
    pub fn new(size: [usize; 2], density: &[f32]) -> Result<Self, FinishError> {
        let [rings, sectors] = size;
        // Sizes that the table refuses would be too large to count.
        let fits = density.len().checked_div(sectors).is_some_and(|rows| rows == rings.saturating_add(1));
        if !fits {
            return Err(FinishError::Size);
        }
        let mut memory = vec![0.0; FacetTable::required_len(size)];
        FacetTable::new(size, density, &mut memory)?;
        Ok(Self { size, memory })
    }

    /// All numbers of the table, as a blob holds them.
    #[must_use]
    pub fn numbers(&self) -> &[f32] {
        &self.memory
    }

    /// The table.
    ///
    /// # Panics
    /// Never: the memory is that of its size.
    #[must_use]
    pub fn table(&self) -> FacetTable<'_> {
        FacetTable::of(self.size, &self.memory).expect("the memory of a table of this size")
    }
}
