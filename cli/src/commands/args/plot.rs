//! Arguments of `plot`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

use crate::solve::grid::Angles;

/// Arguments of `plot`.
#[derive(Debug, Args)]
pub struct PlotArgs {
    /// A table made by `estimate`, or a scene file or preset, whose table is made in memory
    #[arg(value_name = "TABLE|SCENE")]
    pub table: PathBuf,
    /// The picture (.png or .svg)
    #[arg(long, short, value_name = "FILE")]
    pub output: PathBuf,
    /// What to draw
    #[arg(long, value_enum, default_value_t = PlotKind::Disc)]
    pub kind: PlotKind,
    /// Angles of incidence in degrees [default: 0,45,75 for spectra, which take the nearest of the table; 15,45,75 for
    /// lobes and spectra of cells; 30 for the disc of a cell, which takes one; 0:75:15 to mark on the path of the
    /// colour]
    #[arg(long, allow_hyphen_values = true)]
    pub theta: Option<Angles>,
    /// Cells: azimuth of the light in degrees
    #[arg(long, default_value_t = 0.0, allow_negative_numbers = true)]
    pub phi: f64,
    /// Spectra of cells: angle of the direction towards the viewer [default: the angle of the light]
    #[arg(long, value_name = "DEGREES")]
    pub theta_out: Option<f64>,
    /// Spectra of cells: azimuth of the direction towards the viewer [default: opposite to the light, as in a mirror]
    #[arg(long, value_name = "DEGREES", allow_negative_numbers = true)]
    pub phi_out: Option<f64>,
    /// Print no progress and no notes on standard error
    #[arg(long, short)]
    pub quiet: bool,
}

/// The kinds of pictures that `plot` draws.
#[derive(Debug, Clone, Copy, ValueEnum, PartialEq, Eq)]
pub enum PlotKind {
    /// The BRDF as a disc, radius θ and angle φ (the paper's figures 3 and 4); for cells, where light from one
    /// direction goes
    Disc,
    /// Cells: f cos θ in the plane of incidence
    Lobes,
    /// Reflectance against the wavelength at chosen angles: s, p, mean; for cells, f between two directions
    Spectrum,
    /// Mean reflectance over angle and wavelength; for cells, of all reflected light together
    Map,
    /// The path of the colour in the CIE xy diagram over the angle, with swatches; for cells, of all reflected light
    Chromaticity,
}
