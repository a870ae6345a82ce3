//! Arguments of `plot`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

use crate::solve::grid::Angles;

/// Arguments of `plot`.
#[derive(Debug, Args)]
pub struct PlotArgs {
    /// A table made by `estimate`, or a scene file or preset, of which one is made in memory
    #[arg(value_name = "TABLE|SCENE")]
    pub table: PathBuf,
    /// The picture (.png or .svg)
    #[arg(long, short, value_name = "FILE")]
    pub output: PathBuf,
    /// What to draw
    #[arg(long, value_enum, default_value_t = PlotKind::Disc)]
    pub kind: PlotKind,
    /// Angles of incidence: of spectra, the nearest of the table's [default: 0,45,75]; of lobes and spectra of cells
    /// [default: 15,45,75]; of the disc of a cell, one [default: 30]; marked on the path of the colour [default: 0:75:15]
    #[arg(long, allow_hyphen_values = true)]
    pub theta: Option<Angles>,
    /// Cells: azimuth of the light in degrees
    #[arg(long, default_value_t = 0.0, allow_negative_numbers = true)]
    pub phi: f64,
    /// Spectra of cells: angle of the direction towards the viewer [default: that of the light]
    #[arg(long, value_name = "DEGREES")]
    pub theta_out: Option<f64>,
    /// Spectra of cells: its azimuth [default: opposite to the light, where a mirror reflects to]
    #[arg(long, value_name = "DEGREES", allow_negative_numbers = true)]
    pub phi_out: Option<f64>,
    /// No progress and no remarks on standard error
    #[arg(long, short)]
    pub quiet: bool,
}

/// What `plot` draws.
#[derive(Debug, Clone, Copy, ValueEnum, PartialEq, Eq)]
pub enum PlotKind {
    /// The BRDF disc of figures 3 and 4: radius θ, angle φ; of cells, where the light of one direction goes
    Disc,
    /// Cells: f cos θ in the plane of incidence
    Lobes,
    /// Reflectance against wavelength at chosen angles: s, p, mean; of cells, f between two directions
    Spectrum,
    /// Mean reflectance over angle and wavelength; of cells, of all light together
    Map,
    /// The colour's path in the CIE xy diagram as the angle changes, with swatches; of cells, of all light together
    Chromaticity,
}
