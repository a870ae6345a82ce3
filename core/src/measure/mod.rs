//! Sinks for the rays that leave a polygon mesh, by direction: bins over the hemisphere, and diffraction orders.

pub mod bins;
pub mod orders;
