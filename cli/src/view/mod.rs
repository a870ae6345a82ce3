//! The interactive page of a surface in light: one HTML file that needs no network.
//!
//! `page/` holds the HTML, CSS and JavaScript that a browser runs, `shaders/` the shaders that its GPU runs. This
//! module puts them together with a table, meshes and lights. The page follows `render`: it has the same meshes,
//! camera, lights, frames and gamut policy.

mod pack;
mod shape;
mod orders;
mod table;

use goniochrome::microfacet::Finish;
use serde_json::{Value, json};

use crate::plot::escape;
use crate::render::camera::View;
use crate::render::lamp::{EDGE, Lamp, SURROUNDINGS};
use crate::render::spread::Spread;
use crate::render::studio::{CEILING, FLOOR, HORIZON, SOFT_BOXES};
use crate::render::thickness::ThicknessMap;
use crate::support::error::{Error, Result};
use crate::support::text;
use crate::table::Table;

/// Largest page in bytes; phones do not open larger ones.
pub const MAX_BYTES: usize = 48 << 20;

/// Scripts of the page, each after those that it uses.
const SCRIPTS: [&str; 15] = [
    include_str!("page/basics.js"),
    include_str!("page/colour.js"),
    include_str!("page/finish.js"),
    include_str!("page/table.js"),
    include_str!("page/orders.js"),
    include_str!("page/shape.js"),
    include_str!("page/camera.js"),
    include_str!("page/exr.js"),
    include_str!("page/images.js"),
    include_str!("page/samples.js"),
    include_str!("page/levels.js"),
    include_str!("page/finished.js"),
    include_str!("page/renderer.js"),
    include_str!("page/charts.js"),
    include_str!("page/main.js"),
];

/// Shaders of the page by name; `common` is put before each fragment shader.
const SHADERS: [(&str, &str); 21] = [
    ("surface", include_str!("shaders/surface.vert")),
    ("screen", include_str!("shaders/screen.vert")),
    ("common", include_str!("shaders/common.glsl")),
    ("light", include_str!("shaders/light.glsl")),
    ("frame", include_str!("shaders/frame.glsl")),
    ("mirror", include_str!("shaders/mirror.frag")),
    ("levels", include_str!("shaders/levels.glsl")),
    ("level", include_str!("shaders/level.frag")),
    ("returned", include_str!("shaders/returned.frag")),
    ("finish", include_str!("shaders/finish.frag")),
    ("scatter", include_str!("shaders/scatter.frag")),
    ("prepare", include_str!("shaders/prepare.frag")),
    ("settle", include_str!("shaders/settle.frag")),
    ("cube", include_str!("shaders/cube.frag")),
    ("orders", include_str!("shaders/orders.frag")),
    ("around", include_str!("shaders/around.frag")),
    ("bake", include_str!("shaders/bake.frag")),
    ("spread", include_str!("shaders/spread.frag")),
    ("background", include_str!("shaders/background.frag")),
    ("add", include_str!("shaders/add.frag")),
    ("display", include_str!("shaders/display.frag")),
];

/// How a page shows a table.
#[derive(Clone, Debug, Default)]
pub struct PageChoice<'f> {
    /// Width of diffraction orders and facet lobes.
    pub spread: Option<Spread>,
    /// Finish of a mirror-like surface.
    pub finish: Option<Finish<'f>>,
    /// Whether light goes through a mirror-like surface.
    pub is_sheet: bool,
    /// Where a film is how thick; without it a slider says how thick it is everywhere.
    pub thickness: Option<ThicknessMap>,
}

