//! Column of n or k in a table: which of its rows can be used, and what is wrong with the others.
//!
//! A row is in order if every row before it has a smaller wavelength and every row after it a larger one. A row that
//! repeats the one before it exactly is skipped. The table is unambiguous between two neighbouring rows in order.
//! Elsewhere, and next to a value that no passive medium has, the value is unknown (NaN): a command fails only if it
//! needs such a wavelength.

use goniochrome::optics::medium::IndexPart;

use super::diagnostics::SourceText;
use super::dispersion::OwnedDispersion;
use crate::support::error::Result;

/// Largest n or k. Metals reach some thousand in the far infrared; a larger number is a mistake, and its square loses
/// precision.
pub(super) const MAX_INDEX: f64 = 1e6;

/// Largest −k that counts as a rounded 0: over a path of a millimetre it would amplify by 1 %.
const ROUNDING_OF_K: f64 = 1e-6;

/// Row of a column: wavelength, value and line in the file.
#[derive(Clone, Copy)]
pub(super) struct Row {
    pub line: usize,
    pub wavelength_nm: f64,
    pub value: f64,
}

/// n or k of a medium, with notes for its user.
#[derive(Debug)]
pub(super) struct Column {
    pub dispersion: OwnedDispersion,
    pub notes: Notes,
}

/// Faults of a column.
#[derive(Clone, Debug, Default)]
pub(super) struct Notes {
    /// Wavelengths of unknown values, each with the reason.
    pub faults: Vec<(f64, String)>,
    /// Wavelengths at which k lay just below 0 and is taken as 0.
    pub rounded_nm: Vec<f64>,
}

/// Builds a column from rows in the order of their file, by increasing or decreasing wavelength.
pub(super) fn column(source: &SourceText<'_>, part: IndexPart, mut rows: Vec<Row>) -> Result<Column> {
    if rows.first().map(|row| row.wavelength_nm) > rows.last().map(|row| row.wavelength_nm) {
        rows.reverse();
    }
    rows.dedup_by(|b, a| a.wavelength_nm == b.wavelength_nm && a.value == b.value);
    let in_place = in_place(&rows);
    let mut notes = Notes::default();
    let (mut wavelength_nm, mut value) = (Vec::with_capacity(rows.len()), Vec::with_capacity(rows.len()));
    let mut at = 0;
    for run in in_place.chunk_by(|a, b| a == b) {
        let here = at..at + run.len();
        at = here.end;
        if run[0] {
            for row in &rows[here] {
                wavelength_nm.push(row.wavelength_nm);
                value.push(known(source, part, row, &mut notes));
            }
            continue;
        }
        // One unknown value stands for all rows between those in order.
        let nm = rows[here.clone()].iter().map(|row| row.wavelength_nm);
        let (min, max) = nm.fold((f64::INFINITY, 0.0), |(min, max): (f64, f64), nm| (min.min(nm), max.max(nm)));
        let middle = if here.start == 0 {
            min
        } else if at == rows.len() {
            max
        } else {
            f64::midpoint(min, max)
        };
        wavelength_nm.push(middle);
        value.push(f64::NAN);
        notes.faults.push((middle, disorder(source, part, &rows, here)));
    }
    if value.iter().all(|value| value.is_nan()) {
        let reason = notes.faults.first().map_or_else(|| "the table has no rows".to_owned(), |(_, why)| why.clone());
        return Err(crate::support::error::Error::failed(format_args!("{reason}; no row of {part} is of use")));
    }
    Ok(Column { dispersion: OwnedDispersion::Table { wavelength_nm, value }, notes })
}

/// Whether each row is in order.
fn in_place(rows: &[Row]) -> Vec<bool> {
    let mut good = vec![true; rows.len()];
    let mut max = 0.0;
    for (good, row) in good.iter_mut().zip(rows) {
        *good = row.wavelength_nm > max;
        max = row.wavelength_nm.max(max);
    }
    let mut min = f64::INFINITY;
    for (good, row) in good.iter_mut().zip(rows).rev() {
        *good &= row.wavelength_nm < min;
        min = row.wavelength_nm.min(min);
    }
    good
}

/// Value of a row, NaN if no passive medium has it.
fn known(source: &SourceText<'_>, part: IndexPart, row: &Row, notes: &mut Notes) -> f64 {
    let value = row.value;
    let fault = match part {
        _ if !value.is_finite() => format!("{part} is no finite number"),
        IndexPart::N if value <= 0.0 => format!("n = {value}; n must be positive"),
        IndexPart::K if value < -ROUNDING_OF_K => {
            format!("k = {value} is gain; k must not be negative: for a table of n − ik write +k")
        }
        _ if value > MAX_INDEX => format!("{part} = {value} is more than {MAX_INDEX}"),
        IndexPart::K if value < 0.0 => {
            notes.rounded_nm.push(row.wavelength_nm);
            return 0.0;
        }
        _ => return value,
    };
    notes.faults.push((row.wavelength_nm, format!("{}:{}: {fault}", source.label, row.line)));
    f64::NAN
}

