//! Scenes for tests, and their directions.

use std::fs;

use glam::DVec3;
use goniochrome_cli::scene::{Scene, load};

/// The cell of a mesh given as text. `interfaces` are names, each with its two media and any coating as TOML.
pub fn cell(obj: &str, period_nm: [f64; 2], interfaces: &[(&str, String)]) -> Scene {
    let folder = tempfile::tempdir().expect("a temporary folder");
    fs::write(folder.path().join("mesh.obj"), obj).expect("a file in it");
    let mut toml = format!("[cell]\nmesh = \"mesh.obj\"\nperiod_nm = {period_nm:?}\n");
    for (name, body) in interfaces {
        toml += &format!("[interface.{name}]\n{body}\n");
    }
    let path = folder.path().join("scene.toml");
    fs::write(&path, toml).expect("a file in it");
    load(path.to_str().expect("a path of ASCII")).expect("a good scene")
}

/// The TOML of an interface between two media, given by n and k.
pub fn between(above: [f64; 2], below: [f64; 2]) -> String {
    format!("above = {}\nbelow = {}", index(above), index(below))
}

fn index([n, k]: [f64; 2]) -> String {
    if k == 0.0 { format!("{n:?}") } else { format!("[{n:?}, {k:?}]") }
}

/// The unit vector towards the light at these angles.
pub fn towards(theta_deg: f64, phi_deg: f64) -> DVec3 {
    let ((sin, cos), (sin_phi, cos_phi)) = (theta_deg.to_radians().sin_cos(), phi_deg.to_radians().sin_cos());
    DVec3::new(sin * cos_phi, sin * sin_phi, cos)
}

/// The OBJ text of sheets, each a profile h(x) extruded along y and lowered by its shift, with one face for each piece.
pub fn extruded(points_nm: &[[f64; 2]], width_nm: f64, sheets: &[(&str, f64)]) -> String {
    let mut obj = String::new();
    for (sheet, (name, shift)) in sheets.iter().enumerate() {
        for [x, h] in points_nm {
            obj += &format!("v {x} 0 {z}\nv {x} {width_nm} {z}\n", z = h - shift);
        }
        obj += &format!("usemtl {name}\n");
        let first = 1 + 2 * sheet * points_nm.len();
        for i in 0..points_nm.len() - 1 {
            let a = first + 2 * i;
            obj += &format!("f {} {} {} {}\n", a, a + 2, a + 3, a + 1);
        }
    }
    obj
}
