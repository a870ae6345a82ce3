//! The body that wears the material in the file: a sphere of radius 1.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde_json::{Value, json};

/// Quadrangles around the sphere: the outline is off by 0.003 of the radius, and the sphere takes 45 KB of the file.
const AROUND: u16 = 40;
/// Quadrangles from pole to pole.
const DOWN: u16 = 20;

/// Mean chord of a sphere of radius 1 in isotropic light: 4 V/A.
pub const MEAN_CHORD: f64 = 4.0 / 3.0;

const ARRAY_BUFFER: u32 = 34962;
const ELEMENT_ARRAY_BUFFER: u32 = 34963;
const UNSIGNED_SHORT: u32 = 5123;
const FLOAT: u32 = 5126;

/// Points of the sphere, with y up. The normals are the points themselves.
fn points() -> Vec<[f32; 3]> {
    let mut points = Vec::new();
    for ring in 0..=DOWN {
        let (sin, cos) = (std::f64::consts::PI * f64::from(ring) / f64::from(DOWN)).sin_cos();
        for place in 0..=AROUND {
            // Both sides of the seam have the same points.
            let turn = std::f64::consts::TAU * f64::from(place % AROUND) / f64::from(AROUND);
            let sin = if ring == DOWN { 0.0 } else { sin };
            points.push([sin * turn.sin(), cos, sin * turn.cos()].map(|x| x as f32));
        }
    }
    points
}

/// Tangents at the points, eastwards, and 1 for a binormal that points north.
fn tangents() -> impl Iterator<Item = f32> {
    let at = |place: u16| {
        let turn = std::f64::consts::TAU * f64::from(place % AROUND) / f64::from(AROUND);
        [turn.cos(), 0.0, -turn.sin(), 1.0].map(|x| x as f32)
    };
    (0..=DOWN).flat_map(move |_| (0..=AROUND).flat_map(at))
}

/// Corners of the triangles, counter-clockwise seen from outside; at the poles a quadrangle is one triangle.
fn triangles() -> Vec<[u16; 3]> {
    let mut triangles = Vec::new();
    for ring in 0..DOWN {
        for place in 0..AROUND {
            let above = ring * (AROUND + 1) + place;
            let below = above + AROUND + 1;
            if ring > 0 {
                triangles.push([above, below, above + 1]);
            }
            if ring + 1 < DOWN {
                triangles.push([above + 1, below, below + 1]);
            }
        }
    }
    triangles
}

