//! n and k in the YAML format of refractiveindex.info.
//!
//! Read are the entries of `DATA`: `formula 1` to `formula 9` with `coefficients` and `wavelength_range` (`range` in older
//! files), `tabulated nk`, `tabulated n` and `tabulated k`; wavelengths in micrometres. One extension: `exponential k`
//! with two coefficients, k = c₁ exp(−λ/c₂), c₂ in micrometres (melanin).

use goniochrome::medium::{Extrapolate, Formula};

use super::medium::{OwnedDispersion, OwnedMedium};
use super::source::Source;
use super::yaml::{self, Node, Value};
use crate::error::Result;

/// Metals in the far infrared reach n and k of some thousand; beyond this a number is a slip, and its square a danger.
pub(super) const MAX_INDEX: f64 = 1e6;

const TYPES: &str = "formula 1 to 9, tabulated nk, tabulated n, tabulated k, exponential k";

/// The medium that a file describes.
pub(super) fn parse(source: &Source<'_>, extrapolate: Extrapolate) -> Result<OwnedMedium> {
    let root = yaml::parse(source)?;
    let data = root.get("DATA").ok_or_else(|| {
        source.refuse_line(root.line, "no DATA; expected a file in the format of refractiveindex.info")
    })?;
    let Value::List(entries) = &data.value else {
        return Err(source.refuse_line(data.line, "DATA must be a list of entries, each with a type"));
    };
    let (mut n, mut k) = (None, None);
    for entry in entries {
        let set = |slot: &mut Option<OwnedDispersion>, name: &str, value| match slot.replace(value) {
            None => Ok(()),
            Some(_) => Err(source.refuse_line(entry.line, format_args!("{name} is given twice"))),
        };
        match kind(source, entry)? {
            Kind::Table(columns) => {
                for (name, table) in columns.iter().zip(table(source, entry, columns)?) {
                    set(if *name == "n" { &mut n } else { &mut k }, name, table)?;
                }
            }
            Kind::Formula(Formula::Exponential) => set(&mut k, "k", formula(source, entry, Formula::Exponential)?)?,
            Kind::Formula(which) => set(&mut n, "n", formula(source, entry, which)?)?,
        }
    }
    let n = n.ok_or_else(|| source.refuse_line(data.line, "no data for n; add a formula or a table of n"))?;
    let k = k.unwrap_or(OwnedDispersion::Constant(0.0));
    let ([n0, n1], [k0, k1]) = (n.borrow().range_nm(), k.borrow().range_nm());
    if n0.max(k0) > n1.min(k1) {
        let ranges = format!("n covers {n0} to {n1} nm but k covers {k0} to {k1} nm; they must overlap");
        return Err(source.refuse_line(data.line, ranges));
    }
    OwnedMedium::new(n, k, extrapolate).map_err(|error| source.refuse_line(data.line, error))
}

enum Kind {
    Formula(Formula),
    /// The columns after the wavelength.
    Table(&'static [&'static str]),
}

fn kind(source: &Source<'_>, entry: &Node) -> Result<Kind> {
    let node = field(source, entry, &["type"])?;
    let text = node.text().unwrap_or_default();
    let words: Vec<&str> = text.split_whitespace().collect();
    match words[..] {
        ["tabulated", "nk"] => return Ok(Kind::Table(&["n", "k"])),
        ["tabulated", "n"] => return Ok(Kind::Table(&["n"])),
        ["tabulated", "k"] => return Ok(Kind::Table(&["k"])),
        ["exponential", "k"] => return Ok(Kind::Formula(Formula::Exponential)),
        ["formula", number] => {
            if let Some(formula) = number.parse().ok().and_then(Formula::from_number) {
                return Ok(Kind::Formula(formula));
            }
        }
        _ => {}
    }
    Err(source.refuse_line(node.line, format_args!("unknown type {text:?} (known: {TYPES})")))
}

/// The value of an entry's first key among `names`.
fn field<'a>(source: &Source<'_>, entry: &'a Node, names: &[&str]) -> Result<&'a Node> {
    names
        .iter()
        .find_map(|name| entry.get(name))
        .ok_or_else(|| source.refuse_line(entry.line, format_args!("this DATA entry has no {}", names[0])))
}

fn numbers(source: &Source<'_>, line: usize, text: &str) -> Result<Vec<f64>> {
    let number = |word: &str| match word.parse::<f64>() {
        Ok(x) if x.is_finite() => Ok(x),
        _ => Err(source.refuse_line(line, format_args!("{word:?} is not a finite number"))),
    };
    text.split_whitespace().map(number).collect()
}

