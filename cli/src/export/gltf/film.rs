//! The scenes that `KHR_materials_iridescence` describes: one clear film in air on any base, and the light that the
//! film transmits.

use goniochrome::optics::interface::Below;
use goniochrome::optics::medium::MediumIndex;
use num_complex::Complex64;

use crate::solve::planar_scene::PlanarScene;
use crate::support::error::{Error, Result};

/// A single film in the terms of the extension.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SingleFilm {
    /// Refractive index of the film at 550 nm.
    pub ior: f64,
    /// Thickness of the film.
    pub thickness_nm: f64,
    /// The base of the film.
    pub base: Base,
    /// The path of the light that enters the base.
    pub behind: Behind,
}

/// The medium behind a film, in the terms of glTF.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Behind {
    /// A metal, or a medium that absorbs light within wavelengths: no light is transmitted.
    Opaque,
    /// Air, as in front of the film: a thin wall, through which light passes without refraction.
    Air,
    /// A transparent medium: a solid body.
    Body {
        /// Refractive index at 550 nm.
        ior: f64,
        /// Absorption coefficients 4πk/λ of red, green and blue, in 1/m.
        absorption_per_m: [f64; 3],
    },
}

/// The base of a film, in the terms of glTF.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Base {
    /// A dielectric (`KHR_materials_ior`): light that is not reflected goes on into [`SingleFilm::behind`].
    Dielectric {
        /// Refractive index.
        ior: f64,
    },
    /// A metal, whose base colour is the reflectance under air at normal incidence, linear sRGB.
    Metal {
        /// Reflectance of red, green and blue, each in [0, 1].
        f0: [f64; 3],
    },
}

/// Wavelengths at which indices are checked: the observer's range without its faint ends.
const CHECKED_NM: [f64; 7] = [420.0, 465.0, 500.0, 550.0, 580.0, 610.0, 660.0];
/// Wavelengths that stand for red, green and blue.
const RGB_NM: [f64; 3] = [610.0, 550.0, 465.0];
/// Wavelength at which a medium's single index is taken.
const MIDDLE_NM: f64 = 550.0;

/// Largest difference from 1, the extension's index of the outside, that is still air, whose index is 1.0003.
const MAX_AIR_DIFFERENCE: f64 = 1e-3;
/// Largest share of light that a film may absorb on its way there and back at normal incidence; the extension's film is
/// clear.
const MAX_ABSORBED: f64 = 0.01;
/// Largest k of a dielectric base: it reflects k²/(n + 1)² more than a clear one, less than 1e-6.
const MAX_CLEAR_K: f64 = 1e-3;

impl SingleFilm {
    /// The film of a planar scene.
    ///
    /// # Errors
    /// A scene that the extension cannot describe, with the reason.
    pub fn of(planar: &PlanarScene<'_>) -> Result<Self> {
        let name = &planar.scene().name;
        let refuse =
            |why: String| Err(Error::failed(format_args!("{name}: {why}; export a lut, which holds any stack")));
        if !planar.spreads().is_empty() {
            return refuse("its film has no single thickness (spread_nm)".into());
        }
        let mut buffer = planar.buffer();
        let stack = planar.stack(&mut buffer)?;
        let films = stack.planes() - 1;
        if films != 1 {
            return refuse(format!("glTF's iridescence is a single film, and this stack has {films} layers"));
        }
        let outside = index(planar, stack.ambient(), MIDDLE_NM)?;
        if (outside - 1.0).norm() > MAX_AIR_DIFFERENCE {
            let outside = outside.re;
            return refuse(format!("glTF's film lies under air, and this one under a medium of index {outside:.3}"));
        }
        let film = stack.film(0);
        for nm in CHECKED_NM {
            let eta = index(planar, film.medium, nm)?;
            let absorbed = 1.0 - (-8.0 * std::f64::consts::PI * eta.im * film.thickness_nm / nm).exp();
            if absorbed > MAX_ABSORBED {
                let percent = 100.0 * absorbed;
                return refuse(format!(
                    "glTF's film is clear, and this one absorbs {percent:.0} % of the light at {nm} nm on its way there and back"
                ));
            }
            if eta.re < 1.0 {
                return refuse(format!("glTF's film has an index of 1 or more, and this one {:.3} at {nm} nm", eta.re));
            }
        }
        let (base, behind) = base(planar, stack.substrate())?;
        Ok(Self { ior: index(planar, film.medium, MIDDLE_NM)?.re, thickness_nm: film.thickness_nm, base, behind })
    }
}

