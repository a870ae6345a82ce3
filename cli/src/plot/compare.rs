//! Two calculations of one reflectance side by side, with their difference (figure 7 of the paper).

use super::disc::{Disc, disc_grid};
use super::encode::{grey, wavelength_colour};
use super::layout::rows;
use super::line_chart::{Dash, LineOptions, Series, line_chart};
use super::{Picture, axis};
use crate::table::mirror::neighbours;

/// Reflectance over the angle at one wavelength, by two calculations.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Profile<'a> {
    /// Vacuum wavelength in nanometres.
    pub wavelength_nm: f64,
    /// Angles from the normal in degrees, strictly increasing.
    pub theta_deg: &'a [f64],
    /// Reflectance by the calculation on the left, one per angle.
    pub left: &'a [f64],
    /// Reflectance by the calculation on the right, one per angle.
    pub right: &'a [f64],
}

/// A picture of two calculations: their curves and the difference, and below them grey discs.
///
/// The halves of the disc of each wavelength show the two calculations: where they agree, no seam is seen. Three
/// wavelengths, in increasing order, also make a coloured disc of each calculation, in which they are blue, green and
/// red, as in the paper. White is the larger of 1 and the largest reflectance.
///
/// # Panics
/// If a profile has no angle, or another number of reflectances than of angles.
#[must_use]
pub fn side_by_side(title: &str, left_label: &str, right_label: &str, profiles: &[Profile]) -> Picture {
    for profile in profiles {
        let count = profile.theta_deg.len();
        assert!(
            count > 0 && profile.left.len() == count && profile.right.len() == count,
            "profiles have equal lengths"
        );
    }
    let everything = || profiles.iter().flat_map(|p| p.left.iter().chain(p.right).copied());
    let shared = axis::range_of(everything().chain([0.0]), false);
    let chart = |title: &str, y_label: &str, log_y: bool, value: &dyn Fn(&Profile, usize) -> f64| {
        let curves: Vec<_> = profiles
            .iter()
            .map(|p| Series {
                label: format!("{} nm", p.wavelength_nm),
                colour: wavelength_colour(p.wavelength_nm),
                points: p.theta_deg.iter().enumerate().map(|(i, &theta)| (theta, value(p, i))).collect(),
                dash: Dash::None,
            })
            .collect();
        let y_range = (!log_y).then_some(shared);
        let options = LineOptions { log_y, x_range: Some((0.0, 90.0)), y_range, size: (380.0, 340.0) };
        line_chart(title, "angle from the normal θ / °", y_label, &curves, options)
    };
    let curves = vec![
        chart(left_label, "reflectance", false, &|p, i| p.left[i]),
        chart(right_label, "reflectance", false, &|p, i| p.right[i]),
        chart("Difference", "absolute difference", true, &|p, i| (p.left[i] - p.right[i]).abs()),
    ];

    let white = everything().filter(|v| v.is_finite()).fold(1.0, f64::max);
    let halves: Vec<_> = profiles
        .iter()
        .map(|p| {
            move |theta: f64, phi: f64| {
                let values = if (90.0..270.0).contains(&phi) { p.left } else { p.right };
                grey(interpolated(p.theta_deg, values, theta) / white)
            }
        })
        .collect();
    let discs: Vec<_> = profiles
        .iter()
        .zip(&halves)
        .map(|(p, rgb)| Disc { label: "", rgb, theta_max_deg: p.theta_deg[p.theta_deg.len() - 1], azimuthal: true })
        .collect();
    let names: Vec<_> = profiles.iter().map(|p| format!("{} nm", p.wavelength_nm)).collect();
    let heading = format!("Left half: {left_label}, right half: {right_label}");
    let grey_discs = disc_grid(&heading, &[String::new()], &names, &discs);
    match profiles {
        [blue, green, red] => {
            let coloured = composed([left_label, right_label], [red, green, blue], white);
            rows(title, &[curves, vec![coloured, grey_discs]])
        }
        _ => rows(title, &[curves, vec![grey_discs]]),
    }
}

