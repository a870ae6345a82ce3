//! Tests of the error bound of diffraction orders against rigorous efficiencies, s and p separately: whether the
//! program warns or not, it is right.

use std::fmt::Write as _;

use goniochrome_cli::scene::parse;
use goniochrome_cli::solve::diffraction::{OrdersRequest, orders};
use goniochrome_cli::solve::mesh_scene::MeshScene;
use goniochrome_cli::solve::order_error::{MAX_SILENT, error_bounds, warning};
use goniochrome_cli::solve::precision::Precision;
use serde::Deserialize;

use crate::scene::towards;

#[derive(Deserialize)]
struct Table {
    cases: Vec<Case>,
}

/// A grating of `orders.json`, made by `orders.py`.
#[derive(Deserialize)]
#[allow(non_snake_case, reason = "keys of the reference")]
struct Case {
    /// Whether the bound was fitted to this case too.
    fitted: bool,
    points_nm: Vec<[f64; 2]>,
    eta: [f64; 2],
    wavelength_nm: f64,
    theta_deg: f64,
    phi_deg: f64,
    /// Error of the rigorous efficiencies.
    change: f64,
    orders: Vec<i32>,
    R_s: Vec<f64>,
    R_p: Vec<f64>,
}

const RAYS: u32 = 16_384;

/// Standard errors by which an estimate may miss its mean. One of a million numbers misses it by more, and there are a
/// thousand.
const STANDARD_ERRORS: f64 = 5.0;

impl Case {
    fn toml(&self) -> String {
        let period = self.points_nm[self.points_nm.len() - 1][0];
        let [n, k] = self.eta;
        format!(
            "[cell]\nperiod_nm = [{period:?}, {period:?}]\nsurface = {{ kind = \"grooves\", points_nm = {:?} }}\n\
             [interface.grooves]\nabove = 1.0\nbelow = [{n:?}, {k:?}]\n",
            self.points_nm
        )
    }
}

fn cases() -> Vec<Case> {
    serde_json::from_str::<Table>(include_str!("../data/orders.json")).expect("the reference").cases
}

/// |ours − rigorous| of s and of p, less the errors of the reference and of sampling, then the bound, and whether the
/// program is silent.
fn compare(case: &Case) -> ([f64; 2], f64, bool) {
    let scene = parse("grating", &case.toml()).expect("a good scene");
    let mesh_scene = MeshScene::new(&scene).expect("a good mesh");
    let (wi, nm) = (towards(case.theta_deg, case.phi_deg), [case.wavelength_nm]);
    let request =
        OrdersRequest { rays: RAYS, seed: 1, max_order: None, hits: 1, precision: Precision::F64, threads: 1 };
    let found = orders(&mesh_scene, wi, &nm, &request, &|| ()).expect("a good mesh").orders;
    let mut worst = [0.0_f64; 2];
    for (place, &m) in case.orders.iter().enumerate() {
        let order = found.iter().find(|order| order.index == [m, 0]).expect("every order that travels is found");
        let (s, p) = (order.efficiency.s, order.efficiency.p);
        for (worst, (ours, rigorous)) in worst.iter_mut().zip([(s, case.R_s[place]), (p, case.R_p[place])]) {
            let known = case.change + STANDARD_ERRORS * ours.std_error;
            *worst = worst.max((ours.value - rigorous).abs() - known);
        }
    }
    let bound = error_bounds(&mesh_scene, wi, &nm).expect("a good mesh")[0];
    let silent = warning(&mesh_scene, wi, &nm).expect("a good mesh").is_none();
    (worst, bound, silent)
}

#[test]
fn no_efficiency_errs_by_more_than_the_bound_says() {
    let (mut said, mut untrue, mut silences) = (String::new(), 0, 0);
    for case in &cases() {
        let ([s, p], bound, silent) = compare(case);
        let highest = case.points_nm.iter().fold(0.0_f64, |max, point| max.max(point[1]));
        let _ = writeln!(
            said,
            "{} η {:?} period {:5.2} λ depth {:.2} λ θ {} φ {}: s {s:.4} p {p:.4} bound {bound:.4}",
            if case.fitted { "fitted " } else { "new    " },
            case.eta,
            case.points_nm[case.points_nm.len() - 1][0] / case.wavelength_nm,
            highest / case.wavelength_nm,
            case.theta_deg,
            case.phi_deg
        );
        assert_eq!(silent, bound <= MAX_SILENT, "what is said is what is bounded");
        untrue += u32::from(s.max(p) > bound);
        silences += u32::from(silent);
    }
    println!("{said}");
    assert_eq!(untrue, 0, "{said}");
    assert!(silences >= 5, "a warning that always comes says nothing: {silences}");
    assert!(cases().iter().filter(|case| !case.fitted).count() >= 10);
}

