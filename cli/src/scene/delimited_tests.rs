use super::*;

fn read(text: &str) -> Result<OwnedMedium> {
    parse(&SourceText { label: "f.csv", text }, None, Extrapolate::Refuse)
}

fn eta(text: &str, nm: f64) -> (f64, f64) {
    let eta = read(text).unwrap_or_else(|error| panic!("{text:?}: {error}")).borrow().eta(nm);
    let eta = eta.unwrap_or_else(|error| panic!("{text:?}: {error}"));
    (eta.re, eta.im)
}

fn refusal(text: &str) -> String {
    read(text).unwrap_err().to_string()
}

#[test]
fn columns_are_read_however_they_are_set_apart() {
    for text in [
        "400,1.5,0.25\n600,1.75,0.5\n",
        "400, 1.5, 0.25\n600, 1.75, 0.5\n",
        "400;1.5;0.25\r\n600;1.75;0.5\r\n",
        "400;1,5;0,25\n600;1,75;0,5\n",
        "400\t1,5\t0,25\n600\t1,75\t0,5",
        "400 1.5   0.25\n  600 1.75 0.5\n",
        "400,0 1,5 0,25\n600,0 1,75 0,5\n",
        "400,1.5,0.25,\n600,1.75,0.5,\n",
        "\"400\",\"1.5\",\"0.25\"\n\"600\",\"1.75\",\"0.5\"\n",
        "# measured\n% here\n\n400,1.5,0.25\n! more\n// and more\n600,1.75,0.5\n",
        "wavelength (nm),n,k\n400,1.5,0.25\n600,1.75,0.5\n",
        "Wavelength(nm)\tn\tk\n400\t1.5\t0.25\n600\t1.75\t0.5\n",
        "Wavelength, µm;n;k\n0,4;1,5;0,25\n0,6;1,75;0,5\n",
        "wl,n,k\n0.4,1.5,0.25\n0.6,1.75,0.5\n",
        "A film of mine\nk,lambda [um],error,n\n0.25,0.4,-,1.5\n0.5,0.6,-,1.75\n",
        "wl,n\n0.4,1.5\n0.6,1.75\nwl,k\n0.3,0\n0.4,0.25\n0.6,0.5\n",
        "600 1.75 0.5\n400 1.5 0.25\n",
        "4e2 1.5 2.5e-1\n6E+02 1.75 .5\n",
    ] {
        assert_eq!(eta(text, 400.0), (1.5, 0.25), "{text:?}");
        assert_eq!(eta(text, 500.0), (1.625, 0.375), "{text:?}");
    }
    assert_eq!(eta("400,1.5\n600,1.75\n", 600.0), (1.75, 0.0));
}

#[test]
fn the_unit_is_said_or_guessed_with_a_remark() {
    let said = |text: &str| read(text).unwrap().note(&[500.0]);
    assert_eq!(said("wl (nm),n\n400,1.5\n600,1.5\n"), None);
    assert!(said("wl,n\n0.4,1.5\n0.6,1.5\n").unwrap().contains("taken as micrometres"));
    assert!(said("400 1.5\n600 1.5\n").unwrap().contains("taken as nanometres"));
    assert!(refusal("13 0.9 0.1\n40 0.9 0.1\n").contains("add unit = \"nm\" or \"um\""));
    let source = SourceText { label: "f", text: "13 0.9 0.1\n40 0.9 0.1\n" };
    let nm = parse(&source, Some(Unit::Nanometres), Extrapolate::Refuse).unwrap();
    assert_eq!(nm.borrow().range_nm(), [13.0, 40.0]);
    let um = parse(&source, Some(Unit::Micrometres), Extrapolate::Refuse).unwrap();
    assert_eq!(um.borrow().range_nm(), [13_000.0, 40_000.0]);
    assert_eq!(um.note(&[20_000.0]), None);
}

#[test]
fn what_is_no_table_is_refused_by_line() {
    for (text, said) in [
        ("", "f.csv:1: no rows of wavelength and n"),
        ("hello\nworld\n", "f.csv:1: no rows of wavelength and n"),
        ("400\n500\n", "f.csv:1: a row of 1 columns; without a header it is wavelength, n"),
        ("400,1.5,0,7\n", "f.csv:1: a row of 4 columns"),
        ("400,1,5\n410,1,6\n", "f.csv:1: no number has a decimal point; if they have decimal commas"),
        ("400 1.5\n500 l.5\n", "f.csv:2: \"l.5\" is not a number"),
        ("400 1.5\n500 1.5 0.1\n", "f.csv:2: k stands in some rows"),
        ("400 1.5 0.1\n500 1.5\n", "f.csv:2: k stands in some rows"),
        ("wl,n,k\n400,1.5\n", "f.csv:2: the row has 2 columns but its header names 3"),
        ("energy (eV),n\n2.0,1.5\n", "f.csv:1: the column \"energy (eV)\" is no wavelength"),
        ("wl,n\n400,1.5\nwl,n\n500,1.5\n", "f.csv:3: a second table of the same columns"),
        ("wl (nm),n\n400,1.5\nwl (um),k\n0.5,1.5\n", "f.csv:3: another unit than that of the table before"),
        ("wl,n,n\n400,1.5,1.5\n", "f.csv:1: two columns of n"),
        ("400 1.5\nend\n", "f.csv:2: \"end\" is neither a number nor a header"),
        ("-400 1.5\n", "f.csv:1: wavelength -400: wavelengths must be positive"),
        ("wl,k\n400,1.5\n", "f.csv:1: no rows of wavelength and n"),
    ] {
        let refused = refusal(text);
        assert!(refused.starts_with(said), "{text:?}: {refused}");
    }
}

#[test]
fn faults_of_rows_are_those_of_other_tables() {
    let medium = read("400 1.5 0\n500 1.5 0\n500 1.6 0\n600 1.5 0\n700 1.5 0\n").unwrap();
    let refused = medium.describe(&medium.borrow().eta(500.0).unwrap_err());
    assert_eq!(
        refused,
        "n is not known at 500 nm (between 400 and 600 nm): f.csv:3: 500 nm stands twice, with n = 1.5 and 1.6; remove one row"
    );
    assert!(medium.borrow().eta(650.0).is_ok());
}

/// Any bytes are a medium or one line that says why not.
#[test]
fn no_text_brings_the_reader_down() {
    let alphabet =
        ["4", "0", "1", ".", ",", ";", " ", "\t", "\n", "n", "k", "wl", "nm", "-", "e", "\"", "#", "µ", "\r"];
    let mut state = 1u64;
    for _ in 0..20_000 {
        let mut text = String::new();
        for _ in 0..24 {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            text.push_str(alphabet[(state >> 33) as usize % alphabet.len()]);
        }
        match read(&text) {
            Err(error) => assert!(!error.to_string().contains('\n'), "{text:?}: {error}"),
            Ok(medium) => {
                if let Ok(eta) = medium.borrow().eta(400.0) {
                    assert!(eta.re > 0.0 && eta.im >= 0.0 && eta.is_finite(), "{text:?}");
                }
            }
        }
    }
}

#[test]
fn columns_of_other_quantities_are_no_index() {
    for names in ["wavelength (nm),psi,delta", "lambda (nm),eps_r,eps_i", "wavelength (nm),R,T"] {
        let said = refusal(&format!("{names}\n400,30.5,100.2\n800,30.5,100.9\n"));
        assert!(said.contains("name those of the index n and k"), "{names}: {said}");
    }
}