/// Adds a scene with the sphere, in material 0, to a glTF file; with tangents, if the material has a direction.
///
/// # Panics
/// Never: the lists that it extends are its own.
pub fn add(file: &mut Value, has_direction: bool) {
    let (points, triangles) = (points(), triangles());
    let place = |i: u16, count: u16| (u32::from(i) * u32::from(u16::MAX) / u32::from(count)) as u16;
    let uv = (0..=DOWN).flat_map(|ring| (0..=AROUND).map(move |at| [place(at, AROUND), place(ring, DOWN)]));
    let point_bytes: Vec<u8> = points.as_flattened().iter().flat_map(|x| x.to_le_bytes()).collect();
    let uv_bytes: Vec<u8> = uv.flatten().flat_map(u16::to_le_bytes).collect();
    let index_bytes: Vec<u8> = triangles.as_flattened().iter().flat_map(|i| i.to_le_bytes()).collect();
    // Normals have bytes of their own: programs that move the points in place would else move the normals too.
    let parts = [
        (&point_bytes, ARRAY_BUFFER),
        (&point_bytes, ARRAY_BUFFER),
        (&uv_bytes, ARRAY_BUFFER),
        (&index_bytes, ELEMENT_ARRAY_BUFFER),
    ];
    let (mut bytes, mut views) = (Vec::new(), Vec::new());
    let tangent_bytes: Vec<u8> = tangents().flat_map(f32::to_le_bytes).collect();
    let tangents = has_direction.then_some((&tangent_bytes, ARRAY_BUFFER));
    for (part, target) in parts.into_iter().chain(tangents) {
        views.push(json!({ "buffer": 0, "byteOffset": bytes.len(), "byteLength": part.len(), "target": target }));
        bytes.extend(part);
    }
    let count = points.len();
    file["scene"] = json!(0);
    file["scenes"] = json!([{ "nodes": [0] }]);
    file["nodes"] = json!([{ "name": "body", "mesh": 0 }]);
    file["meshes"] = json!([{ "name": "sphere", "primitives": [{
        "attributes": { "POSITION": 0, "NORMAL": 1, "TEXCOORD_0": 2 }, "indices": 3, "material": 0,
    }] }]);
    file["accessors"] = json!([
        { "bufferView": 0, "componentType": FLOAT, "count": count, "type": "VEC3", "min": [-1, -1, -1], "max": [1, 1, 1] },
        { "bufferView": 1, "componentType": FLOAT, "count": count, "type": "VEC3" },
        { "bufferView": 2, "componentType": UNSIGNED_SHORT, "normalized": true, "count": count, "type": "VEC2" },
        { "bufferView": 3, "componentType": UNSIGNED_SHORT, "count": 3 * triangles.len(), "type": "SCALAR" },
    ]);
    if has_direction {
        file["meshes"][0]["primitives"][0]["attributes"]["TANGENT"] = json!(4);
        let tangents = json!({ "bufferView": 4, "componentType": FLOAT, "count": count, "type": "VEC4" });
        file["accessors"].as_array_mut().expect("an array, above").push(tangents);
    }
    file["bufferViews"] = json!(views);
    let uri = format!("data:application/octet-stream;base64,{}", STANDARD.encode(&bytes));
    file["buffers"] = json!([{ "byteLength": bytes.len(), "uri": uri }]);
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;

    #[test]
    fn the_sphere_is_closed_and_seen_from_outside() {
        let points: Vec<Vec3> = points().into_iter().map(Vec3::from_array).collect();
        assert!(points.iter().all(|point| (point.length() - 1.0).abs() < 1e-6));
        let bounds = points.iter().fold([Vec3::MAX, Vec3::MIN], |[low, high], p| [low.min(*p), high.max(*p)]);
        assert_eq!(bounds, [Vec3::NEG_ONE, Vec3::ONE]);
        let mut area = 0.0;
        let mut turned = Vec3::ZERO;
        for corners in triangles() {
            let [a, b, c] = corners.map(|i| points[usize::from(i)]);
            let facing = (b - a).cross(c - a);
            assert!(facing.dot(a + b + c) > 0.0, "{corners:?}");
            area += 0.5 * facing.length();
            turned += facing;
        }
        // The area within 1 % of 4π, and no side missing.
        assert!((area / (4.0 * std::f32::consts::PI) - 1.0).abs() < 0.01 && turned.length() < 1e-4, "{area} {turned}");
    }

    #[test]
    fn the_file_holds_the_bytes_that_it_describes() {
        let mut file = json!({});
        add(&mut file, false);
        let uri = file["buffers"][0]["uri"].as_str().unwrap();
        let bytes = STANDARD.decode(uri.split_once(',').unwrap().1).unwrap();
        assert_eq!(file["buffers"][0]["byteLength"], json!(bytes.len()));
        let last = file["bufferViews"].as_array().unwrap().last().unwrap();
        assert_eq!(last["byteOffset"].as_u64().unwrap() + last["byteLength"].as_u64().unwrap(), bytes.len() as u64);
        /// Largest sphere in bytes; the file is small enough for a mail.
        const MAX_BYTES: usize = 50_000;
        assert!(uri.len() < MAX_BYTES, "{}", uri.len());
    }

    #[test]
    fn tangents_lie_across_normals_and_follow_the_texture() {
        let tangents: Vec<f32> = tangents().collect();
        let points = points();
        assert_eq!(tangents.len(), 4 * points.len());
        for (i, (tangent, normal)) in tangents.as_chunks::<4>().0.iter().zip(&points).enumerate() {
            let &[x, y, z, sign] = tangent;
            let (tangent, normal) = (Vec3::new(x, y, z), Vec3::from_array(*normal));
            assert!(tangent.dot(normal).abs() < 1e-6 && (tangent.length() - 1.0).abs() < 1e-6 && sign == 1.0);
            // Eastwards u grows, northwards v falls.
            if i % (usize::from(AROUND) + 1) < usize::from(AROUND) {
                assert!(tangent.dot(Vec3::from_array(points[i + 1]) - normal) >= 0.0);
            }
            assert!(normal.cross(tangent).y >= 0.0);
        }
        let mut file = json!({});
        add(&mut file, true);
        let last = file["bufferViews"].as_array().unwrap().last().unwrap();
        let end = last["byteOffset"].as_u64().unwrap() + last["byteLength"].as_u64().unwrap();
        assert_eq!(file["buffers"][0]["byteLength"], json!(end));
        assert_eq!(file["accessors"][4]["count"], json!(points.len()));
    }
}