/// The bound of a scene in light from the normal at 550 nm.
fn bound(toml: &str) -> f64 {
    let scene = parse("cell", toml).expect("a good scene");
    let mesh_scene = MeshScene::new(&scene).expect("a good mesh");
    error_bounds(&mesh_scene, towards(0.0, 0.0), &[550.0]).expect("a good mesh")[0]
}

const BETWEEN: &str = "above = 1.0\nbelow = 1.5\n";

#[test]
fn shelves_have_no_bound_and_planes_the_least() {
    let shelves = "[cell]\nperiod_nm = [70000, 700]\nsurface = { kind = \"lamellae\", shelves = 2, width_nm = 40000, \
                   shelf_nm = 60, gap_nm = 130, trunk_nm = 6000 }\n[interface.cuticle]\n";
    assert!(bound(&format!("{shelves}{BETWEEN}")) >= 1.0);
    let flat = "[cell]\nperiod_nm = [500, 500]\nsurface = { kind = \"grooves\", points_nm = [[0, 0], [500, 0]] }\n\
                [interface.grooves]\n";
    assert!(bound(&format!("{flat}{BETWEEN}")) < MAX_SILENT);
}

/// The error of grazing light on flat metal under n = 1.5 with k = 1e-3 is bounded: R_p at 88° is off by 0.115, for
/// orders give 1.0358 and the closed form 1.1505.
#[test]
fn grazing_light_through_a_medium_that_absorbs_is_warned_of() {
    let toml = "[cell]\nperiod_nm = [500, 500]\nsurface = { kind = \"grooves\", points_nm = [[0, 0], [500, 0]] }\n\
                [interface.grooves]\nabove = [1.5, 0.001]\nbelow = [0.05, 3.5]\n";
    let scene = parse("cell", toml).expect("a good scene");
    let mesh_scene = MeshScene::new(&scene).expect("a good mesh");
    let at = |theta_deg| {
        let wi = towards(theta_deg, 0.0);
        let bound = error_bounds(&mesh_scene, wi, &[550.0]).expect("a good mesh")[0];
        (bound, warning(&mesh_scene, wi, &[550.0]).expect("a good mesh"))
    };
    let (bound, said) = at(88.0);
    assert!(bound >= 0.115 && said.is_some_and(|said| said.contains("absorbs")), "{bound}");
    assert_eq!(at(60.0).1, None);
}

#[test]
fn the_bound_does_not_depend_on_how_finely_a_surface_is_cut() {
    let sines = |cut: u32| {
        let points: Vec<[f64; 2]> = (0..=cut)
            .map(|i| {
                [
                    5000.0 * f64::from(i) / f64::from(cut),
                    100.0 * (f64::from(i) / f64::from(cut) * std::f64::consts::TAU).cos(),
                ]
            })
            .collect();
        bound(&format!(
            "[cell]\nperiod_nm = [5000, 5000]\nsurface = {{ kind = \"grooves\", points_nm = {points:?} }}\n\
             [interface.grooves]\nabove = 1.0\nbelow = [0.06, 3.6]\n"
        ))
    };
    // A polyline turns by as much as its curve, except at its first and last corner.
    let (coarse, fine) = (sines(32), sines(256));
    assert!((coarse / fine - 1.0).abs() < 0.02, "{coarse} {fine}");
}

#[test]
fn pits_all_over_are_warned_of_like_grooves() {
    let pyramids = "[cell]\nperiod_nm = [2000, 2000]\nsurface = { kind = \"pyramids\", count = [2, 2], fill = [0.6, 0.6] }\n\
                    [interface.pyramids]\n";
    assert!(bound(&format!("{pyramids}above = 1.0\nbelow = \"mirror\"\n")) > 0.3);
}
