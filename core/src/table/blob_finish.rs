//! The finish of a film in a blob: a field of the header, and numbers.

use super::error::TableError;
use crate::microfacet::{Compensation, Distribution, FacetTable, Finish, Masking};
use crate::values::Values;

/// Finishes in the order of their numbers, from 1; 0 is a smooth surface. The last two are tabulated. With energy
/// compensation they follow in the same order.
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
    Rough { facets: FacetField, masking: Masking, is_compensated: bool },
}

/// Facets in a blob's header.
#[derive(Clone, Copy)]
pub(super) enum FacetField {
    Analytic(Distribution),
    /// Rings and sectors.
    Tabulated([usize; 2]),
}

impl FinishField {
    /// Meaning of a field; `None` if it has none.
    pub fn of(field: u32) -> Option<Self> {
        let [number, sectors, low, high] = field.to_le_bytes();
        let size = [u16::from_le_bytes([low, high]).into(), sectors.into()];
        let Some(place) = usize::from(number).checked_sub(1) else {
            return (field == 0).then_some(Self::Smooth);
        };
        let is_compensated = place >= FINISHES.len();
        let (distribution, masking) = *FINISHES.get(if is_compensated { place - FINISHES.len() } else { place })?;
        let (fits, facets) = match distribution {
            Some(distribution) => (size == [0; 2], FacetField::Analytic(distribution)),
            None => (FacetTable::required_len(size) > 0, FacetField::Tabulated(size)),
        };
        fits.then_some(Self::Rough { facets, masking, is_compensated })
    }

    /// Number of numbers of its facets in the blob's last section.
    fn of_facets(self) -> usize {
        match self {
            Self::Smooth => 0,
            Self::Rough { facets: FacetField::Analytic(_), .. } => 2,
            Self::Rough { facets: FacetField::Tabulated(size), .. } => FacetTable::required_len(size),
        }
    }

    /// Whether the light of several bounces is returned.
    pub fn is_compensated(self) -> bool {
        matches!(self, Self::Rough { is_compensated: true, .. })
    }

    /// Number of its numbers there, without what several bounces return.
    pub fn numbers(self) -> usize {
        self.of_facets() + if self.is_compensated() { Compensation::LEN } else { 0 }
    }

    /// The field of a finish.
    pub fn field(finish: Option<Finish<'_>>) -> u32 {
        let Some(finish) = finish else { return 0 };
        let kind = (finish.distribution(), finish.masking());
        let number = FINISHES.iter().zip(1..).find(|(known, _)| **known == kind).map_or(0, |(_, number)| number);
        let more = if finish.compensation().is_some() { FINISHES.len() as u32 } else { 0 };
        // Sizes of tables are below these bounds.
        let [rings, sectors] = finish.facets().map_or([0; 2], |facets| facets.size());
        (rings as u32) << 16 | (sectors as u32) << 8 | (number + more)
    }

    /// The finish, with its numbers.
    pub fn finish(self, numbers: Values<'_>) -> Result<Option<Finish<'_>>, TableError> {
        let Self::Rough { facets, masking, is_compensated } = self else { return Ok(None) };
        let finish = match facets {
            FacetField::Analytic(distribution) => Finish::new(distribution, masking, [numbers.at(0), numbers.at(1)]),
            FacetField::Tabulated(size) => FacetTable::of_values(size, numbers.part(0, self.of_facets()))
                .map(|facets| Finish::tabulated(facets, masking)),
        };
        let mut finish = finish.map_err(|_| TableError::Finish)?;
        if is_compensated {
            let losses = Compensation::of_values(numbers.part(self.of_facets(), Compensation::LEN));
            finish = finish.with_compensation(losses.map_err(|_| TableError::Finish)?);
        }
        Ok(Some(finish))
    }
}
