//! The one integration binary: physics against independent references, the command line, the shape of the source.

mod planar;
mod reference;
