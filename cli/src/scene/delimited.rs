//! n and k as columns of text: CSV with commas, semicolons or tabs, or columns separated by blanks.
//!
//! A line of numbers is a row: wavelength, n and, in a third column, k. A line that does not begin with a number may
//! name the columns, in any order and among columns that are skipped. Such a line after rows begins a further table:
//! CSV files of refractiveindex.info have a table of n and then one of k. Empty lines and lines that begin with `#`,
//! `%`, `!` or `//` are skipped. Numbers may have a decimal comma unless commas separate the columns.

use goniochrome::optics::medium::{Extrapolate, IndexPart};

use super::column::{Row, column};
use super::diagnostics::SourceText;
use super::medium::OwnedMedium;
use super::refractive_index_info::{medium, nanometres};
use crate::support::error::Result;

/// Unit of wavelengths.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Unit {
    Nanometres,
    Micrometres,
}

impl Unit {
    /// The unit that `text` names.
    pub fn parse(text: &str) -> Option<Self> {
        match text.trim().to_lowercase().as_str() {
            "nm" | "nanometers" | "nanometres" | "nanometer" | "nanometre" => Some(Self::Nanometres),
            "um" | "µm" | "μm" | "micron" | "microns" | "micrometers" | "micrometres" | "micrometer" | "micrometre" => {
                Some(Self::Micrometres)
            }
            _ => None,
        }
    }

    /// Guesses the unit of wavelengths from `min` to `max`. Tables of nanometres that begin below 150, and of
    /// micrometres that begin below 0.1 or above 5 or end above 100, are too rare: the guess is `None`.
    fn guess(min: f64, max: f64) -> Option<Self> {
        const MIN_NM: f64 = 150.0;
        const MIN_UM: f64 = 0.1;
        const MAX_FIRST_UM: f64 = 5.0;
        const MAX_UM: f64 = 100.0;
        if min >= MIN_NM {
            Some(Self::Nanometres)
        } else if (MIN_UM..=MAX_FIRST_UM).contains(&min) && max <= MAX_UM {
            Some(Self::Micrometres)
        } else {
            None
        }
    }

    fn to_nm(self, wavelength: f64) -> f64 {
        match self {
            Self::Nanometres => wavelength,
            Self::Micrometres => nanometres(wavelength),
        }
    }
}

/// Contents of a column.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Role {
    Wavelength,
    Part(IndexPart),
    Other,
}

/// Roles of columns without names.
const UNNAMED: [Role; 3] = [Role::Wavelength, Role::Part(IndexPart::N), Role::Part(IndexPart::K)];

/// Rows read so far.
struct ColumnReader<'s> {
    source: &'s SourceText<'s>,
    roles: Option<Vec<Role>>,
    unit: Option<Unit>,
    n: Vec<Row>,
    k: Vec<Row>,
}

/// Reads a medium from columns of text. `unit` is that of the scene file, if it names one.
pub(super) fn parse(source: &SourceText<'_>, unit: Option<Unit>, extrapolate: Extrapolate) -> Result<OwnedMedium> {
    let mut reader = ColumnReader { source, roles: None, unit: None, n: Vec::new(), k: Vec::new() };
    let lines = lines(source)?;
    refuse_decimal_commas(source, &lines)?;
    for (line, fields) in &lines {
        match number(&fields[0]) {
            Some(_) => reader.row(*line, fields)?,
            None => reader.header(*line, fields)?,
        }
    }
    let ColumnReader { unit: named, mut n, mut k, .. } = reader;
    if n.is_empty() {
        let message = "no rows of wavelength and n; write one row a line: wavelength, n and, if it absorbs, k";
        return Err(source.refuse_line(lines.first().map_or(1, |(line, _)| *line), message));
    }
    let size = n.iter().chain(&k).map(|row| row.wavelength_nm);
    let (min, max) = size.fold((f64::INFINITY, 0.0), |(a, b): (f64, f64), x| (a.min(x), b.max(x)));
    let first = n[0].line;
    let Some(found) = unit.or(named).or_else(|| Unit::guess(min, max)) else {
        let message =
            format!("wavelengths from {min} to {max} without a unit; add unit = \"nm\" or \"um\" to the material");
        return Err(source.refuse_line(first, message));
    };
    for row in n.iter_mut().chain(&mut k) {
        row.wavelength_nm = found.to_nm(row.wavelength_nm);
    }
    let k = if k.is_empty() { None } else { Some(column(source, IndexPart::K, k)?) };
    let read = medium(source, first, column(source, IndexPart::N, n)?, k, extrapolate)?;
    let guess = (unit.or(named).is_none()).then(|| {
        let (full, short) = if found == Unit::Nanometres { ("nanometres", "nm") } else { ("micrometres", "um") };
        format!("{}: wavelengths taken as {full} for their size; unit = \"{short}\" in the scene says so", source.label)
    });
    Ok(read.with_guess(guess))
}

