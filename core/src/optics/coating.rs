//! A facet coated with films, in closed form and without memory: the practical way to put a multilayer on a surface of
//! tilted facets.
//!
//! The recursion is that of [`crate::optics::stack`]. Here each film is used once, so that its wave and its propagator
//! are computed as the recursion passes it. Without films the facet is bare, with reflection r and transmission 1 + r.

use crate::optics::interface::{Model, Wave, reflection};
use crate::optics::medium::MediaLanes;
use crate::optics::stack::{Film, Response};
use crate::simd::complex::{ComplexLanes, Polarised};
use crate::simd::lanes::Lanes;
use crate::simd::phase::propagate;

/// Response of a coated facet to a wave in `near`. `films` are given from the far side to the near side; `far` is
/// `None` for a mirror.
pub fn coated<'f, V: Lanes>(
    near: &Wave<V>,
    films: impl Iterator<Item = &'f Film>,
    far: Option<&Wave<V>>,
    media: &MediaLanes<'_, V>,
    tangential_squared: ComplexLanes<V::Precise>,
) -> Response<V> {
    let mut lower = far.copied();
    let mut sum: Option<Recursion<V>> = None;
    // Propagator of the film between the present interface and the one below.
    let mut crossed = ComplexLanes::one();
    for film in films {
        let eta = media.eta_of(film.medium);
        let wave = Wave::in_film(eta, tangential_squared);
        sum = Some(Recursion::up(sum, reflection(Model::Physical, &wave, lower.as_ref()), crossed));
        let path = V::Precise::splat(film.thickness_nm) / media.wavelength_nm();
        crossed = propagate(wave.normal.scale(path));
        lower = Some(wave);
    }
    Recursion::up(sum, reflection(Model::Physical, near, lower.as_ref()), crossed).response()
}

/// State of the recursion: ρ = numerator/denominator of all that lies below, and the amplitude that passes it times the
/// denominator.
#[derive(Clone, Copy)]
struct Recursion<V> {
    numerator: Polarised<ComplexLanes<V>>,
    denominator: Polarised<ComplexLanes<V>>,
    passed: Polarised<ComplexLanes<V>>,
}

impl<V: Lanes> Recursion<V> {
    /// Adds an interface of reflection `r` on top, separated from what lies below by a film of propagator `e`.
    #[inline]
    fn up(below: Option<Self>, r: Polarised<ComplexLanes<V>>, e: ComplexLanes<V>) -> Self {
        let one = ComplexLanes::one();
        let Some(Self { numerator, denominator, passed }) = below else {
            return Self { numerator: r, denominator: Polarised::both(one), passed: r.map(|r| one + r) };
        };
        let returned = numerator.map(|n| n * e * e);
        let sums = Self {
            numerator: Polarised {
                s: r.s.mul_add(denominator.s, returned.s),
                p: r.p.mul_add(denominator.p, returned.p),
            },
            denominator: Polarised {
                s: r.s.mul_add(returned.s, denominator.s),
                p: r.p.mul_add(returned.p, denominator.p),
            },
            passed: passed.zip(r, |passed, r| passed * e * (one + r)),
        };
        // Rescaled to near 1, so that no number of films leaves the range of single precision; 1e-30 guards 1/0.
        let scale = sums.denominator.zip(sums.numerator, |d, n| {
            V::one() / (d.re.abs() + d.im.abs() + n.re.abs() + n.im.abs() + V::splat(1e-30))
        });
        Self {
            numerator: sums.numerator.zip(scale, ComplexLanes::scale),
            denominator: sums.denominator.zip(scale, ComplexLanes::scale),
            passed: sums.passed.zip(scale, ComplexLanes::scale),
        }
    }

    fn response(&self) -> Response<V> {
        Response {
            reflection: self.numerator.zip(self.denominator, ComplexLanes::div_or_zero),
            transmission: self.passed.zip(self.denominator, ComplexLanes::div_or_zero),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::optics::interface::Below;
    use crate::optics::medium::Medium;
    use crate::optics::stack::{PreparedStack, PreparedStackArrays, Stack, StackArrays};
    use crate::simd::lanes::F64;
    use num_complex::Complex64;

    /// Bound of the difference of the two recursions, which round differently, for twenty layers of a strong mirror.
    const ROUNDING: f64 = 1e-12;

    #[test]
    fn a_coating_responds_as_the_stack_it_is() {
        let media = [Complex64::from(1.0), Complex64::new(2.3, 0.01), 1.38.into(), Complex64::new(1.5, 0.2)]
            .map(|eta| Medium::constant(eta).unwrap());
        let mut eta = [ComplexLanes::zero(); 4];
        let media = MediaLanes::<F64>::evaluate(&media, &[420.0, 550.0, 700.0], &mut eta).unwrap();
        let films: [Film; 20] = core::array::from_fn(|i| Film {
            medium: 1 + (i % 2) as u16,
            thickness_nm: if i % 2 == 0 { 58.5 } else { 99.6 },
        });
        for below in [Below::Medium(3), Below::Mirror] {
            let mut arrays = StackArrays::<21>::new();
            let stack = Stack::new(0, films, below, arrays.memory()).unwrap();
            let mut memory = PreparedStackArrays::<F64, 21>::new();
            let expected = PreparedStack::new(stack, &media, 0.6, Model::Physical, memory.memory()).response();

            let tangential_squared = ComplexLanes::real(<F64 as Lanes>::splat(0.36));
            let wave = |medium: usize| Wave::<F64>::new(media.eta()[medium], tangential_squared);
            let far = matches!(below, Below::Medium(_)).then(|| wave(3));
            let got = coated(&wave(0), films.iter().rev(), far.as_ref(), &media, tangential_squared);
            for lane in 0..3 {
                let near = |a: ComplexLanes<F64>, b: ComplexLanes<F64>| {
                    assert!((a.lane(lane) - b.lane(lane)).norm() < ROUNDING, "{a:?} {b:?}");
                };
                near(got.reflection.s, expected.reflection.s);
                near(got.reflection.p, expected.reflection.p);
                near(got.transmission.s, expected.transmission.s);
                near(got.transmission.p, expected.transmission.p);
            }
        }
    }
}
