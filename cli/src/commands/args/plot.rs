//! Arguments of `plot`.

use std::path::PathBuf;
use std::str::FromStr;

use clap::{Args, ValueEnum};
use goniochrome::microfacet::Distribution;

use super::shared::Compensating;
use super::values::{RoughnessArg, distribution, positive};
use crate::solve::grid::Angles;

/// Numbers of a diffraction order, such as `-1` or `1,2`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OrderArg {
    /// One number, along the only axis of the period.
    Line(i32),
    /// Numbers along x and y.
    Crossed([i32; 2]),
}

impl FromStr for OrderArg {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let number = |text: &str| text.trim().parse::<i32>().map_err(|_| "expected M or M,N such as -1 or 1,2".into());
        match text.split_once(',') {
            Some((m, n)) => Ok(Self::Crossed([number(m)?, number(n)?])),
            None => number(text).map(Self::Line),
        }
    }
}

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
    /// lobes and spectra of cells; 30 for the disc of a cell and for spectra of orders, which take one; 0:75:15 to mark
    /// on the path of the colour]
    #[arg(long, allow_hyphen_values = true)]
    pub theta: Option<Angles>,
    /// Cells, and lobes of a finish: azimuth of the light in degrees
    #[arg(long, default_value_t = 0.0, allow_negative_numbers = true)]
    pub phi: f64,
    /// Spectra of cells: angle of the direction towards the viewer [default: the angle of the light]
    #[arg(long, value_name = "DEGREES")]
    pub theta_out: Option<f64>,
    /// Spectra of cells: azimuth of the direction towards the viewer [default: opposite to the light, as in a mirror]
    #[arg(long, value_name = "DEGREES", allow_negative_numbers = true)]
    pub phi_out: Option<f64>,
    /// Tables over the thickness of a layer, by `estimate --vary`: the thickness in nm
    #[arg(long, value_name = "NM")]
    pub thickness: Option<f64>,
    /// Lobes of mirror-like tables: the roughness α of the facets, in (0, 1], along x and y [default: that of the
    /// table's finish]
    #[arg(long, value_name = "ALPHA[,ALPHA]", allow_hyphen_values = true)]
    pub roughness: Option<RoughnessArg>,
    /// Lobes of mirror-like tables: the distribution of the facets' normals, ggx or beckmann [default: the table's,
    /// else ggx]
    #[arg(long, value_name = "ggx|beckmann", value_parser = distribution)]
    pub distribution: Option<Distribution>,
    /// Several bounces among facets
    #[command(flatten)]
    pub compensating: Compensating,
    /// Spectrum, angles and map of diffraction orders: the order to draw, as M or M,N; repeat it for more [default: the
    /// strongest; for the map all together]
    #[arg(long = "order", value_name = "M[,N]", allow_hyphen_values = true)]
    pub orders: Vec<OrderArg>,
    /// Angles of diffraction orders: the wavelength in nm [default: 550]
    #[arg(long, value_name = "NM", value_parser = positive)]
    pub wavelength: Option<f64>,
    /// Print no progress and no notes on standard error
    #[arg(long, short)]
    pub quiet: bool,
}

/// The kinds of pictures that `plot` draws.
#[derive(Debug, Clone, Copy, ValueEnum, PartialEq, Eq)]
pub enum PlotKind {
    /// The BRDF as a disc, radius θ and angle φ (the paper's figures 3 and 4); for cells, where light from one
    /// direction goes; diffraction orders as streaks of colour
    Disc,
    /// Cells, and mirror-like tables with a finish: f cos θ in the plane of incidence
    Lobes,
    /// Reflectance against the wavelength at chosen angles: s, p, mean; for cells, f between two directions, or
    /// efficiencies of diffraction orders
    Spectrum,
    /// Diffraction orders: efficiencies against the angle of incidence at one wavelength
    Angles,
    /// Mean reflectance over angle and wavelength; for cells, of all reflected light together
    Map,
    /// The path of the colour in the CIE xy diagram over the angle, with swatches; for cells, of all reflected light
    Chromaticity,
}
