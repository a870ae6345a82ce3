//! What leaves a cell of polygons, by direction: bins over the hemisphere and diffraction orders.

pub mod bins;
pub mod orders;
