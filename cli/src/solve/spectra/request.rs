//! The request for a computation of spectra.

use goniochrome::optics::interface::Model;

use crate::solve::precision::Precision;

/// The method by which the reflectance is computed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Method {
    /// The closed form of the planar stack.
    Stack,
    /// Ray splitting, every loop summed exactly.
    #[default]
    Trace,
    /// Ray splitting hit by hit. Samples whose sum diverges or takes too long fall back to closed loops, and are
    /// counted.
    Hits,
}

/// A request for spectra: what to compute and how.
#[derive(Clone, Copy, Debug)]
pub struct SpectraRequest {
    /// Exact physics, or the paper's words taken literally.
    pub model: Model,
    /// Closed form or ray tracing.
    pub method: Method,
    /// Single or double precision.
    pub precision: Precision,
    /// Worker threads; the result does not depend on it.
    pub threads: usize,
}
