//! The texture of a soap film with a finish, and its shader functions, in the folder of the first argument; the others
//! are the distribution (ggx, beckmann, or tabulated, which is a coarse table of Beckmann's), the masking (correlated,
//! separable), the roughness along x and y, and `compensated` for energy compensation. Tabulated facets go into
//! facets.exr of that folder, compensation into compensation.exr. Then reads lines of eight numbers: wi, a parameter,
//! then wo and 0, or two numbers, 0 and 1. For the first it prints f and the density by the library, for the second the
//! direction that it draws and its density: the truth for the shader functions. Four more numbers bound the difference.

use std::error::Error;
use std::f32::consts::TAU;
use std::fs;
use std::io::stdin;
use std::path::Path;

use glam::Vec3;
use goniochrome::microfacet::{Distribution, FacetTable, Finish, Lobe};
use goniochrome_cli::export::ShaderLanguage;
use goniochrome_cli::export::lut::Lut;
use goniochrome_cli::scene::{DISTRIBUTIONS, FinishFacets, MASKINGS, OwnedFacets, OwnedFinish, load, named};

/// Half floats round values below 1 by at most 2⁻¹², and single precision what is interpolated between them: 2⁻¹⁰, as
/// for the look-up alone.
const TEXEL: f32 = 1.0 / 1024.0;
/// Rounding of components of unit vectors and half vectors, of some ten operations.
const ROUNDING: f32 = 1e-6;
/// Bound of the error of cumulative probabilities: erf errs by 1.5e-7, over at least 1/4, and the solution of an
/// equation of three such terms, with the rounding of each, by as much again for each.
const PROBABILITY: f32 = 4e-6;

/// Largest share by which rounding may change D at a half vector, and with it f and the density: its slope in units of
/// the roughness has an error of its own.
fn relative([x, y]: [f32; 2], m: Vec3) -> f32 {
    let least = x.min(y);
    let squared = (m.x / x).powi(2) + (m.y / y).powi(2);
    // D falls as exp(−s²), or as 1/(1 + s²)², with s² up to 60, where the library's exponential ends.
    let exponent = (squared / (m.z * m.z)).min(60.0);
    10.0 * ROUNDING + 2.0 * exponent.sqrt() * (ROUNDING / least + ROUNDING * exponent.sqrt()) / (m.z * m.z).max(0.01)
}

/// Bound of the error of an azimuth: the arc tangent of Mesa's shaders errs by 1e-5.
const TURN: f32 = 2e-5;

/// Tabulated facets of a distribution, coarser than those of scenes.
fn tabulated(of: &Finish<'_>) -> Result<OwnedFacets, Box<dyn Error>> {
    let [rings, sectors] = if of.is_isotropic() { [40, 1] } else { [32, 24] };
    let density: Vec<f32> = (0..(rings + 1) * sectors)
        .map(|node| {
            let t = (FacetTable::sin_square(rings, node / sectors) as f32).min(0.999_999);
            let (sin, cos) = (TAU * (node % sectors) as f32 / sectors as f32).sin_cos();
            of.density(Vec3::new(t.sqrt() * cos, t.sqrt() * sin, (1.0 - t).sqrt()))
        })
        .collect();
    Ok(OwnedFacets::new([rings, sectors], &density)?)
}

/// Largest change of a lobe's value and density by rounding of directions and azimuths, for tabulated facets.
fn change(finish: &Finish<'_>, wi: Vec3, wo: Vec3) -> [f32; 2] {
    let turned = |angle: f32| {
        let (sin, cos) = angle.sin_cos();
        [wi, wo].map(|w| Vec3::new(cos * w.x - sin * w.y, sin * w.x + cos * w.y, w.z))
    };
    let moved = [Vec3::X, Vec3::Y, Vec3::Z].map(|axis| [wi, (wo + 10.0 * ROUNDING * axis).normalize()]);
    let of = |lobe: Option<Lobe>| lobe.map_or([0.0; 2], |lobe| [lobe.value, lobe.pdf]);
    let here = of(finish.lobe(wi, wo));
    let mut sum = here.map(|of| 20.0 * ROUNDING * of);
    for [wi, wo] in moved.into_iter().chain([turned(TURN), turned(-TURN)]) {
        for (i, there) in of(finish.lobe(wi, wo)).into_iter().enumerate() {
            sum[i] += (there - here[i]).abs();
        }
    }
    sum
}

