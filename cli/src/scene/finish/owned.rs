//! Finishes that own their memory.

use std::sync::OnceLock;

use goniochrome::microfacet::{Compensation, FacetTable, Finish, FinishError, Masking};

/// A finish with the memory of its facets.
#[derive(Clone, Debug, PartialEq)]
pub struct OwnedFinish {
    facets: FinishFacets,
    /// Losses of energy compensation; `None` without it.
    losses: Option<Losses>,
}

/// The facets of a finish.
#[derive(Clone, Debug, PartialEq)]
pub enum FinishFacets {
    /// GGX or Beckmann facets.
    Analytic(Finish<'static>),
    /// Facets of a tabulated distribution.
    Tabulated(OwnedFacets, Masking),
}

impl OwnedFinish {
    /// A finish of facets, without energy compensation.
    #[must_use]
    pub fn new(facets: FinishFacets) -> Self {
        Self { facets, losses: None }
    }

    /// A finish of GGX or Beckmann facets, without energy compensation.
    #[must_use]
    pub fn analytic(finish: Finish<'static>) -> Self {
        Self::new(FinishFacets::Analytic(finish))
    }

    /// The finish with energy compensation, or without.
    #[must_use]
    pub fn compensated(self, is_compensated: bool) -> Self {
        Self { losses: is_compensated.then(Losses::default), ..self }
    }

    /// Whether the light of several bounces is returned.
    #[must_use]
    pub fn is_compensated(&self) -> bool {
        self.losses.is_some()
    }

    /// The facets.
    #[must_use]
    pub fn facets(&self) -> &FinishFacets {
        &self.facets
    }

    /// The facets of a tabulated distribution; `None` for others.
    #[must_use]
    pub fn tabulated(&self) -> Option<&OwnedFacets> {
        match &self.facets {
            FinishFacets::Analytic(_) => None,
            FinishFacets::Tabulated(facets, _) => Some(facets),
        }
    }

    /// The finish without energy compensation.
    #[must_use]
    pub fn uncompensated(&self) -> Finish<'_> {
        match &self.facets {
            FinishFacets::Analytic(finish) => *finish,
            FinishFacets::Tabulated(facets, masking) => Finish::tabulated(facets.table(), *masking),
        }
    }

    /// The finish. With energy compensation the first call computes its losses, in up to a second.
    ///
    /// # Panics
    /// Never: the losses are those of the facets.
    #[must_use]
    pub fn finish(&self) -> Finish<'_> {
        let finish = self.uncompensated();
        let Some(Losses(losses)) = &self.losses else { return finish };
        let losses = losses.get_or_init(|| {
            let mut losses = vec![0.0; Compensation::LEN];
            finish.compensated(&mut losses).expect("memory of the right length");
            losses
        });
        finish.with_compensation(Compensation::of(losses).expect("computed losses"))
    }
}

/// Losses of facets, computed when they are first asked for.
#[derive(Clone, Debug, Default)]
struct Losses(OnceLock<Vec<f32>>);

/// Equal facets have equal losses, computed yet or not.
impl PartialEq for Losses {
    fn eq(&self, _: &Self) -> bool {
        true
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
