//! `--method hits`: closed loops replace sums that diverge or ring for too long, and every command says for how many
//! samples.

use std::fmt::Write;

use goniochrome::optics::interface::Model;
use goniochrome_cli::scene::parse;
use goniochrome_cli::solve::planar_scene::PlanarScene;
use goniochrome_cli::solve::precision::Precision;
use goniochrome_cli::solve::spectra::{Method, Sample, SpectraRequest, spectra};
use goniochrome_cli::table::Table;
use goniochrome_cli::table::file::read;

use crate::random::Random;
use crate::user::{User, column};

/// Two metal films as thin as their plasmons couple.
const SANDWICH: &str = "[stack]\nambient = 1.0\nsubstrate = 1.5\nlayers = [\n\
    { material = [0.2, 3.4], thickness_nm = 3.0 },\n\
    { material = 1.5, thickness_nm = 10.0 },\n\
    { material = [0.2, 3.4], thickness_nm = 3.0 }]\n";
/// A film at whose critical angle of 30° a loop keeps all but 1e-8 of its light.
const CRITICAL: &str = "[stack]\nambient = 2.0\nlayers = [{ material = 1.0, thickness_nm = 100.0 }]\nsubstrate = 2.0\n";
/// Two gaps that light tunnels through, around a film that holds it.
const GAPS: &str = "[stack]\nambient = 1.5\nsubstrate = 1.5\nlayers = [\n\
    { material = 1.0, thickness_nm = 200.0 },\n\
    { material = 1.6, thickness_nm = 300.0 },\n\
    { material = 1.0, thickness_nm = 200.0 }]\n";

/// Half of the last digit of values that an independent transfer-matrix program prints with four decimals.
const FOUR_DECIMALS: f64 = 5e-5;

#[test]
fn sums_that_diverge_or_ring_too_long_fall_back_to_closed_loops() {
    let user = User::with(&[("sandwich.toml", SANDWICH), ("critical.toml", CRITICAL), ("gaps.toml", GAPS)]);
    for (line, wanted) in [
        ("sandwich.toml --wavelengths 550", &[("R_s", 0.1408), ("R_p", 0.1408)][..]),
        ("critical.toml --theta 30 --wavelengths 633", &[("T_s", 0.5751), ("T_p", 0.9559)]),
        ("gaps.toml --theta 43 --wavelengths 550", &[("R_p", 0.0378)]),
    ] {
        let ran = user.ok(&format!("spectrum {line} --method hits --precision f64"));
        assert!(ran.stderr.contains("1 of 1 samples do not converge hit by hit"), "{line}: {}", ran.stderr);
        for (name, value) in wanted {
            let found = column(&ran.stdout, name)[0];
            assert!((found - value).abs() <= FOUR_DECIMALS, "{line}: {name} = {found}");
        }
        let closed = user.ok(&format!("spectrum {line} --method trace --precision f64"));
        assert_eq!(ran.stdout, closed.stdout, "{line}");
        assert_eq!(closed.stderr, "", "{line}");
    }
}

#[test]
fn every_command_says_how_many_samples_fell_back() {
    let user = User::with(&[("sandwich.toml", SANDWICH)]);
    let said = |line: &str| {
        let stderr = user.ok(line).stderr;
        let line = stderr.lines().find(|line| line.contains("do not converge hit by hit"));
        line.unwrap_or_else(|| panic!("{stderr:?}")).to_owned()
    };
    for command in ["spectrum", "colour", "compare", "sampling"] {
        let hits = format!("{command} sandwich.toml --theta 0,40 --csv {command}.csv --method hits");
        let trace = format!("{command} sandwich.toml --theta 0,40 --csv trace.csv --method trace");
        assert!(said(&hits).contains("as by --method trace"), "{command}");
        assert_eq!(user.ok(&format!("{hits} --quiet")).stderr, "", "{command}");
        user.ok(&trace);
        let [hits, trace] = [format!("{command}.csv"), "trace.csv".into()].map(|name| user.read(&name));
        assert!(hits == trace, "{command}");
    }
    let samples = 4 * 81;
    assert!(
        said("estimate sandwich.toml -o t.exr --angles 4 --method hits")
            .starts_with(&format!("{samples} of {samples} "))
    );
    let Table::Mirror(table) = read(&user.at("t.exr")).unwrap() else { panic!("a planar scene") };
    assert_eq!(table.metadata.get("fell_back"), Some(samples.to_string().as_str()));
    // The paper's films converge, at every angle of its figure 7 too.
    let ran = user.ok("compare paper-fig4 --theta 80:89:1 --precision f64 --method hits");
    assert!(!ran.stderr.contains("converge"), "{}", ran.stderr);
    let ran = user.ok("estimate paper-fig3 -o t.exr --angles 4 --method hits");
    assert!(!ran.stderr.contains("converge"), "{}", ran.stderr);
    let Table::Mirror(table) = read(&user.at("t.exr")).unwrap() else { panic!("a planar scene") };
    assert_eq!(table.metadata.get("fell_back"), Some("0"));
}

