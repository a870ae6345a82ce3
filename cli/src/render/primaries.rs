//! Conversion of R, G, B of any primaries to Rec. 709, the primaries of environments.

use glam::{DMat3, DVec3};

/// Chromaticities x and y of red, green, blue and white.
pub(super) type Primaries = [[f64; 2]; 4];

/// The primaries and the white of Rec. 709 and sRGB.
const REC_709: Primaries = [[0.64, 0.33], [0.30, 0.60], [0.15, 0.06], [0.3127, 0.3290]];

/// Largest difference of a chromaticity that still counts as Rec. 709: files round to two digits, and Radiance puts
/// green at 0.29.
const MAX_DIFFERENCE: f64 = 0.015;

/// Bradford's cone responses, row by row: the chromatic adaptation of ICC profiles.
const BRADFORD: [[f64; 3]; 3] = [[0.8951, 0.2664, -0.1614], [-0.7502, 1.7135, 0.0367], [0.0389, -0.0685, 1.0296]];

/// Whether red, green and blue are those of Rec. 709. White is not compared: Radiance writes that of equal energy and
/// means, as all programs do, that equal components are white.
pub(super) fn are_rec_709(primaries: &Primaries) -> bool {
    let differences = primaries[..3].as_flattened().iter().zip(REC_709.as_flattened()).map(|(a, b)| (a - b).abs());
    differences.fold(0.0, f64::max) <= MAX_DIFFERENCE
}

/// The matrix that converts R, G, B to Rec. 709 and keeps white white. `None` if the primaries span no colours.
pub(super) fn to_rec_709(primaries: &Primaries) -> Option<DMat3> {
    let here = to_xyz(primaries)?;
    let there = to_xyz(&REC_709)?;
    let bradford = DMat3::from_cols_array_2d(&BRADFORD).transpose();
    let cones = |[x, y]: [f64; 2]| bradford * xyz([x, y]);
    let adapted = bradford.inverse() * DMat3::from_diagonal(cones(REC_709[3]) / cones(primaries[3])) * bradford;
    let matrix = there.inverse() * adapted * here;
    matrix.is_finite().then_some(matrix)
}

/// X, Y, Z of a chromaticity at luminance 1.
fn xyz([x, y]: [f64; 2]) -> DVec3 {
    DVec3::new(x / y, 1.0, (1.0 - x - y) / y)
}

/// The matrix from R, G, B to X, Y, Z, with luminance 1 for white. `None` if the primaries span no colours.
fn to_xyz(primaries: &Primaries) -> Option<DMat3> {
    // Chromaticities, not colours of luminance 1: a primary may have no luminance.
    let [red, green, blue] = [0, 1, 2].map(|i| {
        let [x, y] = primaries[i];
        DVec3::new(x, y, 1.0 - x - y)
    });
    let columns = DMat3::from_cols(red, green, blue);
    let strengths = columns.inverse() * xyz(primaries[3]);
    let matrix = columns * DMat3::from_diagonal(strengths);
    (columns.determinant() != 0.0 && matrix.is_finite() && matrix.inverse().is_finite()).then_some(matrix)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn published_matrices_come_out() {
        let rec_2020 = [[0.708, 0.292], [0.170, 0.797], [0.131, 0.046], [0.3127, 0.3290]];
        // ITU-R BT.2087, table 4.
        let rows_2020 = [[1.6605, -0.5876, -0.0728], [-0.1246, 1.1329, -0.0083], [-0.0182, -0.1006, 1.1187]];
        let aces_2065 = [[0.7347, 0.2653], [0.0, 1.0], [0.0001, -0.077], [0.32168, 0.33767]];
        // ACES 1.3, with Bradford's transform from D60 to D65.
        let rows_2065 = [[2.5217, -1.1341, -0.3876], [-0.2765, 1.3727, -0.0962], [-0.0154, -0.1530, 1.1684]];
        for (primaries, rows) in [(rec_2020, rows_2020), (aces_2065, rows_2065)] {
            let matrix = to_rec_709(&primaries).unwrap();
            let expected = DMat3::from_cols_array_2d(&rows).transpose();
            assert!((matrix - expected).to_cols_array().iter().all(|d| d.abs() < 2e-4), "{matrix}");
            assert!((matrix * DVec3::ONE).distance(DVec3::ONE) < 1e-9, "white stays white");
            assert!(!are_rec_709(&primaries));
        }
    }

    #[test]
    fn rec_709_is_known_and_what_spans_no_colours_refused() {
        assert!(are_rec_709(&REC_709));
        assert!(are_rec_709(&[[0.640, 0.330], [0.290, 0.600], [0.150, 0.060], [0.3333, 0.3333]]));
        assert!((to_rec_709(&REC_709).unwrap() - DMat3::IDENTITY).to_cols_array().iter().all(|d| d.abs() < 1e-12));
        assert_eq!(to_rec_709(&[[0.3, 0.3]; 4]), None);
        assert_eq!(to_rec_709(&[[0.64, 0.33], [0.3, 0.6], [0.15, 0.06], [0.3, 0.0]]), None);
        assert_eq!(to_rec_709(&[[f64::NAN; 2]; 4]), None);
    }
}
