//! The finish of a film in a blob: a field of the header, and numbers.

use super::error::TableError;
use super::film::FilmTable;
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

    /// Number of its losses there.
    fn of_losses(self) -> usize {
        if matches!(self, Self::Rough { is_compensated: true, .. }) { Compensation::LEN } else { 0 }
    }

    /// Number of its numbers there, for a table of so many thicknesses and channels.
    pub fn numbers(self, [thicknesses, channels]: [u32; 2]) -> Option<u64> {
        let returned = if self.of_losses() > 0 { u64::from(thicknesses).checked_mul(channels.into())? } else { 0 };
        returned.checked_add((self.of_facets() + self.of_losses()) as u64)
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

    /// The table of a film with the finish, by all numbers of the finish.
    pub fn on<'a>(self, film: FilmTable<'a>, numbers: Values<'a>) -> Result<FilmTable<'a>, TableError> {
        let Self::Rough { facets, masking, .. } = self else { return Ok(film) };
        let finish = match facets {
            FacetField::Analytic(distribution) => Finish::new(distribution, masking, [numbers.at(0), numbers.at(1)]),
            FacetField::Tabulated(size) => FacetTable::of_values(size, numbers.part(0, self.of_facets()))
                .map(|facets| Finish::tabulated(facets, masking)),
        };
        let finish = finish.map_err(|_| TableError::Finish)?;
        if self.of_losses() == 0 {
            return Ok(film.finished(finish));
        }
        let losses = Compensation::of_values(numbers.part(self.of_facets(), self.of_losses()));
        let finish = finish.with_compensation(losses.map_err(|_| TableError::Finish)?);
        let before = self.of_facets() + self.of_losses();
        film.finished(finish).returning(numbers.part(before, numbers.len() - before))
    }
}