/// Largest density that the library takes for 0 where its exponential ends, at s² = 60.
fn end([x, y]: [f32; 2], m: Vec3) -> f32 {
    (-60f32).exp() / (std::f32::consts::PI * x * y * m.z.powi(4))
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [folder, distribution, masking, x, y, rest @ ..] = arguments.as_slice() else {
        return Err(
            "usage: finish_samples FOLDER ggx|beckmann|tabulated correlated|separable ALPHA ALPHA [compensated]".into(),
        );
    };
    let is_compensated = !rest.is_empty();
    let is_tabulated = distribution == "tabulated";
    let distribution = named(&DISTRIBUTIONS, distribution)
        .or(is_tabulated.then_some(Distribution::Beckmann))
        .ok_or("no such distribution")?;
    let masking = named(&MASKINGS, masking).ok_or("no such masking")?;
    let alpha = [x.parse()?, y.parse()?];
    let finish = Finish::new(distribution, masking, alpha)?;
    let facets = if is_tabulated {
        FinishFacets::Tabulated(tabulated(&finish)?, masking)
    } else {
        FinishFacets::Analytic(finish)
    };
    let own = OwnedFinish::new(facets).compensated(is_compensated);
    let mut lut = Lut::of_scene(&load("soap-bubble")?, 64, Some("1=100:800:48".parse()?))?;
    lut.finish = Some(own.clone());
    let finish = own.finish();
    let folder = Path::new(folder);
    fs::write(folder.join("finish.exr"), lut.exr()?)?;
    if let Some(facets) = lut.facets_exr()? {
        fs::write(folder.join("facets.exr"), facets)?;
    }
    if let Some(compensation) = lut.compensation_exr()? {
        fs::write(folder.join("compensation.exr"), compensation)?;
    }
    let shader = if is_compensated {
        "compensation"
    } else if is_tabulated {
        "facets"
    } else {
        "finish"
    };
    let returned = lut.returned();
    let returned = |parameter: f32| {
        let at = parameter * (returned.len().max(1) - 1) as f32;
        let row = (at as usize).min(returned.len().saturating_sub(2));
        let [low, high] = [row, row + 1].map(|row| returned.get(row).copied().unwrap_or_default());
        std::array::from_fn::<f32, 3, _>(|c| low[c] + (at - row as f32) * (high[c] - low[c]))
    };
    for (language, name) in
        [(ShaderLanguage::Glsl, "glsl"), (ShaderLanguage::Hlsl, "hlsl"), (ShaderLanguage::Wgsl, "wgsl")]
    {
        fs::write(folder.join(format!("{shader}.{name}")), lut.shader(language))?;
    }
    for line in stdin().lines() {
        let numbers = line?.split(',').map(str::parse).collect::<Result<Vec<f32>, _>>()?;
        let &[a, b, c, parameter, d, e, f, draw] = numbers.as_slice() else { return Err("expected 8 numbers".into()) };
        let (wi, given) = (Vec3::new(a, b, c), Vec3::new(d, e, f));
        let loss = finish.compensation().map_or(0.0, |compensation| compensation.loss(wi.z));
        let slack_of_loss = if is_compensated { loss * TEXEL + ROUNDING } else { 0.0 };
        let of_pair = |wo: Vec3| {
            let m = (wi + wo).normalize();
            let Some(lobe) = finish.lobe(wi, wo) else { return (0.0, 0.0) };
            let mixed = slack_of_loss * (1.0 + lobe.pdf);
            if is_tabulated {
                return (lobe.pdf, change(&finish, wi, wo)[1] + mixed);
            }
            (lobe.pdf, lobe.pdf * relative(alpha, m) + 0.25 * end(alpha, m) / finish.visible_area(wi) + mixed)
        };
        if draw > 0.5 {
            let drawn = |[u, v]: [f32; 2]| {
                if u < loss {
                    return finish.sample(wi, [u, v]).unwrap_or(Vec3::X);
                }
                let u = [(u - loss) / (1.0 - loss), v];
                let m = finish.draw_normal(wi, u);
                (2.0 * wi.dot(m) * m - wi).normalize()
            };
            let wo = drawn([d, e]);
            // Where the loss differs, so does the choice between both ways to draw, and what is left of the number.
            let across = PROBABILITY + slack_of_loss / (1.0 - loss).max(0.1);
            let moved = [[-across, 0.0], [across, 0.0], [0.0, -PROBABILITY], [0.0, PROBABILITY]];
            let near = moved.map(|[du, dv]| drawn([(d + du).max(0.0), e + dv]));
            let slack = near.iter().map(|near| near.distance(wo)).sum::<f32>() + 10.0 * ROUNDING;
            let (pdf, slack_of_pdf) = of_pair(wo);
            // The density where the shader's own direction lies.
            let range = near.iter().map(|near| (of_pair(*near).0 - pdf).abs()).sum::<f32>();
            let beside = [Vec3::X, Vec3::Y].map(|axis| (of_pair((wo + slack * axis).normalize()).0 - pdf).abs());
            let slack_of_pdf = slack_of_pdf + range + 2.0 * (beside[0] + beside[1]);
            println!("{},{},{},{pdf},{slack},{slack},{slack},{slack_of_pdf}", wo.x, wo.y, wo.z);
        } else {
            let (pdf, slack_of_pdf) = of_pair(given);
            let lobe = finish.lobe(wi, given);
            let value = lobe.map_or(0.0, |lobe| lobe.value);
            let rho = lut.sample(lobe.map_or(0.0, |lobe| lobe.cos_d), parameter);
            let share = relative(alpha, (wi + given).normalize());
            let ended = lobe.map_or(0.0, |_| end(alpha, (wi + given).normalize()) * finish.shadowing(wi, given));
            let several = returned(parameter).map(|returned| returned * lobe.map_or(0.0, |lobe| lobe.multiple));
            let slack: [f32; 3] = std::array::from_fn(|c| {
                let rho = rho[c];
                let of_facets = if is_tabulated { change(&finish, wi, given)[0] } else { value * share + ended };
                // Half floats of two losses and of what is returned.
                value * TEXEL + rho.abs() * of_facets + several[c] * 3.0 * TEXEL
            });
            let [r, g, b] = std::array::from_fn(|c| rho[c] * value + several[c]);
            println!("{r},{g},{b},{pdf},{},{},{},{slack_of_pdf}", slack[0], slack[1], slack[2]);
        }
    }
    Ok(())
}