/// Builds a medium from the rows of an inline table, with wavelengths in nanometres.
pub(super) fn inline(
    source: &SourceText<'_>,
    rows: &[(usize, Vec<f64>)],
    extrapolate: Extrapolate,
) -> Result<OwnedMedium> {
    let mut reader = ColumnReader { source, roles: None, unit: Some(Unit::Nanometres), n: Vec::new(), k: Vec::new() };
    for (line, row) in rows {
        reader.put(*line, row, &UNNAMED)?;
    }
    let ColumnReader { n, k, .. } = reader;
    let first = rows.first().map_or(1, |(line, _)| *line);
    if n.is_empty() {
        return Err(source.refuse_line(first, "the table has no rows"));
    }
    let k = if k.is_empty() { None } else { Some(column(source, IndexPart::K, k)?) };
    medium(source, first, column(source, IndexPart::N, n)?, k, extrapolate)
}

impl ColumnReader<'_> {
    fn row(&mut self, line: usize, fields: &[String]) -> Result<()> {
        let roles = self.roles.clone().unwrap_or_else(|| UNNAMED.to_vec());
        let mut numbers = Vec::with_capacity(fields.len());
        for (field, role) in fields.iter().zip(&roles) {
            numbers.push(match number(field) {
                Some(x) => x,
                None if *role == Role::Other => f64::NAN,
                None => return Err(self.source.refuse_line(line, format_args!("{field:?} is not a number"))),
            });
        }
        let enough = match self.roles {
            Some(_) => fields.len() >= roles.len(),
            None => (2..=3).contains(&fields.len()),
        };
        if !enough {
            let message = match self.roles {
                Some(_) => format!("the row has {} columns but its header names {}", fields.len(), roles.len()),
                None => format!(
                    "a row of {} columns; without a header it is wavelength, n and, if it absorbs, k",
                    fields.len()
                ),
            };
            return Err(self.source.refuse_line(line, message));
        }
        self.put(line, &numbers, &roles)
    }

    fn put(&mut self, line: usize, numbers: &[f64], roles: &[Role]) -> Result<()> {
        let at = |wanted: Role| roles.iter().position(|role| *role == wanted).and_then(|place| numbers.get(place));
        let Some(&wavelength_nm) = at(Role::Wavelength).filter(|x| **x > 0.0 && x.is_finite()) else {
            let found = numbers.first().copied().unwrap_or(f64::NAN);
            return Err(self
                .source
                .refuse_line(line, format_args!("wavelength {found}: wavelengths must be positive")));
        };
        let (has_k, had_k) = (at(Role::Part(IndexPart::K)).is_some(), !self.k.is_empty());
        for (part, rows) in [(IndexPart::N, &mut self.n), (IndexPart::K, &mut self.k)] {
            rows.extend(at(Role::Part(part)).map(|&value| Row { line, wavelength_nm, value }));
        }
        if self.roles.is_none() && self.n.len() > 1 && has_k != had_k {
            let message = "k stands in some rows and is missing in others; give it in each, or in none";
            return Err(self.source.refuse_line(line, message));
        }
        Ok(())
    }

    /// Reads a line that does not begin with a number: the names of columns, or a title.
    fn header(&mut self, line: usize, fields: &[String]) -> Result<()> {
        let roles: Vec<Role> = fields.iter().map(|field| role(field)).collect();
        let refuse = |message: String| Err(self.source.refuse_line(line, message));
        for part in [IndexPart::N, IndexPart::K] {
            if roles.iter().filter(|role| **role == Role::Part(part)).count() > 1 {
                return refuse(format!("two columns of {part}; keep one"));
            }
        }
        let has = |wanted: fn(&Role) -> bool| roles.iter().any(wanted);
        let (wavelength, parts) = (has(|role| *role == Role::Wavelength), has(|role| matches!(role, Role::Part(_))));
        if let Some(other) = fields.iter().find(|field| is_no_wavelength(field)) {
            return refuse(format!("the column {other:?} is no wavelength; give vacuum wavelengths in nm or um"));
        }
        if wavelength && !parts && fields.len() > 1 {
            let names = fields.iter().map(|field| format!("{field:?}")).collect::<Vec<_>>().join(", ");
            return refuse(format!("the columns are {names}; name those of the index n and k"));
        }
        if !(wavelength && parts) {
            return match self.n.is_empty() {
                true => Ok(()), // a title
                false => refuse(format!("{:?} is neither a number nor a header of columns", fields[0])),
            };
        }
        let again = |part: IndexPart, rows: &[Row]| roles.contains(&Role::Part(part)) && !rows.is_empty();
        if again(IndexPart::N, &self.n) || again(IndexPart::K, &self.k) {
            return refuse("a second table of the same columns; keep one".to_owned());
        }
        let named = fields.iter().zip(&roles).filter(|(_, role)| **role == Role::Wavelength);
        let unit = named.clone().find_map(|(field, _)| unit_in(field));
        if self.unit.is_some() && unit.is_some() && self.unit != unit && !(self.n.is_empty() && self.k.is_empty()) {
            return refuse("another unit than that of the table before it; use one for both".to_owned());
        }
        if named.count() > 1 {
            return refuse("two columns of wavelengths; keep one".to_owned());
        }
        (self.roles, self.unit) = (Some(roles), unit.or(self.unit));
        Ok(())
    }
}

