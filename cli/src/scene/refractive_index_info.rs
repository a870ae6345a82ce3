//! n and k in the YAML format of refractiveindex.info.
//!
//! The reader takes the entries of `DATA`: `formula 1` to `formula 9` with `coefficients` and `wavelength_range`
//! (`range` in older files), `tabulated nk`, `tabulated n` and `tabulated k`. Wavelengths are in micrometres. One type
//! is an extension: `exponential k` with two coefficients, k = c₁ exp(−λ/c₂), c₂ in micrometres (melanin).

use goniochrome::optics::medium::{Extrapolate, Formula, IndexPart};

use super::column::{Column, Notes, Row, column};
use super::diagnostics::SourceText;
use super::dispersion::OwnedDispersion;
use super::medium::OwnedMedium;
use super::yaml::{self, Node, Value};
use crate::support::error::Result;

/// Known types of entries, for messages.
const TYPES: &str = "formula 1 to 9, tabulated nk, tabulated n, tabulated k, exponential k";

/// Reads the medium that a file describes.
pub(super) fn parse(source: &SourceText<'_>, extrapolate: Extrapolate) -> Result<OwnedMedium> {
    let root = yaml::parse(source)?;
    let data = root.get("DATA").ok_or_else(|| {
        source.refuse_line(root.line, "no DATA; expected a file in the format of refractiveindex.info")
    })?;
    let Value::List(entries) = &data.value else {
        return Err(source.refuse_line(data.line, "DATA must be a list of entries, each with a type"));
    };
    let (mut n, mut k) = (None, None);
    for entry in entries {
        let mut set = |part, value| {
            let slot = if part == IndexPart::N { &mut n } else { &mut k };
            match slot.replace(value) {
                None => Ok(()),
                Some(_) => Err(source.refuse_line(entry.line, format_args!("{part} is given twice"))),
            }
        };
        match kind(source, entry)? {
            EntryKind::Table(parts) => {
                for (&part, column) in parts.iter().zip(table(source, entry, parts)?) {
                    set(part, column)?;
                }
            }
            EntryKind::Formula(part, which) => {
                set(part, Column { dispersion: formula(source, entry, which)?, notes: Notes::default() })?;
            }
        }
    }
    let n = n.ok_or_else(|| source.refuse_line(data.line, "no data for n; add a formula or a table of n"))?;
    medium(source, data.line, n, k, extrapolate)
}

/// Builds a medium from a column of n and one of k; without k it does not absorb.
pub(super) fn medium(
    source: &SourceText<'_>,
    line: usize,
    n: Column,
    k: Option<Column>,
    extrapolate: Extrapolate,
) -> Result<OwnedMedium> {
    let k = k.unwrap_or(Column { dispersion: OwnedDispersion::Constant(0.0), notes: Notes::default() });
    let ([n0, n1], [k0, k1]) = (n.dispersion.borrow().range_nm(), k.dispersion.borrow().range_nm());
    if n0.max(k0) > n1.min(k1) && extrapolate == Extrapolate::Refuse {
        let ranges = format!(
            "n covers {n0} to {n1} nm but k covers {k0} to {k1} nm, so that nowhere both are known; extend one, or set \
             extrapolate = \"clamp\" in the scene to hold the ends of each"
        );
        return Err(source.refuse_line(line, ranges));
    }
    let medium = OwnedMedium::new(n.dispersion, k.dispersion, extrapolate);
    Ok(medium.map_err(|error| source.refuse_line(line, error))?.with_notes(n.notes, k.notes))
}

