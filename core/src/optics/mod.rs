//! Media, interfaces and multilayers: what a plane wave does at planes, in closed form.

pub mod medium;
pub mod incidence;
pub mod interface;
pub mod stack;
pub mod rounding;
pub mod coating;
