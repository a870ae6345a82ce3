//! Media, interfaces and multilayers: reflection and transmission of a plane wave, in closed form.

pub mod medium;
pub mod incidence;
pub mod interface;
pub mod stack;
pub mod rounding;
pub mod coating;
