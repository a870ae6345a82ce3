//! A periodic cell as the solvers of waves take it, and its diffraction orders for light from several directions.

use std::cell::Cell;
use std::fmt::Write as _;

use glam::DVec3;
use goniochrome::optics::medium::MediumIndex;
use goniochrome::table::Periodicity;
use goniochrome_waves::chandezon::GraphModes;
use goniochrome_waves::convergence::{Converged, Goal, converge};
use goniochrome_waves::crossed::CrossedModes;
use goniochrome_waves::lamellar::Modes;
use goniochrome_waves::light::Light;
use goniochrome_waves::profile::{CrossedProfile, CrossedSlice, Graph, Profile, Slice, Strip};
use goniochrome_waves::response::Response;
use goniochrome_waves::{Complex64, WaveError};

use crate::scene::Scene;
use crate::solve::waves::sections::{LineMedia, SectionLayer, Sections};
use crate::support::error::{Error, Result};

/// Smallest index of absorption k, relative to n, at which the medium below counts as opaque.
const MAX_TRANSPARENT: f64 = 1e-3;

/// When a result is good enough, and when to give up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Accuracy {
    /// Error bar of every efficiency at which the number of orders grows no further.
    pub target: f64,
    /// Largest number |m| of an order that a solver takes along; `None` for the default of its kind.
    pub max_order: Option<usize>,
}

impl Accuracy {
    /// The accuracy of orders for one direction: an error bar of a thousandth of the light.
    pub const DEFAULT: Self = Self { target: 1e-3, max_order: None };
    /// The accuracy of a table, for pictures. Sharp edges of metal converge slowly: a table says what it reaches with 97
    /// orders.
    pub const TABLE: Self = Self { target: 2e-3, max_order: Some(48) };
}

/// Default of [`Accuracy::max_order`] for lines: 241 orders, whose equations take some seconds for 33 layers.
const MAX_ORDER_LINES: usize = 120;
/// Default of [`Accuracy::max_order`] for cells with two periods: 225 orders, of which each layer takes seconds.
const MAX_ORDER_CROSSED: usize = 7;

/// Solver of a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Solver {
    /// Fourier modes of layers that change along one axis.
    Modes,
    /// A coordinate transformation of one interface.
    Coordinates,
    /// Fourier modes of layers that change along two axes.
    CrossedModes,
}

/// Periodic cell whose diffraction is computed by waves.
#[derive(Clone, Debug)]
pub struct WaveCell<'s> {
    scene: &'s Scene,
    sections: Sections,
    graph: Option<Vec<[f64; 2]>>,
}

/// Orders of one wavelength for light from several directions of one wavevector component along the first axis.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct WaveOrders {
    /// Orders for each direction; their indices are (m, n) along the x and y of the scene.
    pub responses: Vec<Response>,
    /// Error bar of every efficiency.
    pub error: f64,
    /// Largest |m| that the solver took along.
    pub max_order: usize,
    /// Whether the error bar meets the target.
    pub met: bool,
    /// Eigenvalue decompositions that were made.
    pub decompositions: usize,
    /// Layers of several media through which light was followed, over all directions and truncations.
    pub layers: usize,
}

impl<'s> WaveCell<'s> {
    /// The cell of a scene.
    ///
    /// # Errors
    /// One line that says why waves cannot be computed: a stack of layers, a perfect mirror, a coating of tilted facets.
    pub fn new(scene: &'s Scene) -> Result<Self> {
        let sections = Sections::new(scene)?;
        let graph = sections.graph();
        Ok(Self { scene, sections, graph })
    }

