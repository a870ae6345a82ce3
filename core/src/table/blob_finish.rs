//! The finish of a film in a blob: a field of the header, and numbers.

use super::error::TableError;
use crate::microfacet::{Distribution, FacetTable, Finish, Masking};
use crate::values::Values;

/// Finishes in the order of their numbers, from 1; 0 is a smooth surface. The last two are tabulated.
const FINISHES: [(Option<Distribution>, Masking); 6] = [
    (Some(Distribution::Ggx), Masking::Correlated),
    (Some(Distribution::Ggx), Masking::Separable),
    (Some(Distribution::Beckmann), Masking::Correlated),
    (Some(Distribution::Beckmann), Masking::Separable),
    (None, Masking::Correlated),
    (None, Masking::Separable),
];

/// Finish in a blob's header.
#[derive(Clone, Copy)]
pub(super) enum FinishField {
    Smooth,
    Analytic(Distribution, Masking),
    /// Tabulated facets, of rings and sectors.
    Tabulated([usize; 2], Masking),
}

impl FinishField {
    /// Meaning of a field; `None` if it has none.
    pub fn of(field: u32) -> Option<Self> {
        let [number, sectors, low, high] = field.to_le_bytes();
        let size = [u16::from_le_bytes([low, high]).into(), sectors.into()];
        let Some(place) = usize::from(number).checked_sub(1) else {
            return (field == 0).then_some(Self::Smooth);
        };
        match FINISHES.get(place)? {
            (Some(distribution), masking) => (size == [0; 2]).then_some(Self::Analytic(*distribution, *masking)),
            (None, masking) => (FacetTable::required_len(size) > 0).then_some(Self::Tabulated(size, *masking)),
        }
    }

    /// Number of its numbers in the blob's last section.
    pub fn numbers(self) -> usize {
        match self {
            Self::Smooth => 0,
            Self::Analytic(..) => 2,
            Self::Tabulated(size, _) => FacetTable::required_len(size),
        }
    }

    /// The field of a finish.
    pub fn field(finish: Option<Finish<'_>>) -> u32 {
        let Some(finish) = finish else { return 0 };
        let kind = (finish.distribution(), finish.masking());
        let number = FINISHES.iter().zip(1..).find(|(known, _)| **known == kind).map_or(0, |(_, number)| number);
        // Sizes of tables are below these bounds.
        let [rings, sectors] = finish.facets().map_or([0; 2], |facets| facets.size());
        (rings as u32) << 16 | (sectors as u32) << 8 | number
    }

    /// The finish, with its numbers.
    pub fn finish(self, numbers: Values<'_>) -> Result<Option<Finish<'_>>, TableError> {
        let finish = match self {
            Self::Smooth => return Ok(None),
            Self::Analytic(distribution, masking) => Finish::new(distribution, masking, [numbers.at(0), numbers.at(1)]),
            Self::Tabulated(size, masking) => {
                FacetTable::of_values(size, numbers).map(|facets| Finish::tabulated(facets, masking))
            }
        };
        finish.map(Some).map_err(|_| TableError::Finish)
    }
}
