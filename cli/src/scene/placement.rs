//! Placement of a mesh in the period of its cell.
//!
//! A cell has z up, nanometres, and fills 0 to its period in x and y. Modelling programs export y up, another unit and
//! a mesh centred on 0. The keys `axes` and `unit_nm` state the first two. The third needs no key: a mesh that spans
//! exactly one period is moved to start at 0, since a periodic surface is the same wherever its period starts.

use super::mesh::Mesh;
use super::mesh_frame::MeshFrame;
use crate::obj::Axes;
use crate::support::error::{Error, Result};

/// Relative rounding of a span: modelling programs keep coordinates in single precision, good to some units in the last
/// place of the largest.
const SINGLE: f64 = 4.0 * f32::EPSILON as f64;

/// Relative difference of the factors span : period of both axes that counts as none: five digits in the file.
const SAME_FACTOR: f64 = 1e-5;

/// Moves a mesh that spans exactly one period to start at 0.
///
/// # Errors
/// If the mesh spans the period with other axes or in another unit.
pub(super) fn fit(mesh: &mut Mesh, period_nm: [f64; 2], frame: MeshFrame) -> Result<()> {
    let mut bounds = [[f64::INFINITY, f64::NEG_INFINITY]; 3];
    for vertex in &mesh.vertices {
        for (&x, [low, high]) in vertex.iter().zip(&mut bounds) {
            (*low, *high) = (low.min(x), high.max(x));
        }
    }
    let largest = bounds.iter().flatten().chain(&period_nm).fold(0.0, |max: f64, x| max.max(x.abs()));
    let resolution_nm = SINGLE * largest;
    let spans = bounds.map(|[low, high]| high - low);
    let is_period = |axis: usize| (spans[axis] - period_nm[axis]).abs() <= resolution_nm;
    if !(is_period(0) && is_period(1)) {
        return remedy(spans, period_nm, frame, resolution_nm).map_or(Ok(()), |remedy| {
            let line = mesh.triangles.first().map_or(1, |triangle| triangle.line);
            let [x, y, z] = spans.map(rounded);
            let [width, depth] = period_nm;
            let what =
                format!("the mesh spans {x} by {y} by {z} nm in x, y and z, but the period is {width} by {depth} nm");
            Err(Error::failed(format_args!("{}:{line}: {what}; {remedy}", mesh.path.display())))
        });
    }
    for axis in 0..2 {
        let ([low, high], period) = (bounds[axis], period_nm[axis]);
        if low >= -resolution_nm && high <= period + resolution_nm {
            continue;
        }
        for vertex in &mut mesh.vertices {
            let x = vertex[axis] - low;
            // Both ends were rounded far from 0.
            let end = [0.0, period].into_iter().find(|end| (x - end).abs() <= resolution_nm);
            vertex[axis] = end.unwrap_or(x);
        }
    }
    Ok(())
}

/// Remedy for a mesh that spans the period in other axes or another unit.
fn remedy(spans: [f64; 3], [width, depth]: [f64; 2], frame: MeshFrame, resolution_nm: f64) -> Option<String> {
    let [x, y, z] = spans;
    let other_axes = match frame.axes {
        Axes::ZUp => "if the file has y up, write axes = \"y-up\" in [cell]",
        Axes::YUp => "if the file has z up, remove axes from [cell]",
    };
    let near = |a: f64, b: f64| (a - b).abs() <= resolution_nm;
    if near(x, width) && near(z, depth) {
        return Some(other_axes.to_owned());
    }
    let factor = |span: f64| {
        let [f, g] = [width / x, depth / span];
        let is_one = f.is_finite() && g.is_finite() && (f / g - 1.0).abs() <= SAME_FACTOR;
        (is_one && (f - 1.0).abs() > SAME_FACTOR).then(|| rounded(f * frame.unit_nm))
    };
    if let Some(unit_nm) = factor(y) {
        return Some(format!("make them equal, or write unit_nm = {unit_nm} in [cell]"));
    }
    factor(z).map(|unit_nm| format!("{other_axes}, and unit_nm = {unit_nm}"))
}

/// Rounds to five digits.
fn rounded(x: f64) -> f64 {
    format!("{x:.4e}").parse().unwrap_or(x)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Triangle;

    fn mesh(vertices: &[[f64; 3]]) -> Mesh {
        let triangles = vec![Triangle { vertices: [0, 1, 2], interface: 0, line: 7 }];
        Mesh { vertices: vertices.to_vec(), triangles, path: "m.obj".into() }
    }

    #[test]
    fn a_mesh_of_one_period_starts_at_zero() {
        let mut centred = mesh(&[[-50.0, -25.0, -3.0], [50.0, 25.0, 9.0], [10.0, 5.0, 0.0]]);
        fit(&mut centred, [100.0, 50.0], MeshFrame::default()).unwrap();
        assert_eq!(centred.vertices, [[0.0, 0.0, -3.0], [100.0, 50.0, 9.0], [60.0, 30.0, 0.0]]);
        // Coordinates of single precision far away: the ends are still exactly the period's.
        let far = |x: f64| f64::from(x as f32 + 1000.1_f32);
        let mut moved = mesh(&[[far(0.0), 0.0, 0.0], [far(0.3), 50.0, 0.0], [far(0.1), 9.0, 0.0]]);
        fit(&mut moved, [0.3, 50.0], MeshFrame::default()).unwrap();
        assert_eq!([moved.vertices[0][0], moved.vertices[1][0]], [0.0, 0.3]);
        // What lies in its place is not touched.
        let inside = mesh(&[[1e-9, 0.0, 5.0], [100.0, 50.0, 9.0], [10.0, 5.0, 0.0]]);
        let mut same = inside.clone();
        fit(&mut same, [100.0, 50.0], MeshFrame::default()).unwrap();
        assert_eq!(same, inside);
    }

    #[test]
    fn other_axes_and_units_are_told_with_their_remedy() {
        let told = |high: [f64; 3], frame: MeshFrame| {
            let error = fit(&mut mesh(&[[0.0; 3], high, [0.0; 3]]), [2000.0, 1000.0], frame).unwrap_err();
            error.to_string()
        };
        assert_eq!(
            told([2000.0, 30.0, 1000.0], MeshFrame::default()),
            "m.obj:7: the mesh spans 2000 by 30 by 1000 nm in x, y and z, but the period is 2000 by 1000 nm; if the file has y up, write axes = \"y-up\" in [cell]"
        );
        let turned = MeshFrame { axes: Axes::YUp, ..MeshFrame::default() };
        assert!(told([2000.0, 30.0, 1000.0], turned).ends_with("if the file has z up, remove axes from [cell]"));
        assert!(
            told([2.0, 1.0, 0.1], MeshFrame::default()).ends_with("make them equal, or write unit_nm = 1000 in [cell]")
        );
        assert!(
            told([2e-6, 0.0, 1e-6], MeshFrame::default())
                .ends_with("write axes = \"y-up\" in [cell], and unit_nm = 1000000000")
        );
        // What no frame explains is for the checks of planes and edges to tell.
        assert!(
            fit(&mut mesh(&[[0.0; 3], [7.0, 9.0, 11.0], [0.0; 3]]), [2000.0, 1000.0], MeshFrame::default()).is_ok()
        );
        assert!(fit(&mut mesh(&[[0.0; 3]]), [2000.0, 1000.0], MeshFrame::default()).is_ok());
    }
}