    /// The scene.
    #[must_use]
    pub fn scene(&self) -> &'s Scene {
        self.scene
    }

    /// The axes along which the surface repeats.
    #[must_use]
    pub fn periodicity(&self) -> Periodicity {
        self.sections.periodicity
    }

    /// Periods along x and y.
    #[must_use]
    pub fn period_nm(&self) -> [f64; 2] {
        let [first, second] = self.sections.period_nm;
        if self.periodicity() == Periodicity::Y { [second, first] } else { [first, second] }
    }

    /// Whether the surface varies along x, and along y.
    pub(super) fn varies(&self) -> [bool; 2] {
        [self.periodicity() != Periodicity::Y, self.periodicity() != Periodicity::X]
    }

    /// Whether the surface is made of lines that are their own mirror image about some line along them.
    ///
    /// # Errors
    /// Bodies that overlap.
    pub(super) fn is_symmetric(&self) -> Result<bool> {
        Ok(self.periodicity().has_lines() && self.sections.is_symmetric(self.scene)?)
    }

    /// Components of a vector along the axes of the solver.
    pub(super) fn tangential(&self, w: DVec3) -> [f64; 2] {
        if self.periodicity() == Periodicity::Y { [w.y, w.x] } else { [w.x, w.y] }
    }

    /// Wavevector along x and y, in units of k₀, of an order for light from `wi` in a medium of this index.
    pub(super) fn order_tangential(&self, wi: DVec3, index: f64, [m, n]: [i32; 2], wavelength_nm: f64) -> [f64; 2] {
        let [x, y] = self.period_nm();
        let along = |wi: f64, order: i32, period: f64| f64::from(order) * wavelength_nm / period - index * wi;
        [along(wi.x, m, x), along(wi.y, n, y)]
    }

    /// Complex index of a medium.
    fn eta(&self, medium: MediumIndex, wavelength_nm: f64) -> Result<Complex64> {
        let place = usize::from(medium);
        let eta = self.scene.media[place].medium.borrow().eta(wavelength_nm);
        eta.map_err(|error| self.scene.medium_error(place, &error))
    }

    /// Index of the medium above, in which light arrives; its weak absorption is neglected.
    ///
    /// # Errors
    /// A medium without data at the wavelength, or one that absorbs too much for light to arrive in it.
    pub fn index_above(&self, wavelength_nm: f64) -> Result<f64> {
        let place = usize::from(self.sections.above);
        let eta = self.scene.media[place].medium.borrow().ambient_eta(wavelength_nm);
        eta.map(|eta| eta.re).map_err(|error| self.scene.medium_error(place, &error))
    }

    /// Index of the medium below; 0 if it is opaque.
    ///
    /// # Errors
    /// A medium without data at the wavelength.
    pub fn index_below(&self, wavelength_nm: f64) -> Result<f64> {
        let eta = self.eta(self.sections.below, wavelength_nm)?;
        Ok(if eta.im <= MAX_TRANSPARENT * eta.re { eta.re } else { 0.0 })
    }

    /// The method by its name, for notes and metadata.
    ///
    /// # Errors
    /// A medium without data at the wavelength.
    pub fn method(&self, wavelength_nm: f64) -> Result<&'static str> {
        Ok(match self.solver(wavelength_nm)? {
            Solver::Modes => "Fourier modes",
            Solver::Coordinates => "coordinate transformation",
            Solver::CrossedModes => "Fourier modes in two dimensions",
        })
    }

    fn solver(&self, wavelength_nm: f64) -> Result<Solver> {
        if self.periodicity() == Periodicity::Both {
            return Ok(Solver::CrossedModes);
        }
        Ok(if self.graph(wavelength_nm)?.is_some() { Solver::Coordinates } else { Solver::Modes })
    }

    /// The cell as one interface, if it is one that slopes.
    fn graph(&self, wavelength_nm: f64) -> Result<Option<Graph>> {
        let Some(points_nm) = self.graph.clone().filter(|_| self.sections.is_stepped()) else { return Ok(None) };
        Ok(Some(Graph {
            period_nm: self.sections.period_nm[0],
            above: self.index_above(wavelength_nm)?,
            below: self.eta(self.sections.below, wavelength_nm)?,
            points_nm,
        }))
    }

    /// The orders for light whose wavevector along the surface, in units of k₀ and in the axes of the solver, is
    /// `first` and each of `seconds`.
    ///
    /// # Errors
    /// A medium without data at the wavelength, bodies that overlap, a period that needs more orders than `accuracy`
    /// allows, equations without a finite solution.
    pub(super) fn orders(
        &self,
        wavelength_nm: f64,
        first: f64,
        seconds: &[f64],
        accuracy: Accuracy,
    ) -> Result<WaveOrders> {
        let above = self.index_above(wavelength_nm)?;
        let below = self.eta(self.sections.below, wavelength_nm)?;
        let least = self.least_order(wavelength_nm)?;
        let limit = self.limit(accuracy);
        self.refuse_large(wavelength_nm, least, limit)?;
        let solver = self.solver(wavelength_nm)?;
        let period_nm = self.sections.period_nm;
        let failed = |error: WaveError| {
            let name = &self.scene.name;
            Error::failed(format_args!("{name}: {wavelength_nm} nm: {error}; change an angle or a length a little"))
        };
        let goal = Goal { target: accuracy.target, first: self.first_order(least), limit };
        let (decompositions, met_layers) = (Cell::new(0), Cell::new(0));
        let count = |made: usize, layers: usize| {
            decompositions.set(decompositions.get() + made);
            met_layers.set(met_layers.get() + layers * seconds.len());
        };
        let found = converge(goal, |max| match solver {
            Solver::Coordinates => {
                let graph = self.graph(wavelength_nm)?.expect("the solver was chosen for it");
                let modes = GraphModes::new(&graph, wavelength_nm, first, max).map_err(failed)?;
                // Two half-spaces, for each direction anew.
                count(2 * seconds.len(), 2);
                seconds
                    .iter()
                    .map(|&second| modes.response(second))
                    .collect::<std::result::Result<_, _>>()
                    .map_err(failed)
            }
            Solver::Modes => {
                let slices = self.layers(max)?.into_iter().map(|layer| {
                    let SectionLayer { thickness_nm, strips, .. } = layer;
                    let eta = self.etas(&strips[0], wavelength_nm)?;
                    Ok(Slice { thickness_nm, edges_nm: strips[0].edges_nm(), eta })
                });
                let slices = slices.collect::<Result<_>>()?;
                let profile = Profile { period_nm: period_nm[0], above, below, slices };
                let modes = Modes::new(&profile, wavelength_nm, first, max).map_err(failed)?;
                count(modes.decompositions(), profile.slices.iter().filter(|slice| slice.eta.len() > 1).count());
                seconds
                    .iter()
                    .map(|&second| modes.response(second))
                    .collect::<std::result::Result<_, _>>()
                    .map_err(failed)
            }
            Solver::CrossedModes => {
                let slices = self.layers(max)?.into_iter().map(|layer| {
                    let SectionLayer { thickness_nm, strip_edges_nm, strips } = layer;
                    let strips = strips
                        .iter()
                        .map(|line| Ok(Strip { edges_nm: line.edges_nm(), eta: self.etas(line, wavelength_nm)? }));
                    Ok(CrossedSlice { thickness_nm, strip_edges_nm, strips: strips.collect::<Result<_>>()? })
                });
                let slices = slices.collect::<Result<_>>()?;
                let profile = CrossedProfile { period_nm, above, below, slices };
                count(0, profile.slices.len());
                let of = |&second: &f64| {
                    let light = Light { wavelength_nm, tangential: [first, second] };
                    let modes = CrossedModes::new(&profile, &light, self.max_orders(max))?;
                    count(modes.decompositions(), 0);
                    modes.response()
                };
                seconds.iter().map(of).collect::<std::result::Result<_, _>>().map_err(failed)
            }
        });
        let Converged { mut responses, max_order, error_bar: error, met, .. } = found?;
        if self.periodicity() == Periodicity::Y {
            for order in responses.iter_mut().flat_map(|r| r.reflected.iter_mut().chain(&mut r.transmitted)) {
                order.index.swap(0, 1);
            }
        }
        Ok(WaveOrders {
            responses,
            error,
            max_order,
            met,
            decompositions: decompositions.get(),
            layers: met_layers.get(),
        })
    }

    /// The layers of the cell for waves of orders up to `max`: slopes are divided into steps as fine as
    /// the finest period that these orders resolve, and half as fine in cells with two periods, where `max` is small.
    fn layers(&self, max: usize) -> Result<Vec<SectionLayer>> {
        let harmonics = (2 * max + 1) as f64;
        let per_harmonic = if self.periodicity() == Periodicity::Both { 2.0 } else { 1.0 };
        let step_nm = self.sections.period_nm[0] / (per_harmonic * harmonics);
        self.sections.layers(self.scene, step_nm)
    }

    /// Indices of the media along a line.
    fn etas(&self, line: &LineMedia, wavelength_nm: f64) -> Result<Vec<Complex64>> {
        line.media.iter().map(|&medium| self.eta(medium, wavelength_nm)).collect()
    }

    /// Largest orders along both axes: in proportion to the periods, `max` along the longer.
    fn max_orders(&self, max: usize) -> [usize; 2] {
        let longer = self.sections.period_nm[0].max(self.sections.period_nm[1]);
        self.sections.period_nm.map(|period| (max as f64 * period / longer).ceil() as usize)
    }

    /// Least number |m| of orders with which waves may be computed: those that travel in the densest medium that does not
    /// absorb.
    fn least_order(&self, wavelength_nm: f64) -> Result<usize> {
        let mut densest = self.index_above(wavelength_nm)?;
        for medium in 0..self.scene.media.len() {
            let eta = self.eta(medium as MediumIndex, wavelength_nm)?;
            if eta.im < eta.re {
                densest = densest.max(eta.re);
            }
        }
        let longer = self.sections.period_nm[0].max(self.sections.period_nm[1]);
        let longest = if self.periodicity() == Periodicity::Both { longer } else { self.sections.period_nm[0] };
        Ok((densest * longest / wavelength_nm).ceil().max(1.0) as usize)
    }

    /// |m| with which a solver begins.
    fn first_order(&self, least: usize) -> usize {
        if self.periodicity() == Periodicity::Both { least.max(2) } else { least + 2 }
    }

    /// Largest |m| that a solver takes along.
    fn limit(&self, accuracy: Accuracy) -> usize {
        let crossed = self.periodicity() == Periodicity::Both;
        accuracy.max_order.unwrap_or(if crossed { MAX_ORDER_CROSSED } else { MAX_ORDER_LINES })
    }

    /// Refuses wavelengths at which waves need more orders than are allowed.
    ///
    /// # Errors
    /// Says how many orders the period needs and how long they would take; a medium without data at a wavelength.
    pub fn check_size(&self, wavelength_nm: &[f64], accuracy: Accuracy) -> Result<()> {
        for &nm in wavelength_nm {
            self.refuse_large(nm, self.least_order(nm)?, self.limit(accuracy))?;
        }
        Ok(())
    }

    /// Refuses a period that needs more orders than are allowed, and says how many and how long they would take.
    fn refuse_large(&self, wavelength_nm: f64, least: usize, allowed: usize) -> Result<()> {
        if least < allowed {
            return Ok(());
        }
        let [x, y] = self.period_nm();
        let crossed = self.periodicity() == Periodicity::Both;
        let orders = if crossed { (2 * least + 1).pow(2) } else { 2 * least + 1 };
        let seconds = SECONDS_PER_CUBE * (orders as f64).powi(3);
        let mut time = String::new();
        let _ = match seconds {
            ..120.0 => write!(time, "{seconds:.0} seconds"),
            120.0..7200.0 => write!(time, "{:.0} minutes", seconds / 60.0),
            7200.0..172_800.0 => write!(time, "{:.0} hours", seconds / 3600.0),
            _ => write!(time, "{:.0e} days", seconds / 86_400.0),
        };
        Err(Error::failed(format_args!(
            "{}: a period of {x} × {y} nm needs at least {orders} orders at {wavelength_nm} nm, some {time} for each direction and \
             layer; waves take periods of up to {:.0} wavelengths here; use --method rays",
            self.scene.name,
            0.9 * allowed as f64,
        )))
    }
}

/// Time of an eigenvalue decomposition over the cube of its size: 16 ms for 121 orders, of one core.
const SECONDS_PER_CUBE: f64 = 0.016 / (121.0 * 121.0 * 121.0);
