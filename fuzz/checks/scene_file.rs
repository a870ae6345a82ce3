//! Fuzzing of scene files from any text. A planar scene that can be read gives a stack.

use goniochrome_cli::scene::{self, Shape};
use goniochrome_cli::solve::planar_scene::PlanarScene;

/// Checks any bytes that are text.
pub fn check(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    match scene::parse("fuzz.toml", text) {
        Err(error) => assert!(!error.to_string().contains('\n')),
        Ok(scene) => {
            assert!(scene.files.is_empty());
            if let Shape::Mesh(_) = scene.shape {
                return; // a surface that the text describes
            }
            let planar = PlanarScene::new(&scene).expect("planes are planar");
            let mut buffer = planar.buffer();
            planar.stack(&mut buffer).expect("the buffer is that of the scene");
            let _ = planar.longest_optical_path_nm([380.0, 780.0]);
        }
    }
}
