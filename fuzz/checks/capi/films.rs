//! Calls that make planar stacks and colours, and evaluate them.

use super::media::Media;
use super::out::Out;
use super::program::Program;
use crate::scalar::Problem;
use goniochrome::colour::{Illuminant, Quadrature, RgbSpace, xyz_weights};
use goniochrome_capi::colour::{
    Colour, GONIO_ILLUMINANT_D65, GONIO_SPACE_ACESCG, GONIO_SPACE_REC2020, GONIO_SPACE_SRGB, gonio_colour_make,
};
use goniochrome_capi::stack::{
    GONIO_MAX_LAYERS, GONIO_MIRROR, Layer, Stack, gonio_stack_make, gonio_stack_reflectance, gonio_stack_rgb,
};
use goniochrome_capi::status::Status;
use num_complex::Complex64;

/// Unit roundoff of single precision.
const ROUNDOFF: f64 = f32::EPSILON as f64 / 2.0;
/// Bound above which the scalar solver's first-order bounds say nothing.
const FIRST_ORDER: f64 = 1e-3;

/// A stack that was made.
pub struct Films {
    object: Out<Stack>,
    media: Media,
    ambient: u16,
    layers: Vec<Layer>,
    substrate: u16,
}

/// The weights of a colour space that were made.
pub struct Colours {
    object: Out<Colour>,
    illuminant: Illuminant,
    space: RgbSpace,
}

pub fn make_films(program: &mut Program<'_>, films: &mut Option<Films>) {
    let mut faults = program.faults();
    let media = Media::new(program, &mut faults);
    let ambient = media.index(program);
    let count = match program.byte() {
        255 => GONIO_MAX_LAYERS + 1,
        code => usize::from(code) % 8,
    };
    let mut layer = || Layer { thickness_nm: program.number(0.0, 2500.0), medium: media.index(program) };
    let layers: Vec<Layer> = (0..count).map(|_| layer()).collect();
    let substrate = if program.byte() & 3 == 0 { GONIO_MIRROR } else { media.index(program) };
    let mut object = Out::new(1);
    // SAFETY: pointers are NULL, misaligned, or to as much as the counts say. Everything is kept with the object.
    let status = unsafe {
        gonio_stack_make(
            faults.pass_mut(object.pointer()),
            faults.list(&media.list),
            media.list.len(),
            ambient,
            faults.list(&layers),
            layers.len(),
            substrate,
        )
    };
    assert!(!(faults.hit() && status == Status::Ok), "a bad pointer was taken");
    if object.succeeded(status) {
        *films = Some(Films { object, media, ambient, layers, substrate });
    }
}

pub fn make_colours(program: &mut Program<'_>, colours: &mut Option<Colours>) {
    let mut faults = program.faults();
    let (illuminant, space) = (program.below(3) as u32, program.below(5) as u32);
    let mut object = Out::new(1);
    // SAFETY: the pointer is NULL, misaligned, or to room for an object.
    let status = unsafe { gonio_colour_make(faults.pass_mut(object.pointer()), illuminant, space) };
    assert!(!(faults.hit() && status == Status::Ok), "a bad pointer was taken");
    if object.succeeded(status) {
        let illuminant = if illuminant == GONIO_ILLUMINANT_D65 { Illuminant::D65 } else { Illuminant::E };
        let space = match space {
            GONIO_SPACE_SRGB => RgbSpace::Srgb,
            GONIO_SPACE_REC2020 => RgbSpace::Rec2020,
            GONIO_SPACE_ACESCG => RgbSpace::AcesCg,
            other => panic!("space {other} was taken"),
        };
        *colours = Some(Colours { object, illuminant, space });
    }
}

pub fn reflectance(program: &mut Program<'_>, films: Option<&Films>) {
    let mut faults = program.faults();
    let cos_theta = program.number(0.0, 1.0);
    let nm: Vec<f64> = (0..program.below(4)).map(|_| program.number(200.0, 1500.0)).collect();
    let (nothing, [mut s, mut p]) = (Out::new(1), [Out::new(nm.len()), Out::new(nm.len())]);
    let object = films.map_or(&nothing, |films| &films.object);
    // SAFETY: pointers are NULL, misaligned, or to what the count says.
    let status = unsafe {
        gonio_stack_reflectance(
            faults.pass(object.object()),
            cos_theta,
            faults.list(&nm),
            nm.len(),
            faults.pass_mut(s.pointer()),
            faults.pass_mut(p.pointer()),
        )
    };
    assert!(!(faults.hit() && status == Status::Ok), "a bad pointer was taken");
    if s.succeeded(status) & p.succeeded(status) {
        let films = films.expect("nothing was made, and answered");
        for ((&nm, &s), &p) in nm.iter().zip(s.results()).zip(p.results()) {
            films.holds(cos_theta, nm, [s, p].map(f64::from));
        }
    }
}

