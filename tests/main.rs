//! Tests of the core against independent references and the laws of physics, and tests of the form of the source.

mod allocation;
mod colour;
mod compensation;
mod finish;
mod flow;
mod growth;
mod laws;
mod paper;
mod planar;
mod precise;
mod prose;
mod random;
mod reference;
mod scalar;
mod scatter_table;
mod table_blob;
mod film_blob;
