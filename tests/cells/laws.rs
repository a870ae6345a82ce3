//! Laws of physics that cells of tilted facets obey, tested on many random ones.

use std::f64::consts::TAU;

use glam::DVec3;
use goniochrome::measure::bins::DirectionBins;
use goniochrome::optics::interface::Model;
use goniochrome_cli::scene::Scene;
use goniochrome_cli::solve::mesh_scene::MeshScene;
use goniochrome_cli::solve::planar_scene::PlanarScene;
use goniochrome_cli::solve::precision::Precision;
use goniochrome_cli::solve::scatter::{Coherence, ScatterRequest, scatter};
use goniochrome_cli::solve::spectra::{Method, SpectraRequest, spectra};

use crate::height_field::{HeightField, Outcome, Start, follow, moved};
use crate::random::Random;

const SCENES: u64 = 10_000;
const RAYS: u32 = 4;
/// Number of states: more than a starting ray's paths ever occupy.
const STATES: usize = 64;
/// Bound of rounding: a power is a product of some hundred factors, each rounded to 1e-16, and a sum of a thousand
/// terms.
const ROUNDING: f64 = 1e-11;

impl Random {
    fn height_field(&mut self, absorbs: bool) -> HeightField {
        let period_nm = [self.between(500.0, 5000.0), self.between(500.0, 5000.0)];
        let squares = [1 + self.below(3) as usize, 1 + self.below(3) as usize];
        let steepness = self.between(0.0, 1.0);
        let height = steepness * (period_nm[0] / squares[0] as f64).min(period_nm[1] / squares[1] as f64);
        let heights_nm = (0..squares[0] * squares[1]).map(|_| self.between(0.0, height)).collect();
        let depths_nm: Vec<f64> = (0..self.below(3)).map(|_| self.between(1.0, 2000.0)).collect();
        let mut media = vec![[self.between(1.0, 2.0), 0.0]];
        for _ in 0..depths_nm.len() + usize::from(self.below(4) > 0) {
            let k = if absorbs && self.below(3) == 0 { 10f64.powf(self.between(-5.0, 0.5)) } else { 0.0 };
            media.push([self.between(1.0, 3.0), k]);
        }
        HeightField { period_nm, squares, heights_nm, depths_nm, media }
    }

    /// A random direction, with a density ∝ cos θ per solid angle.
    fn direction(&mut self) -> DVec3 {
        let (sin2, phi) = (self.between(0.0, 0.999), self.between(0.0, TAU));
        DVec3::new(sin2.sqrt() * phi.cos(), sin2.sqrt() * phi.sin(), (1.0 - sin2).sqrt())
    }

    fn starts(&mut self, count: u32) -> Vec<Start> {
        let mut start =
            |seed| Start { wi: self.direction(), u: self.between(0.0, 1.0), v: self.between(0.0, 1.0), seed };
        (0..count).map(&mut start).collect()
    }
}

/// Calls `check` with each of the random scenes.
fn each(seed: u64, absorbs: bool, mut check: impl FnMut(&mut Random, &HeightField, &Scene)) {
    let mut random = Random(seed);
    for _ in 0..SCENES {
        let field = random.height_field(absorbs);
        let scene = field.scene();
        check(&mut random, &field, &scene);
    }
}

/// The largest difference of two outcomes: of the power reflected, its sum of power times direction, and the power
/// transmitted.
fn difference(a: &Outcome, b: &Outcome, turned: impl Fn(DVec3) -> DVec3) -> f64 {
    let moment = |outcome: &Outcome| outcome.up.iter().map(|(direction, power)| *direction * *power).sum::<DVec3>();
    let reflected = (a.reflected() - b.reflected()).abs().max((turned(moment(a)) - moment(b)).length());
    reflected.max((a.transmitted - b.transmitted).abs())
}

/// Counts rays for which two descriptions of one cell differ: a ray that passes an edge on the other side takes another
/// path.
#[derive(Default)]
struct Agreement {
    rays: u32,
    strayed: u32,
    worst: f64,
}

impl Agreement {
    fn see(&mut self, difference: f64, tolerance: f64) {
        assert!(difference.is_finite());
        self.rays += 1;
        if difference <= tolerance {
            self.worst = self.worst.max(difference);
        } else {
            self.strayed += 1;
        }
    }

    fn report(self, law: &str) {
        /// Largest share of rays that pass an edge within rounding, or draw another branch because of it.
        const STRAYED: f64 = 1e-4;
        println!(
            "{law}: {} of {} rays went another way, the others differ by {:.1e}",
            self.strayed, self.rays, self.worst
        );
        assert!(f64::from(self.strayed) <= STRAYED * f64::from(self.rays), "{law}: {} rays", self.strayed);
    }
}