/// Type of an entry.
enum EntryKind {
    Formula(IndexPart, Formula),
    /// Columns after the wavelength.
    Table(&'static [IndexPart]),
}

fn kind(source: &SourceText<'_>, entry: &Node) -> Result<EntryKind> {
    let node = field(source, entry, &["type"])?;
    let text = node.text().unwrap_or_default();
    let words: Vec<&str> = text.split_whitespace().collect();
    match words[..] {
        ["tabulated", "nk"] => return Ok(EntryKind::Table(&[IndexPart::N, IndexPart::K])),
        ["tabulated", "n"] => return Ok(EntryKind::Table(&[IndexPart::N])),
        ["tabulated", "k"] => return Ok(EntryKind::Table(&[IndexPart::K])),
        ["exponential", "k"] => return Ok(EntryKind::Formula(IndexPart::K, Formula::Exponential)),
        ["formula", number] => {
            if let Some(formula) = number.parse().ok().and_then(Formula::from_number) {
                return Ok(EntryKind::Formula(IndexPart::N, formula));
            }
        }
        _ => {}
    }
    Err(source.refuse_line(node.line, format_args!("unknown type {text:?} (known: {TYPES})")))
}

/// Value of an entry's first key among `names`.
fn field<'a>(source: &SourceText<'_>, entry: &'a Node, names: &[&str]) -> Result<&'a Node> {
    names
        .iter()
        .find_map(|name| entry.get(name))
        .ok_or_else(|| source.refuse_line(entry.line, format_args!("this DATA entry has no {}", names[0])))
}

/// Parses numbers, finite or not.
fn numbers(source: &SourceText<'_>, line: usize, text: &str) -> Result<Vec<f64>> {
    let number = |word: &str| {
        word.parse::<f64>().map_err(|_| source.refuse_line(line, format_args!("{word:?} is not a number")))
    };
    text.split_whitespace().map(number).collect()
}

fn formula(source: &SourceText<'_>, entry: &Node, formula: Formula) -> Result<OwnedDispersion> {
    let list = |names: &[&str]| {
        let node = field(source, entry, names)?;
        let numbers = numbers(source, node.line, node.text().unwrap_or_default())?;
        match numbers.iter().find(|x| !x.is_finite()) {
            Some(x) => Err(source.refuse_line(node.line, format_args!("{x} is not a finite number"))),
            None => Ok((node.line, numbers)),
        }
    };
    let (line, range) = list(&["wavelength_range", "range"])?;
    let range_nm = match range[..] {
        [from, to] if from > 0.0 && from <= to => [nanometres(from), nanometres(to)],
        _ => return Err(source.refuse_line(line, "wavelength_range must be two positive numbers, the smaller first")),
    };
    let (line, coefficients) = list(&["coefficients"])?;
    let count = coefficients.len();
    // Sums take their coefficients in pairs after the first one; a half pair would be dropped silently.
    let (fits, expected) = match formula {
        Formula::Herzberger => ((1..=6).contains(&count), "1 to 6"),
        Formula::Retro => ((1..=4).contains(&count), "1 to 4"),
        Formula::Exotic => ((1..=6).contains(&count), "1 to 6"),
        Formula::Exponential => (count == 2, "2"),
        Formula::RefractiveIndexInfo => {
            ((1..=9).contains(&count) || count % 2 == 1, "1 to 9, or a larger odd number of")
        }
        _ => (count % 2 == 1, "an odd number of"),
    };
    if !fits {
        let message = format_args!("{count} coefficients; this type takes {expected} coefficients").to_string();
        return Err(source.refuse_line(line, message));
    }
    if formula == Formula::Exponential && !(coefficients[0] >= 0.0 && coefficients[1] > 0.0) {
        return Err(source.refuse_line(line, "exponential k takes c1 >= 0 (k < 0 is gain) and c2 > 0"));
    }
    Ok(OwnedDispersion::Formula { formula, coefficients, range_nm })
}

/// Reads the columns of a table.
fn table(source: &SourceText<'_>, entry: &Node, parts: &[IndexPart]) -> Result<Vec<Column>> {
    let data = field(source, entry, &["data"])?;
    let Value::Scalar { text, block: true } = &data.value else {
        return Err(source.refuse_line(data.line, "data must be a literal block: `data: |`, then one row a line"));
    };
    let mut rows = vec![Vec::new(); parts.len()];
    for (index, row) in text.lines().enumerate() {
        let line = data.line + index;
        let numbers = numbers(source, line, row)?;
        let Some((&um, values)) = numbers.split_first() else { continue };
        if values.len() != parts.len() {
            let names = parts.iter().map(IndexPart::to_string).collect::<Vec<_>>().join(", ");
            let (expected, found) = (parts.len() + 1, numbers.len());
            let message = format!("the row needs {expected} numbers (wavelength, {names}) but has {found}");
            return Err(source.refuse_line(line, message));
        }
        if !(um > 0.0 && um.is_finite()) {
            return Err(source.refuse_line(line, format_args!("wavelength {um}: wavelengths must be positive")));
        }
        for (rows, &value) in rows.iter_mut().zip(values) {
            rows.push(Row { line, wavelength_nm: nanometres(um), value });
        }
    }
    if rows.iter().all(Vec::is_empty) {
        return Err(source.refuse_line(data.line, "the table has no rows"));
    }
    parts.iter().zip(rows).map(|(&part, rows)| column(source, part, rows)).collect()
}

/// Converts micrometres to nanometres, rounded to 1e-9 nm: 0.555 µm is 555 nm, not the next number.
pub(super) fn nanometres(um: f64) -> f64 {
    let nm = um * 1e3;
    let rounded = (nm * 1e9).round() / 1e9;
    if rounded.is_finite() && rounded > 0.0 { rounded } else { nm }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::support::error::Error;

    fn read(text: &str) -> std::result::Result<OwnedMedium, Error> {
        parse(&SourceText { label: "f.yml", text }, Extrapolate::Refuse)
    }

    fn refusal(text: &str) -> String {
        read(text).unwrap_err().to_string()
    }

    fn table(rows: &str) -> String {
        format!("DATA:\n  - type: tabulated nk\n    data: |\n{rows}")
    }

    #[test]
    fn each_type_is_read() {
        let eta = |text: &str| read(text).unwrap().borrow().eta(555.0).unwrap();
        let nk = eta(&table("        0.55 1.5 0.1\n        0.56 1.7 0.3\n"));
        assert!((nk.re - 1.6).abs() < 1e-12 && (nk.im - 0.2).abs() < 1e-12);
        let both = "DATA:\n- type: tabulated n\n  data: |\n    0.5 2\n    0.6 2\n- type: tabulated k\n  data: |\n    0.5 1\n    0.6 1\n";
        assert!((eta(both).re - 2.0).abs() < 1e-12 && (eta(both).im - 1.0).abs() < 1e-12);
        let old = "DATA:\n  - type: formula 5\n    range: 0.5 0.6\n    coefficients: 1.5 0.01 -2\n";
        assert!((eta(old).re - (1.5 + 0.01 / 0.555f64.powi(2))).abs() < 1e-12);
        let melanin =
            format!("{old}  - type: exponential k\n    wavelength_range: 0.5 0.6\n    coefficients: 0.56 0.27\n");
        assert!((eta(&melanin).im - 0.56 * (-0.555f64 / 0.27).exp()).abs() < 1e-12);
    }

    #[test]
    fn rows_at_fault_are_named_by_their_line() {
        let second = |row: &str| refusal(&table(&format!("        0.5 1.5 0\n        {row}\n        0.7 1.5 0\n")));
        assert_eq!(second("0.6 1.5"), "f.yml:5: the row needs 3 numbers (wavelength, n, k) but has 2");
        assert_eq!(second("0.6 1.5 0 0"), "f.yml:5: the row needs 3 numbers (wavelength, n, k) but has 4");
        assert_eq!(second("0.6 l.5 0"), "f.yml:5: \"l.5\" is not a number");
        assert_eq!(second("NaN 1.5 0"), "f.yml:5: wavelength NaN: wavelengths must be positive");
        assert_eq!(second("\n        0.6 1.5"), "f.yml:6: the row needs 3 numbers (wavelength, n, k) but has 2");
        assert_eq!(refusal(&table("        -0.5 1.5 0\n")), "f.yml:4: wavelength -0.5: wavelengths must be positive");
    }

    /// η at a wavelength, or the message, of a file of three rows of which the second is given.
    fn eta_or_message(row: &str, nm: f64) -> String {
        let medium = read(&table(&format!("        0.5 1.5 0\n        {row}\n        0.7 1.5 0\n        0.8 1.5 0\n")));
        let medium = medium.unwrap();
        medium.borrow().eta(nm).map_or_else(|error| medium.describe(&error), |eta| eta.to_string())
    }

    #[test]
    fn an_unusable_row_fails_only_at_its_wavelengths() {
        for (row, between, reason) in [
            ("0.6 NaN 0", "n is not known at 600 nm (between 500 and 700 nm)", "f.yml:5: n is no finite number"),
            ("0.6 1.5 1e999", "k is not known at 600 nm (between 500 and 700 nm)", "f.yml:5: k is no finite number"),
            ("0.6 1.5 -0.1", "k is not known at 600 nm (between 500 and 700 nm)", "f.yml:5: k = -0.1 is gain"),
            ("0.6 0 0.1", "n is not known at 600 nm (between 500 and 700 nm)", "f.yml:5: n = 0; n must be positive"),
            ("0.6 1e7 0.1", "n is not known at 600 nm (between 500 and 700 nm)", "f.yml:5: n = 10000000 is more than"),
            (
                "0.7 1.6 0",
                "n is not known at 600 nm (between 500 and 800 nm)",
                "f.yml:6: 700 nm stands twice, with n = 1.6",
            ),
            (
                "0.75 1.6 0",
                "n is not known at 600 nm (between 500 and 800 nm)",
                "f.yml:6: the row of 700 nm stands after",
            ),
        ] {
            let refused = eta_or_message(row, 600.0);
            assert!(refused.starts_with(between) && refused.contains(reason), "{row}: {refused}");
            assert_eq!(eta_or_message(row, 800.0), "1.5+0i", "{row}");
        }
        assert_eq!(eta_or_message("0.5 1.5 0", 600.0), "1.5+0i");
        assert_eq!(eta_or_message("0.6 1.5 -6e-19", 600.0), "1.5+0i");
    }

    #[test]
    fn which_of_n_and_k_is_missing_is_said() {
        let text = "DATA:\n  - type: tabulated n\n    data: |\n        0.4 1.5\n        0.8 1.5\n  - type: tabulated k\n    data: |\n        0.4 0\n        0.6 0\n";
        let medium = read(text).unwrap();
        let refused = medium.describe(&medium.borrow().eta(780.0).unwrap_err());
        assert_eq!(refused, "no data for k at 780 nm (k covers 400 to 600 nm, n 400 to 800 nm)");
        let clamped = parse(&SourceText { label: "f.yml", text }, Extrapolate::Clamp).unwrap();
        assert!(clamped.borrow().eta(780.0).is_ok());
    }

    #[test]
    fn k_below_zero_by_rounding_is_remarked_where_it_counts() {
        let rows = "        0.4 1.5 0\n        0.5 1.5 -1e-9\n        0.6 1.5 0\n        0.7 1.5 0\n";
        let medium = read(&table(rows)).unwrap();
        let said = medium.note(&[380.0, 550.0]).unwrap();
        assert!(said.contains("k at 500 nm lies just below 0"), "{said}");
        assert_eq!(medium.note(&[600.0, 650.0]), None);
    }

    #[test]
    fn entries_at_fault_are_named_by_their_line() {
        let formula = |kind: &str, range: &str, c: &str| {
            refusal(&format!("DATA:\n  - type: {kind}\n    wavelength_range: {range}\n    coefficients: {c}\n"))
        };
        assert_eq!(
            formula("formula 10", "0.4 0.8", "1"),
            format!("f.yml:2: unknown type \"formula 10\" (known: {TYPES})")
        );
        assert!(
            formula("formula 2", "0.8 0.4", "0").contains("f.yml:3: wavelength_range must be two positive numbers")
        );
        assert!(
            formula("formula 2", "0.4 0.8", "0 1").contains("f.yml:4: 2 coefficients; this type takes an odd number")
        );
        assert!(formula("exponential k", "0.4 0.8", "-1 0.3").contains("f.yml:4: exponential k takes c1 >= 0"));
        assert!(formula("formula 5", "0.4 0.8", "inf").contains("f.yml:4: inf is not a finite number"));
        assert!(formula("exponential k", "0.4 0.8", "1 0.3").contains("f.yml:2: no data for n"));
        assert_eq!(
            refusal("DATA:\n  - type: formula 5\n    range: 0.4 0.8\n"),
            "f.yml:2: this DATA entry has no coefficients"
        );
        assert_eq!(refusal("DATA: 5\n"), "f.yml:1: DATA must be a list of entries, each with a type");
        assert!(refusal("x: 5\n").contains("f.yml:1: no DATA"));
        assert_eq!(refusal(&table("        # none\n")), "f.yml:4: \"#\" is not a number");
        assert!(
            refusal("DATA:\n  - type: tabulated n\n    data: 0.5 1.5\n")
                .contains("f.yml:3: data must be a literal block")
        );
        let twice = format!("{}  - type: tabulated n\n    data: |\n        0.5 1.5\n", table("        0.5 1.5 0\n"));
        assert_eq!(refusal(&twice), "f.yml:5: n is given twice");
        let apart = "DATA:\n  - type: tabulated n\n    data: |\n        0.4 1.5\n        0.5 1.5\n  - type: tabulated k\n    data: |\n        0.6 0\n        0.7 0\n";
        let refused = refusal(apart);
        assert!(refused.starts_with("f.yml:2: n covers 400 to 500 nm but k covers 600 to 700 nm, so"), "{refused}");
        let clamped = parse(&SourceText { label: "f.yml", text: apart }, Extrapolate::Clamp).unwrap();
        assert_eq!(clamped.borrow().eta(550.0).unwrap(), 1.5.into());
    }
}