/// The HTML page of a table.
///
/// # Errors
/// A damaged table, a table without colours, or one that is too large for a page.
pub fn page(table: &Table, choice: &PageChoice<'_>) -> Result<String> {
    let PageChoice { spread, finish, is_sheet, thickness } = choice;
    table.check()?;
    let shaders: serde_json::Map<String, Value> =
        SHADERS.into_iter().map(|(name, text)| (name.to_owned(), text.into())).collect();
    let data = json!({
        "table": table::packed(table, *finish, *is_sheet)?,
        "shapes": shape::packed(thickness.as_ref())?,
        "studio": studio(),
        "lamp": lamp(),
        "spread": spread.map(|width| json!({ "rows": width.rows(), "concentration": width.concentration() })),
        "view": view(),
        "shaders": shaders,
    });
    let html = include_str!("page/page.html")
        // Neither a name nor data can be taken for a place in the page.
        .replace("{{name}}", &escape(table.name()).replace("{{", "&#123;{"))
        .replace("{{version}}", env!("CARGO_PKG_VERSION"))
        .replace("{{style}}", include_str!("page/style.css"))
        // Escaped, no text of a table can end the script that holds it.
        .replace("{{data}}", &text::json(&data.to_string()).replace('<', "\\u003c").replace("{{", "\\u007b{"))
        .replace("{{script}}", &SCRIPTS.concat());
    if html.len() > MAX_BYTES {
        return Err(Error::failed(format_args!(
            "the page would have {} MB, more than the {} that browsers open with ease; estimate a table of fewer directions or \
             wavelengths",
            html.len() >> 20,
            MAX_BYTES >> 20
        )));
    }
    Ok(html)
}

/// The numbers of [`crate::render::studio`], for the page.
fn studio() -> Value {
    let boxes: Vec<Value> = SOFT_BOXES
        .iter()
        .map(|soft_box| {
            let [towards, right, up] = soft_box.axes().map(|axis| axis.to_array());
            json!({
                "towards": towards, "right": right, "up": up,
                "halfExtent": soft_box.half_extent, "softness": soft_box.softness, "radiance": soft_box.radiance,
            })
        })
        .collect();
    json!({ "ceiling": CEILING, "horizon": HORIZON, "floor": FLOOR, "boxes": boxes })
}

/// The lamp of [`crate::render::lamp`], for the page.
fn lamp() -> Value {
    let lamp = Lamp::default();
    json!({
        "towards": lamp.towards().to_array(),
        "radius": lamp.radius(),
        "edge": EDGE,
        "radiance": lamp.middle(),
        "surroundings": SURROUNDINGS,
    })
}

/// The camera's first view, for the page.
fn view() -> Value {
    let View { azimuth_deg, elevation_deg, field_of_view_deg, .. } = View::default();
    json!({ "azimuth": azimuth_deg, "elevation": elevation_deg, "fieldOfView": field_of_view_deg })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Largest page of a 2D table in bytes: small enough to send by mail.
    const MAX_BYTES_2D: usize = 2_000_000;

    fn mirror() -> Table {
        let mut table = crate::table::mirror::tests::sample();
        table.metadata.insert("scene", "</script><b>\"films\" & {{data}}");
        table.into()
    }

    #[test]
    fn a_page_is_one_small_file_that_needs_no_network() {
        let orders = crate::table::orders::tests::sample().into();
        for table in [mirror(), crate::table::scatter::tests::sample().into(), orders] {
            let html = page(&table, &PageChoice::default()).unwrap();
            assert!(html.len() < MAX_BYTES_2D, "{}: {}", table.name(), html.len());
            // A place in the page itself is not an address.
            let html = html.replace("url(#", "");
            for part in ["http:", "https:", "src=\"", "@import", "url(", "{{name}}", "{{style}}", "{{script}}"] {
                assert!(!html.contains(part), "{part}");
            }
            assert!(html.contains("default-src 'none'"));
            assert_eq!(html.matches("<script").count(), html.matches("</script>").count());
        }
    }

    #[test]
    fn names_of_scenes_stay_text() {
        let html = page(&mirror(), &PageChoice { is_sheet: true, ..PageChoice::default() }).unwrap();
        assert!(html.contains("<title>&lt;/script&gt;&lt;b&gt;"));
        assert!(!html.contains("</script><b>"));
    }

    #[test]
    fn damaged_tables_are_refused() {
        let mut table = crate::table::mirror::tests::sample();
        table.rgb[0][0] = f32::NAN;
        assert!(page(&table.into(), &PageChoice::default()).unwrap_err().to_string().contains("is not finite"));
    }
}