/// A random passive stack of up to six films, and an angle of incidence in degrees. A third of the media absorb. Where
/// a medium is optically thinner than the ambient one, the light comes at its critical angle in a third of the cases.
fn any_stack(random: &mut Random) -> (String, f64) {
    let ambient = random.between(1.0, 4.0);
    let mut rarer = None;
    let mut medium = |random: &mut Random| {
        let (n, k) = (random.between(1.0, 4.0), random.between(-10.0, 5.0).max(0.0));
        if k == 0.0 && n < ambient {
            rarer.get_or_insert(n);
        }
        format!("[{n}, {k}]")
    };
    let mut layers = String::new();
    for _ in 0..random.between(0.0, 7.0) as u32 {
        let film = medium(random);
        writeln!(layers, "{{ material = {film}, thickness_nm = {} }},", random.between(1.0, 1000.0)).unwrap();
    }
    let substrate = medium(random);
    let critical =
        rarer.filter(|_| random.between(0.0, 1.0) < 1.0 / 3.0).map(|n: f64| (n / ambient).asin().to_degrees());
    let theta_deg = critical.unwrap_or_else(|| random.between(0.0, 89.0));
    (format!("[stack]\nambient = {ambient}\nsubstrate = {substrate}\nlayers = [\n{layers}]\n"), theta_deg)
}

const STACKS: usize = 300;
/// Allowed error of a sample besides ten times its error bar.
const BESIDES: f64 = 1e-5;

/// The largest difference of two samples beyond ten times the error bar of the first.
fn beyond(found: &Sample, wanted: &Sample) -> f64 {
    let pairs = [
        (found.reflectance.s, wanted.reflectance.s),
        (found.reflectance.p, wanted.reflectance.p),
        (found.transmittance.s, wanted.transmittance.s),
        (found.transmittance.p, wanted.transmittance.p),
    ];
    pairs.into_iter().fold(0.0, |worst: f64, (a, b)| worst.max((a - b).abs())) - 10.0 * found.truncated
}

#[test]
fn no_sample_of_300_random_stacks_is_further_off_than_it_says() {
    let mut random = Random(7);
    let wavelength_nm: Vec<f64> = (0..8).map(|i| 380.0 + 57.0 * f64::from(i)).collect();
    let (mut fell_back, mut all) = ([0, 0], 0);
    for _ in 0..STACKS {
        let (scene, theta_deg) = any_stack(&mut random);
        let parsed = parse("random.toml", &scene).unwrap();
        let planar = PlanarScene::new(&parsed).unwrap();
        let run = |method, precision| {
            let request = SpectraRequest { model: Model::Physical, method, precision, threads: 1 };
            spectra(&planar, &[theta_deg], &wavelength_nm, &request, &|| ()).unwrap()
        };
        let closed = run(Method::Stack, Precision::F64);
        all += closed.samples.len();
        for (precision, fell_back) in [Precision::F32, Precision::F64].into_iter().zip(&mut fell_back) {
            // Single precision is compared with its own closed loops, which may be off by more where films resonate.
            let wanted = if precision == Precision::F64 { &closed } else { &run(Method::Trace, precision) };
            let hits = run(Method::Hits, precision);
            for (found, wanted) in hits.samples.iter().zip(&wanted.samples) {
                let off = beyond(found, wanted);
                assert!(off <= BESIDES, "{precision:?}: off by {off:e} at {theta_deg} degrees\n{scene}");
            }
            *fell_back += hits.fell_back;
        }
    }
    println!("{fell_back:?} of {all} samples fell back");
    // The test shows little unless some samples fall back and most do not.
    assert!(fell_back.iter().all(|fell_back| (all / 100..all / 2).contains(fell_back)));
}