/// Words of a column's name, in lower case.
fn words(field: &str) -> Vec<String> {
    let letter = |c: char| c.is_alphanumeric() || matches!(c, 'µ' | 'μ' | 'λ');
    field.to_lowercase().split(|c: char| !letter(c)).filter(|word| !word.is_empty()).map(str::to_owned).collect()
}

fn role(field: &str) -> Role {
    let words = words(field);
    match words.first().map(String::as_str) {
        Some("wl" | "wavelength" | "wavelengths" | "lambda" | "λ" | "wvl" | "wave") => Role::Wavelength,
        Some(word) if Unit::parse(word).is_some() => Role::Wavelength,
        Some("n" | "refractive" | "index" | "ri" | "ref") => Role::Part(IndexPart::N),
        Some("k" | "kappa" | "κ" | "extinction" | "ext") => Role::Part(IndexPart::K),
        _ => Role::Other,
    }
}

fn unit_in(field: &str) -> Option<Unit> {
    words(field).iter().find_map(|word| Unit::parse(word))
}

/// Whether a column holds photon energies, wavenumbers, frequencies or ångströms in place of wavelengths.
fn is_no_wavelength(field: &str) -> bool {
    let words = words(field);
    let known = ["ev", "energy", "wavenumber", "cm", "thz", "frequency", "å", "angstrom", "angstroms"];
    words.iter().any(|word| known.contains(&word.as_str()))
}

/// Parses a number with a decimal point or a decimal comma.
fn number(field: &str) -> Option<f64> {
    let field = field.trim();
    let comma = field.matches(',').count() == 1 && !field.contains('.');
    if comma { field.replace(',', ".").parse().ok() } else { field.parse().ok() }
}

/// Character that separates columns; `None` for blanks.
fn delimiter(text: &str) -> Option<u8> {
    let is_row = |line: &&str| line.starts_with(|c: char| c.is_ascii_digit() || matches!(c, '.' | '-' | '+' | '"'));
    let first = text.lines().map(str::trim).find(is_row).unwrap_or_default();
    // In "0,4 1,5" commas stand within numbers, in "0.4, 1.5" and "0.4,1.5" between them.
    let apart = first.split_whitespace().any(|word| word.ends_with(','));
    let within = first.split_whitespace().count() > 1 && first.split_whitespace().all(|word| number(word).is_some());
    match () {
        () if first.contains(';') => Some(b';'),
        () if first.contains('\t') => Some(b'\t'),
        () if first.contains(',') && (apart || !within) => Some(b','),
        () => None,
    }
}

/// Number and fields of every line that is not skipped.
fn lines(source: &SourceText<'_>) -> Result<Vec<(usize, Vec<String>)>> {
    let passed = |line: &str| line.is_empty() || ["#", "%", "!", "//"].iter().any(|mark| line.starts_with(mark));
    let numbered = source.text.lines().map(str::trim).zip(1..).filter(|(line, _)| !passed(line));
    let Some(delimiter) = delimiter(source.text) else {
        // Names of columns may hold blanks, numbers do not.
        let fields = |line: &str| line.split_whitespace().map(str::to_owned).collect();
        return Ok(numbered.map(|(line, number)| (number, fields(line))).collect());
    };
    let mut reader = csv::ReaderBuilder::new();
    reader.delimiter(delimiter).has_headers(false).flexible(true).trim(csv::Trim::All);
    let mut found = Vec::new();
    for (line, number) in numbered {
        for record in reader.from_reader(line.as_bytes()).records() {
            let record = record.map_err(|error| source.refuse_line(number, error))?;
            let mut fields: Vec<String> = record.iter().map(str::to_owned).collect();
            while fields.len() > 1 && fields.last().is_some_and(String::is_empty) {
                fields.pop(); // a delimiter at the end of the line
            }
            found.push((number, fields));
        }
    }
    Ok(found)
}

/// Refuses columns whose commas may be decimal: "400,1,5" may be two numbers or three.
fn refuse_decimal_commas(source: &SourceText<'_>, lines: &[(usize, Vec<String>)]) -> Result<()> {
    if delimiter(source.text) != Some(b',') {
        return Ok(());
    }
    let rows = lines.iter().filter(|(_, fields)| number(&fields[0]).is_some());
    let whole = |field: &String| field.chars().all(|c| c.is_ascii_digit());
    let Some((line, fields)) = rows.clone().next() else { return Ok(()) };
    if fields.len() > 2 && rows.clone().all(|(_, fields)| fields.iter().all(whole)) {
        let message = "no number has a decimal point; if they have decimal commas, set the columns apart by semicolons";
        return Err(source.refuse_line(*line, message));
    }
    Ok(())
}

#[cfg(test)]
#[path = "delimited_tests.rs"]
mod tests;
