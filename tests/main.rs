//! The one integration binary: physics against independent references, the command line, the shape of the source.

mod colour;
mod planar;
mod reference;
