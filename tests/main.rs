//! The one integration binary: physics against independent references, the command line, the shape of the source.

mod allocation;
mod colour;
mod flow;
mod growth;
mod laws;
mod paper;
mod planar;
mod precise;
mod prose;
mod reference;
mod scalar;
mod scatter_table;
mod table_blob;