pub fn rgb(program: &mut Program<'_>, films: Option<&Films>, colours: Option<&Colours>) {
    let mut faults = program.faults();
    let cos_theta = program.number(0.0, 1.0);
    let (no_stack, no_colour, mut rgb) = (Out::new(1), Out::new(1), Out::<f32>::new(3));
    // SAFETY: pointers are NULL, misaligned, to an object, to memory that holds none, or to three numbers.
    let status = unsafe {
        gonio_stack_rgb(
            faults.pass(films.map_or(&no_stack, |films| &films.object).object()),
            faults.pass(colours.map_or(&no_colour, |colours| &colours.object).object()),
            cos_theta,
            faults.pass_mut(rgb.pointer()),
        )
    };
    assert!(!(faults.hit() && status == Status::Ok), "a bad pointer was taken");
    if rgb.succeeded(status) {
        let (films, colours) = (films.expect("a stack"), colours.expect("colours"));
        for (&got, [colour, weight]) in rgb.results().iter().zip(colours.of(films, cos_theta)) {
            // Here the reflectances are rounded before they are summed, there after it.
            let bound = ROUNDOFF * (weight + colour.abs());
            assert!((f64::from(got) - colour).abs() <= bound, "{got:e}, not {colour:e} within {bound:e}");
        }
    }
}

impl Films {
    /// Checks R of s and p against the scalar solver, within its bounds.
    fn holds(&self, cos_theta: f64, nm: f64, got: [f64; 2]) {
        assert!(got.iter().all(|r| r.is_finite() && *r >= 0.0), "R = {got:?}");
        let media = self.media.eta(nm);
        let mut eta: Vec<Complex64> = vec![media[usize::from(self.ambient)]];
        eta.extend(self.layers.iter().map(|layer| media[usize::from(layer.medium)]));
        if self.substrate != GONIO_MIRROR {
            eta.push(media[usize::from(self.substrate)]);
        }
        let thickness_nm: Vec<f64> = self.layers.iter().map(|layer| layer.thickness_nm).collect();
        let sin_theta = ((1.0 - cos_theta) * (1.0 + cos_theta)).sqrt();
        let problem = Problem { eta: &eta, thickness_nm: &thickness_nm, sin_theta, wavelength_nm: nm };
        for (got, twin) in got.into_iter().zip(problem.solve()) {
            // The returned value is rounded to single precision once more.
            let [bound, _] = twin.perturbed(ROUNDOFF, problem.kept_off(ROUNDOFF));
            let bound = bound + ROUNDOFF * got;
            let near = (got - twin.reflectance).abs() <= bound && got <= 1.0 + bound;
            let blind = bound.is_nan() || bound > FIRST_ORDER;
            assert!(near || blind, "R = {got:e}, not {:e} within {bound:e}", twin.reflectance);
        }
    }
}

impl Colours {
    /// The colour of the reflectances that the interface itself gives, and the sum of the absolute values of its terms,
    /// for each of R, G and B.
    fn of(&self, films: &Films, cos_theta: f64) -> [[f64; 2]; 3] {
        let nm: [f64; 81] = std::array::from_fn(|i| 380.0 + 5.0 * i as f64);
        let mut weights = [[0.0; 3]; 81];
        xyz_weights(&nm, self.illuminant, Quadrature::Interpolated, &mut weights).expect("many wavelengths");
        let [mut s, mut p] = [Out::new(81), Out::new(81)];
        // SAFETY: an object, 81 wavelengths, and room for 81 results twice.
        let status = unsafe {
            gonio_stack_reflectance(films.object.object(), cos_theta, nm.as_ptr(), 81, s.pointer(), p.pointer())
        };
        assert_eq!(status, Status::Ok);
        let mean =
            s.results().iter().zip(p.results()).map(|(&s, &p): (&f32, &f32)| 0.5 * (f64::from(s) + f64::from(p)));
        let terms = weights.iter().zip(mean).map(|(weight, mean)| self.space.from_xyz(weight.map(|w| w * mean)));
        terms.fold([[0.0; 2]; 3], |sums, term| {
            std::array::from_fn(|c| [sums[c][0] + term[c], sums[c][1] + term[c].abs()])
        })
    }
}