/// A picture of a disc for each calculation, whose red, green and blue are three wavelengths.
fn composed(labels: [&str; 2], profiles: [&Profile; 3], white: f64) -> Picture {
    let of = |values: for<'p> fn(&'p Profile) -> &'p [f64]| {
        move |theta: f64, _: f64| profiles.map(|p| (interpolated(p.theta_deg, values(p), theta) / white) as f32)
    };
    let (left, right) = (of(|p| p.left), of(|p| p.right));
    let theta_max_deg = profiles[0].theta_deg.last().copied().unwrap_or(0.0);
    let disc = |rgb| Disc { label: "", rgb, theta_max_deg, azimuthal: false };
    let [red, green, blue] = profiles.map(|p| p.wavelength_nm);
    disc_grid(
        &format!("{blue}, {green}, {red} nm as blue, green, red"),
        &[String::new()],
        &labels.map(str::to_owned),
        &[disc(&left), disc(&right)],
    )
}

fn interpolated(x: &[f64], y: &[f64], at: f64) -> f64 {
    let (below, above, weight) = neighbours(x, at);
    y[below] + weight * (y[above] - y[below])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_sides_and_all_wavelengths_are_shown() {
        let theta = [0.0, 45.0, 90.0];
        let profile = |wavelength_nm, left, right| Profile { wavelength_nm, theta_deg: &theta, left, right };
        let (dark, light) = ([0.0; 3], [1.0; 3]);
        let picture = side_by_side("Check", "A", "B", &[profile(436.0, &dark, &light), profile(700.0, &light, &light)]);
        for text in [">Check<", ">A<", ">B<", ">436 nm<", ">700 nm<", ">reflectance<", ">absolute difference<"] {
            assert!(picture.svg().contains(text), "{text} is missing");
        }
        let pixels = crate::plot::picture::tests::pixels(&picture, 1.0);
        let grid = disc_grid(
            "Left half: A, right half: B",
            &[String::new()],
            &["436 nm".into(), "700 nm".into()],
            &[Disc { label: "", rgb: &|_, _| grey(0.0), theta_max_deg: 90.0, azimuthal: true }; 2],
        )
        .size();
        let left = 0.5 * (picture.size().0 - grid.0);
        let at = |disc: f64, dx: f64| {
            let (x, y) = (left + 24.0 + (disc + 0.5) * 166.0 + dx, 48.0 + 348.0 + 84.0 + 74.0);
            pixels.pixel(x as u32, y as u32).unwrap().green()
        };
        assert_eq!([at(0.0, -40.0), at(0.0, 40.0), at(1.0, -40.0), at(1.0, 40.0)], [0, 255, 255, 255]);
    }

    #[test]
    fn three_wavelengths_make_the_papers_coloured_discs() {
        let theta = [0.0, 90.0];
        let (dark, light) = ([0.0; 2], [1.0; 2]);
        let profile = |wavelength_nm, left, right| Profile { wavelength_nm, theta_deg: &theta, left, right };
        let profiles = [profile(436.0, &dark, &light), profile(546.0, &light, &dark), profile(700.0, &dark, &dark)];
        let picture = composed(["A", "B"], [&profiles[2], &profiles[1], &profiles[0]], 1.0);
        assert!(picture.svg().contains(">436, 546, 700 nm as blue, green, red<"));
        let pixels = crate::plot::picture::tests::pixels(&picture, 1.0);
        let at = |disc: f64| {
            let pixel = pixels.pixel((24.0 + (disc + 0.5) * 166.0) as u32, 84 + 60).unwrap();
            [pixel.red(), pixel.green(), pixel.blue()]
        };
        assert_eq!([at(0.0), at(1.0)], [[0, 255, 0], [0, 0, 255]]);
        let whole = side_by_side("Check", "A", "B", &profiles);
        assert!(whole.svg().contains("as blue, green, red") && whole.svg().contains("Left half: A, right half: B"));
    }

    #[allow(clippy::float_cmp, reason = "powers of two are exact")]
    #[test]
    fn profiles_are_interpolated_and_held_at_their_ends() {
        let at = |x| interpolated(&[10.0, 20.0, 40.0], &[1.0, 3.0, 5.0], x);
        assert_eq!([at(0.0), at(15.0), at(25.0), at(90.0)], [1.0, 2.0, 3.5, 5.0]);
    }
}