fn formula(source: &Source<'_>, entry: &Node, formula: Formula) -> Result<OwnedDispersion> {
    let list = |names: &[&str]| {
        let node = field(source, entry, names)?;
        Ok((node.line, numbers(source, node.line, node.text().unwrap_or_default())?))
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

/// The columns of a table, each with the wavelengths.
fn table(source: &Source<'_>, entry: &Node, columns: &[&str]) -> Result<Vec<OwnedDispersion>> {
    let data = field(source, entry, &["data"])?;
    let Value::Scalar { text, block: true } = &data.value else {
        return Err(source.refuse_line(data.line, "data must be a literal block: `data: |`, then one row a line"));
    };
    let mut wavelength_nm: Vec<f64> = Vec::new();
    let mut values = vec![Vec::new(); columns.len()];
    for (index, row) in text.lines().enumerate() {
        let refuse = |message: String| source.refuse_line(data.line + index, message);
        let numbers = numbers(source, data.line + index, row)?;
        let Some((&um, rest)) = numbers.split_first() else { continue };
        if rest.len() != columns.len() {
            let names = columns.join(", ");
            let (expected, found) = (columns.len() + 1, numbers.len());
            return Err(refuse(format!("the row needs {expected} numbers (wavelength, {names}) but has {found}")));
        }
        let nm = nanometres(um);
        if um <= 0.0 || wavelength_nm.last().is_some_and(|&last| last >= nm) {
            return Err(refuse(format!("wavelength {um}: wavelengths must be positive and increase from row to row")));
        }
        wavelength_nm.push(nm);
        for ((&name, &value), column) in columns.iter().zip(rest).zip(&mut values) {
            match name {
                "n" if value <= 0.0 => return Err(refuse(format!("n = {value}; n must be positive"))),
                "k" if value < 0.0 => return Err(refuse(format!("k = {value} is gain; k must not be negative"))),
                _ if value > MAX_INDEX => return Err(refuse(format!("{name} = {value} is more than {MAX_INDEX}"))),
                _ => column.push(value),
            }
        }
    }
    if wavelength_nm.is_empty() {
        return Err(source.refuse_line(data.line, "the table has no rows"));
    }
    let table = |value| OwnedDispersion::Table { wavelength_nm: wavelength_nm.clone(), value };
    Ok(values.into_iter().map(table).collect())
}

/// Rounded to 1e-9 nm, so that 0.555 µm is 555 nm and not its neighbour.
fn nanometres(um: f64) -> f64 {
    let nm = um * 1e3;
    let rounded = (nm * 1e9).round() / 1e9;
    if rounded.is_finite() && rounded > 0.0 { rounded } else { nm }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::Error;

    fn read(text: &str) -> std::result::Result<OwnedMedium, Error> {
        parse(&Source { label: "f.yml", text }, Extrapolate::Refuse)
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
        assert_eq!(second("0.6 l.5 0"), "f.yml:5: \"l.5\" is not a finite number");
        assert_eq!(second("0.6 NaN 0"), "f.yml:5: \"NaN\" is not a finite number");
        assert_eq!(second("0.6 1.5 1e999"), "f.yml:5: \"1e999\" is not a finite number");
        assert_eq!(
            second("0.5 1.5 0"),
            "f.yml:5: wavelength 0.5: wavelengths must be positive and increase from row to row"
        );
        assert_eq!(second("0.6 1.5 -0.1"), "f.yml:5: k = -0.1 is gain; k must not be negative");
        assert_eq!(second("0.6 0 0.1"), "f.yml:5: n = 0; n must be positive");
        assert_eq!(second("0.6 1e7 0.1"), "f.yml:5: n = 10000000 is more than 1000000");
        assert_eq!(second("\n        0.6 1.5"), "f.yml:6: the row needs 3 numbers (wavelength, n, k) but has 2");
        assert_eq!(
            refusal(&table("        -0.5 1.5 0\n")),
            "f.yml:4: wavelength -0.5: wavelengths must be positive and increase from row to row"
        );
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
        assert!(formula("formula 5", "0.4 0.8", "-1").contains("f.yml:2: n = -1, k = 0 at 400 nm is not passive"));
        assert!(formula("exponential k", "0.4 0.8", "1 0.3").contains("f.yml:2: no data for n"));
        assert_eq!(
            refusal("DATA:\n  - type: formula 5\n    range: 0.4 0.8\n"),
            "f.yml:2: this DATA entry has no coefficients"
        );
        assert_eq!(refusal("DATA: 5\n"), "f.yml:1: DATA must be a list of entries, each with a type");
        assert!(refusal("x: 5\n").contains("f.yml:1: no DATA"));
        assert_eq!(refusal(&table("        # none\n")), "f.yml:4: \"#\" is not a finite number");
        assert!(
            refusal("DATA:\n  - type: tabulated n\n    data: 0.5 1.5\n")
                .contains("f.yml:3: data must be a literal block")
        );
        let twice = format!("{}  - type: tabulated n\n    data: |\n        0.5 1.5\n", table("        0.5 1.5 0\n"));
        assert_eq!(refusal(&twice), "f.yml:5: n is given twice");
        let apart = "DATA:\n  - type: tabulated n\n    data: |\n        0.4 1.5\n        0.5 1.5\n  - type: tabulated k\n    data: |\n        0.6 0\n        0.7 0\n";
        assert_eq!(refusal(apart), "f.yml:2: n covers 400 to 500 nm but k covers 600 to 700 nm; they must overlap");
    }
}