/// Message about the first rows among `run` that are out of order.
fn disorder(source: &SourceText<'_>, part: IndexPart, rows: &[Row], run: std::ops::Range<usize>) -> String {
    let first = run.start.max(1);
    let pair = rows[first - 1..run.end].windows(2).find(|pair| pair[0].wavelength_nm >= pair[1].wavelength_nm);
    let Some(&[a, b]) = pair else { return format!("{}: rows are out of order", source.label) };
    // The message names the later line, also in a table that decreases.
    let (a, b) = if a.line < b.line { (a, b) } else { (b, a) };
    let place = format!("{}:{}", source.label, b.line);
    if a.wavelength_nm == b.wavelength_nm {
        let (nm, one, other) = (a.wavelength_nm, a.value, b.value);
        format!("{place}: {nm} nm stands twice, with {part} = {one} and {other}; remove one row")
    } else {
        let (one, other) = (a.wavelength_nm, b.wavelength_nm);
        format!("{place}: the row of {other} nm stands after that of {one} nm; put the rows in order")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(part: IndexPart, rows: &[(f64, f64)]) -> Result<Column> {
        let row = |(i, &(wavelength_nm, value)): (usize, &(f64, f64))| Row { line: i + 1, wavelength_nm, value };
        column(&SourceText { label: "f", text: "" }, part, rows.iter().enumerate().map(row).collect())
    }

    fn table(rows: &[(f64, f64)]) -> (Vec<f64>, Vec<f64>, Vec<String>) {
        let column = read(IndexPart::N, rows).unwrap();
        let OwnedDispersion::Table { wavelength_nm, value } = column.dispersion else { panic!("a table") };
        (wavelength_nm, value, column.notes.faults.into_iter().map(|(_, why)| why).collect())
    }

    #[test]
    fn exact_repeats_and_decreasing_wavelengths_are_no_fault() {
        let (nm, value, faults) = table(&[(500.0, 1.5), (500.0, 1.5), (400.0, 1.6), (300.0, 1.7), (300.0, 1.7)]);
        assert_eq!((nm, value), (vec![300.0, 400.0, 500.0], vec![1.7, 1.6, 1.5]));
        assert_eq!(faults, Vec::<String>::new());
    }

    #[test]
    fn what_lies_between_rows_in_their_places_alone_is_lost() {
        let rows = [(1.0, 1.1), (2.0, 1.2), (4.0, 1.4), (3.0, 1.3), (5.0, 1.5), (6.0, 1.6), (6.0, 1.7), (7.0, 1.8)];
        let (nm, value, faults) = table(&rows);
        assert_eq!(nm, [1.0, 2.0, 3.5, 5.0, 6.0, 7.0]);
        assert_eq!(value.iter().map(|x| x.is_nan()).collect::<Vec<_>>(), [false, false, true, false, true, false]);
        assert_eq!(faults[0], "f:4: the row of 3 nm stands after that of 4 nm; put the rows in order");
        assert_eq!(faults[1], "f:7: 6 nm stands twice, with n = 1.6 and 1.7; remove one row");
    }

    #[test]
    fn disorder_at_an_end_reaches_to_that_end() {
        let (nm, value, _) = table(&[(3.0, 1.3), (2.0, 1.2), (4.0, 1.4), (5.0, 1.5)]);
        assert_eq!((nm, value[0].is_nan()), (vec![2.0, 4.0, 5.0], true));
        let (nm, value, _) = table(&[(1.0, 1.3), (2.0, 1.2), (5.0, 1.4), (4.0, 1.5)]);
        assert_eq!((nm, value[2].is_nan()), (vec![1.0, 2.0, 5.0], true));
    }

    #[test]
    fn k_below_zero_by_rounding_is_zero_and_more_is_gain() {
        let column = read(IndexPart::K, &[(400.0, 1e-7), (500.0, -6e-19), (600.0, -1e-6), (700.0, -2e-6)]).unwrap();
        let OwnedDispersion::Table { value, .. } = column.dispersion else { panic!("a table") };
        assert_eq!(value[..3], [1e-7, 0.0, 0.0]);
        assert!(value[3].is_nan());
        assert_eq!(column.notes.rounded_nm, [500.0, 600.0]);
        assert!(column.notes.faults[0].1.starts_with("f:4: k = -0.000002 is gain"), "{:?}", column.notes.faults);
    }

    #[test]
    fn a_column_without_a_value_of_use_is_refused() {
        let refused = read(IndexPart::K, &[(400.0, -1.0), (500.0, -2.0)]).unwrap_err().to_string();
        assert!(refused.starts_with("f:1: k = -1 is gain") && refused.contains("write +k"), "{refused}");
        assert!(read(IndexPart::N, &[(400.0, 1.0), (400.0, 2.0)]).unwrap_err().to_string().contains("f:2: 400 nm"));
    }
}