#[test]
fn power_is_conserved_in_any_workspace() {
    let (mut worst, mut min_part) = ([0.0f64; 2], 1.0f64);
    each(1, true, |random, field, scene| {
        let states = if random.below(2) == 0 { STATES } else { 1 + random.below(8) as usize };
        let absorbs = field.media.iter().any(|[_, k]| *k > 0.0);
        for outcome in follow(scene, 550.0, states, &random.starts(RAYS)) {
            assert!(outcome.total().is_finite(), "{field:?}");
            let worst = &mut worst[usize::from(absorbs)];
            *worst = worst.max((outcome.total() - 1.0).abs());
            for part in [outcome.transmitted, outcome.absorbed, outcome.truncated] {
                min_part = min_part.min(part);
            }
            assert!(outcome.up.iter().all(|(direction, power)| direction.z > 0.0 && *power >= 0.0));
        }
    });
    let [lossless, absorbing] = worst;
    println!(
        "energy: lossless cells off by {lossless:.1e}, absorbing ones by {absorbing:.1e}; no part below {min_part:.1e}"
    );
    assert!(lossless <= ROUNDING && absorbing <= ROUNDING && min_part >= -ROUNDING);
}

#[test]
fn lengths_and_wavelengths_together_change_nothing() {
    let mut agreement = Agreement::default();
    each(2, true, |random, field, scene| {
        let scale = 10f64.powf(random.between(-1.0, 2.0));
        let scaled = moved(scene, field.period_nm.map(|x| x * scale), |vertex| vertex.map(|x| x * scale));
        let starts = random.starts(RAYS);
        let both =
            follow(scene, 550.0, STATES, &starts).into_iter().zip(follow(&scaled, 550.0 * scale, STATES, &starts));
        both.for_each(|(a, b)| agreement.see(difference(&a, &b, |x| x), 1e-9));
    });
    agreement.report("scaling");
}

#[test]
fn a_turned_cell_turns_its_brdf() {
    let mut agreement = Agreement::default();
    let turn = |x: DVec3| DVec3::new(-x.y, x.x, x.z);
    each(3, true, |random, field, scene| {
        let [width, depth] = field.period_nm;
        let turned = moved(scene, [depth, width], |[x, y, z]| [depth - y, x, z]);
        let starts = random.starts(RAYS);
        let turned_starts: Vec<Start> =
            starts.iter().map(|start| Start { wi: turn(start.wi), u: 1.0 - start.v, v: start.u, ..*start }).collect();
        let both =
            follow(scene, 550.0, STATES, &starts).into_iter().zip(follow(&turned, 550.0, STATES, &turned_starts));
        both.for_each(|(a, b)| agreement.see(difference(&a, &b, turn), 1e-9));
    });
    agreement.report("turning");
}

#[test]
fn faint_absorption_tends_to_none() {
    const K: f64 = 1e-12;
    /// 4π k/λ: light loses no more than this share of its power in each nanometre of path.
    const LOST_PER_NM: f64 = 2.0 * TAU * K / 550.0;
    /// Standard errors.
    const FAR: f64 = 5.0;
    let (mut max_absorbed, mut longest, mut sum, mut variance) = (0.0f64, 0.0f64, 0.0, 0.0);
    let (mut equal, mut rays) = (0u32, 0u32);
    each(4, false, |random, field, scene| {
        let starts = random.starts(RAYS);
        let mut faint = field.clone();
        faint.media.iter_mut().skip(1).for_each(|[_, k]| *k = K);
        let both =
            follow(scene, 550.0, STATES, &starts).into_iter().zip(follow(&faint.scene(), 550.0, STATES, &starts));
        for (a, b) in both {
            assert!(a.absorbed.abs() <= ROUNDING);
            assert!(b.absorbed <= LOST_PER_NM * b.path_nm + ROUNDING);
            max_absorbed = max_absorbed.max(b.absorbed);
            longest = longest.max(b.path_nm);
            rays += 1;
            // Most pairs of rays differ by what is absorbed. The others drew other branches of weak paths, which are
            // equal on average.
            let apart = a.reflected() - b.reflected();
            if apart.abs() <= b.absorbed + ROUNDING {
                equal += 1;
            } else {
                sum += apart;
                variance += apart * apart;
            }
        }
    });
    println!(
        "k = {K:e}: {max_absorbed:.1e} absorbed over {longest:.1e} nm; {equal} of {rays} rays alike, \
         the others' R off by {sum:e}"
    );
    assert!(f64::from(equal) >= 0.9 * f64::from(rays) && sum.abs() <= FAR * variance.sqrt());
}

#[test]
fn sheets_between_equal_media_change_nothing() {
    let mut worst = 0.0f64;
    each(5, false, |random, field, _| {
        let n = field.media[0];
        let matched = HeightField { media: vec![n; field.sheets() + 1], ..field.clone() };
        for outcome in follow(&matched.scene(), 550.0, STATES, &random.starts(RAYS)) {
            worst = worst.max(outcome.reflected()).max((outcome.transmitted - 1.0).abs());
        }
    });
    println!("index-matched: {worst:.1e}");
    assert!(worst <= ROUNDING);
}

