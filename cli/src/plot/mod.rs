//! Pictures: every chart is drawn once, as SVG elements and as the shapes of its PNG, with the letters of the bundled
//! fonts.

mod encode;
mod gamut;
mod raster;
mod font;
mod place;
mod paint;
mod svg;
mod picture;
mod axis;
mod layout;
mod swatch;
mod line_chart;
mod disc;
mod heat_map;
mod chromaticity;
mod compare;
pub mod tables;

pub use chromaticity::{ColourAt, chromaticity, xy};
pub use compare::{Profile, side_by_side};
pub use disc::{Disc, Mark, MarkShape, disc, disc_grid, marked_disc};
pub use encode::{grey, hex, in_gamut, srgb, srgb8, wavelength_colour};
pub use gamut::OutOfGamut;
pub use heat_map::{HeatAxis, heat_map};
pub use layout::rows;
pub use line_chart::{Dash, LineOptions, PALETTE, Series, line_chart};
pub use picture::{PNG_SCALE, Picture, PictureFormat};
pub use raster::Raster;
pub(crate) use svg::escape;
pub use swatch::swatches;