/// The base of a film, and the medium behind it.
fn base(planar: &PlanarScene<'_>, below: Below) -> Result<(Base, Behind)> {
    let Below::Medium(medium) = below else { return Ok((Base::Metal { f0: [1.0; 3] }, Behind::Opaque)) };
    let mut clear = true;
    for nm in CHECKED_NM {
        let eta = index(planar, medium, nm)?;
        clear &= eta.im < MAX_CLEAR_K && eta.re >= 1.0;
    }
    if clear {
        let eta = index(planar, medium, MIDDLE_NM)?;
        let base = Base::Dielectric { ior: eta.re };
        if (eta - 1.0).norm() <= MAX_AIR_DIFFERENCE {
            return Ok((base, Behind::Air));
        }
        let mut absorption_per_m = [0.0; 3];
        for (absorption, nm) in absorption_per_m.iter_mut().zip(RGB_NM) {
            *absorption = 4.0 * std::f64::consts::PI * index(planar, medium, nm)?.im / (nm * 1e-9);
        }
        return Ok((base, Behind::Body { ior: eta.re, absorption_per_m }));
    }
    let mut f0 = [0.0; 3];
    for (f0, nm) in f0.iter_mut().zip(RGB_NM) {
        let eta = index(planar, medium, nm)?;
        *f0 = ((eta - 1.0) / (eta + 1.0)).norm_sqr();
    }
    Ok((Base::Metal { f0 }, Behind::Opaque))
}

/// The complex refractive index of a medium at a wavelength.
fn index(planar: &PlanarScene<'_>, medium: MediumIndex, nm: f64) -> Result<Complex64> {
    let place = usize::from(medium);
    planar.media()[place].eta(nm).map_err(|error| planar.scene().medium_error(place, &error))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene;

    fn film(stack: &str) -> Result<SingleFilm> {
        let scene = scene::parse("film", &format!("[stack]\n{stack}\n")).unwrap();
        SingleFilm::of(&PlanarScene::new(&scene).unwrap())
    }

    #[test]
    fn single_films_are_taken() {
        let soap = "ambient = 'air'\nlayers = [{ material = 1.33, thickness_nm = 320 }]\nsubstrate = ";
        let on = |base: &str| film(&format!("{soap}{base}")).unwrap();
        let behind = Behind::Body { ior: 1.5, absorption_per_m: [0.0; 3] };
        assert_eq!(
            on("1.5"),
            SingleFilm { ior: 1.33, thickness_nm: 320.0, base: Base::Dielectric { ior: 1.5 }, behind }
        );
        assert_eq!(on("'mirror'").base, Base::Metal { f0: [1.0; 3] });
        let Base::Metal { f0: [r, g, b] } = on("'Au'").base else { panic!("gold is a metal") };
        assert!(r > 0.9 && (0.5..0.95).contains(&g) && b < 0.5, "{r} {g} {b}");
    }

    #[test]
    fn light_goes_through_air_and_clear_media_and_not_through_metals() {
        let behind = |base: &str| {
            let stack =
                format!("ambient = 'air'\nlayers = [{{ material = 1.33, thickness_nm = 320 }}]\nsubstrate = {base}");
            film(&stack).unwrap().behind
        };
        assert_eq!((behind("'air'"), behind("1.0")), (Behind::Air, Behind::Air));
        for opaque in ["'mirror'", "'Au'", "[1.5, 0.01]"] {
            assert_eq!(behind(opaque), Behind::Opaque, "{opaque}");
        }
        let Behind::Body { ior, absorption_per_m: [r, g, b] } = behind("[1.5, 1e-7]") else {
            panic!("glass is a body")
        };
        // 4π · 1e-7 / 610 nm and so on.
        assert!(ior == 1.5 && (r - 2.0601).abs() < 1e-4 && (g - 2.2848).abs() < 1e-4 && (b - 2.7024).abs() < 1e-4);
    }

    #[test]
    fn what_is_no_clear_single_film_in_air_is_refused_with_the_reason() {
        let layer = "{ material = 1.33, thickness_nm = 320 }";
        for (stack, says) in [
            (format!("ambient = 1\nlayers = [{layer}, {layer}]\nsubstrate = 1.5"), "has 2 layers"),
            ("ambient = 1\nlayers = []\nsubstrate = 1.5".into(), "has 0 layers"),
            (format!("ambient = 1.5\nlayers = [{layer}]\nsubstrate = 1"), "under a medium of index 1.500"),
            ("ambient = 1\nlayers = [{ material = 'Au', thickness_nm = 20 }]\nsubstrate = 1".into(), "absorbs"),
            ("ambient = 1\nlayers = [{ material = 0.9, thickness_nm = 20 }]\nsubstrate = 1".into(), "0.900 at 420 nm"),
        ] {
            let error = film(&stack).unwrap_err();
            assert_eq!(error.exit_code(), 1);
            let line = error.to_string();
            assert!(line.contains(says) && line.ends_with("export a lut, which holds any stack"), "{stack}: {line}");
        }
    }
}