/// Reciprocity over the hemisphere: the light from directions in A that leaves into B equals that from B into A, where
/// directions are weighted by cos θ dω.
#[test]
fn cells_are_reciprocal() {
    /// Number of rays in each scene, which give the error of the scene's mean.
    const RAYS: u32 = 8;
    /// Standard errors beyond which one sum in a million lies.
    const FAR: f64 = 5.0;
    type Split = (&'static str, fn(DVec3) -> bool);
    let splits: [Split; 3] = [
        ("near the normal and near the horizon", |w| w.z > std::f64::consts::FRAC_1_SQRT_2),
        ("left and right", |w| w.x > 0.0),
        ("two sectors and the rest", |w| w.x * w.y > 0.0),
    ];
    let mut sums = [[0.0; 3]; 3];
    let mut wrong = [0.0; 2];
    each(6, true, |random, _, scene| {
        let starts = random.starts(RAYS);
        let outcomes = follow(scene, 550.0, STATES, &starts);
        for ((_, inside), [sum, variance, crossed]) in splits.iter().zip(&mut sums) {
            for (start, outcome) in starts.iter().zip(&outcomes) {
                let other = outcome.up.iter().filter(|(wo, _)| inside(*wo) != inside(start.wi));
                let power: f64 = other.map(|(_, power)| power).sum();
                *sum += if inside(start.wi) { power } else { -power };
                *variance += power * power;
                *crossed += power;
            }
        }
        // To show that the test can fail: f(wi, wo) without its cosines is not symmetric.
        for (start, outcome) in starts.iter().zip(&outcomes) {
            let inside = splits[0].1;
            let power: f64 = outcome.up.iter().filter(|(wo, _)| inside(*wo) != inside(start.wi)).map(|(_, p)| p).sum();
            let without = power / start.wi.z;
            wrong[0] += if inside(start.wi) { without } else { -without };
            wrong[1] += without * without;
        }
    });
    for ((name, _), [sum, variance, crossed]) in splits.iter().zip(sums) {
        let error = variance.sqrt();
        println!("{name}: {:.2} standard errors, which are {:.1e} of what crosses", sum / error, error / crossed);
        assert!(sum.abs() <= FAR * error, "{name}: {sum} with a standard error of {error}");
        assert!(error <= 0.02 * crossed, "{name}: too few rays to tell anything");
    }
    assert!(wrong[0].abs() > FAR * wrong[1].sqrt());
}

#[test]
fn flat_sheets_are_the_stack_in_closed_form() {
    /// Bound of dropped waves. Those below 1e-13 of the light are dropped: 2√1e-13 in reflectance for each of a few
    /// that ring.
    const DROPPED: f64 = 5e-6;
    let (mut worst, mut seen) = (0.0f64, 0);
    each(7, false, |random, field, _| {
        let flat = HeightField { heights_nm: vec![0.0; field.heights_nm.len()], ..field.clone() };
        let theta_deg = random.between(0.0, 80.0);
        // Evanescent waves may gain in a loop, and then their sum hit by hit diverges.
        let q_t = flat.media[0][0] * theta_deg.to_radians().sin();
        if flat.media.iter().any(|[n, _]| *n <= 1.05 * q_t) {
            return;
        }
        let scene = flat.scene();
        let mesh_scene = MeshScene::new(&scene).expect("a good mesh");
        let bins = DirectionBins { cos: 1, phi: 1 };
        let precision = Precision::F64;
        let request = ScatterRequest { coherence: Coherence::Ray, rays: 32, seed: 0, bins, precision, threads: 1 };
        let (sin, cos) = theta_deg.to_radians().sin_cos();
        let wi = DVec3::new(0.6 * sin, 0.8 * sin, cos);
        let traced = &scatter(&mesh_scene, wi, &[550.0], &request, &|| ()).expect("a good mesh")[0];
        let planar = PlanarScene::new(&scene).expect("horizontal planes");
        let request = SpectraRequest { model: Model::Physical, method: Method::Stack, precision, threads: 1 };
        let closed = spectra(&planar, &[theta_deg], &[550.0], &request, &|| ()).expect("a good stack").samples[0];
        let transmitted = 0.5 * (closed.transmittance.s + closed.transmittance.p);
        let error = (traced.reflected.value - closed.mean_reflectance()).abs();
        let error = error.max((traced.transmitted.value - transmitted).abs());
        assert!(error <= DROPPED, "{error:e} at {theta_deg} degrees: {flat:?}");
        worst = worst.max(error);
        seen += 1;
    });
    println!("flat sheets: {seen} stacks, off by {worst:.1e}");
    assert!(seen > SCENES / 2);
}
