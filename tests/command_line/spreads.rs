//! Tests of layers whose thickness varies from place to place.

use crate::user::{User, column};

/// Promised error of a mean.
const MEAN: f64 = 1e-4;
/// Thicknesses along each axis of the reference, over 5 standard deviations to either side.
const PLACES: i32 = 201;

/// Columns of R and T at three angles.
fn powers(user: &User, scene: &str) -> Vec<f64> {
    user.write("s.toml", scene);
    let csv = user.ok("spectrum s.toml --theta 0,50,85 --wavelengths 400,550,700 --precision f64").stdout;
    ["R_s", "R_p", "T_s", "T_p"].iter().flat_map(|name| column(&csv, name)).collect()
}

/// Checks the mean of a stack against that of `places` thicknesses for each layer, by the same command.
fn compare(layers: &[(&str, f64, f64)], substrate: &str, places: i32) {
    let user = User::new();
    let stack = |thickness: &dyn Fn(usize) -> f64, spread: &dyn Fn(usize) -> String| {
        let layers: Vec<String> = (0..layers.len())
            .map(|i| format!("{{ material = {}, thickness_nm = {:?}{} }}", layers[i].0, thickness(i), spread(i)))
            .collect();
        format!("[stack]\nambient = 1.0\nlayers = [{}]\nsubstrate = {substrate}\n", layers.join(", "))
    };
    let mean = powers(&user, &stack(&|i| layers[i].1, &|i| format!(", spread_nm = {}", layers[i].2)));
    let step = 10.0 / f64::from(places - 1);
    let deviation = |place: i32| step * f64::from(place) - 5.0;
    let (mut sum, mut whole) = (vec![0.0; mean.len()], 0.0);
    let count = places.pow(layers.len() as u32);
    for place in 0..count {
        let x = [place % places, place / places].map(deviation);
        let weight = (0..layers.len()).map(|i| (-0.5 * x[i] * x[i]).exp()).product::<f64>();
        let here = powers(&user, &stack(&|i| layers[i].1 + x[i] * layers[i].2, &|_| String::new()));
        sum.iter_mut().zip(here).for_each(|(sum, power)| *sum += weight * power);
        whole += weight;
    }
    for (mean, sum) in mean.iter().zip(&sum) {
        assert!((mean - sum / whole).abs() <= MEAN, "{layers:?}: {mean} for {}", sum / whole);
    }
}

#[test]
fn a_mean_over_thicknesses_is_that_of_many_films() {
    compare(&[("1.33", 420.0, 50.0)], "1.0", PLACES);
    compare(&[("\"TiO2\"", 60.0, 6.0)], "\"Ti\"", PLACES);
    // 41 thicknesses of each of two thin layers are enough for the reference: their fringes are wide.
    compare(&[("2.4", 80.0, 8.0), ("1.5", 120.0, 10.0)], "\"Al\"", 41);
}

#[test]
fn repeated_layers_vary_together_and_what_cannot_vary_is_refused() {
    let user = User::new();
    let stack = |layers: &str| format!("[stack]\nambient = 1.0\nlayers = [{layers}]\nsubstrate = 1.5\n");
    let one = "{ material = 1.33, thickness_nm = 200.0, spread_nm = 20.0 }";
    // Two halves that vary together are one film that varies twice as much.
    let halves = powers(&user, &stack(&format!("{{ repeat = 2, layers = [{one}] }}")));
    let whole = powers(&user, &stack("{ material = 1.33, thickness_nm = 400.0, spread_nm = 40.0 }"));
    assert!(halves.iter().zip(&whole).all(|(a, b)| (a - b).abs() <= MEAN), "{halves:?} {whole:?}");
    user.write("thin.toml", stack("{ material = 1.33, thickness_nm = 100.0, spread_nm = 30.0 }"));
    user.refused("spectrum thin.toml", 1, &["layer 1: spread_nm 30", "at most 20"]);
    user.write("film.toml", stack(one));
    user.refused("export film.toml --to gltf -o f.gltf", 1, &["spread_nm", "export a lut"]);
    let many = [one; 5].join(", ");
    user.write("many.toml", stack(&many));
    user.refused("spectrum many.toml --theta 0", 1, &["more than 40000", "fewer layers"]);
}
