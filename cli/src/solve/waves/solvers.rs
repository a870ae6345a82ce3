//! The solvers of `goniochrome-waves` at work on a cell: profiles from its layers, truncations that grow, light of
//! several directions.

use std::cell::Cell;

use goniochrome::table::Periodicity;
use goniochrome_waves::chandezon::{GraphModes, enough_orders, suits};
use goniochrome_waves::convergence::{Converged, Goal, converge_by};
use goniochrome_waves::crossed::{CrossedModes, truncation};
use goniochrome_waves::lamellar::Modes;
use goniochrome_waves::light::Light;
use goniochrome_waves::profile::{CrossedProfile, CrossedSlice, Graph, Profile, Slice, Strip};
use goniochrome_waves::response::Response;
use goniochrome_waves::{Complex64, WaveError};

use crate::solve::waves::cell::{Accuracy, WaveCell};
use crate::solve::waves::front::{FrontFace, OrderResponse};
use crate::solve::waves::powers::DirectionPowers;
use crate::solve::waves::sections::{LineMedia, SectionLayer};
use crate::support::error::{Error, Result};

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

/// Least |m| to begin with in cells with two periods: a change from 2 to 3 says little.
const MIN_CROSSED: usize = 3;
/// Orders of one wavelength for light from several directions of one wavevector component along the first axis.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct WaveOrders {
    /// Powers of orders for each direction; their indices are (m, n) along the x and y of the scene.
    pub directions: Vec<DirectionPowers>,
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

/// Light of one direction on the structure: the second component of its wavevector, and the numbers of the orders in
/// which it may reach the structure, of which 0 is the light itself.
struct Arrival {
    second: f64,
    numbers: Vec<i32>,
}

impl WaveCell<'_> {
    /// The method by its name, for notes.
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
        let Some(graph) = self.graph(wavelength_nm)? else { return Ok(Solver::Modes) };
        // Vertical walls of what is transparent need no steps, and one decomposition serves every azimuth.
        let is_metal = (graph.below * graph.below).re < 0.0;
        let gains = self.sections.is_stepped() || is_metal;
        Ok(if gains && suits(&graph, wavelength_nm) { Solver::Coordinates } else { Solver::Modes })
    }

    /// The number |m| of orders to begin with. A truncation and one of half as many orders more give the first error
    /// bar.
    fn first_order(&self, wavelength_nm: f64, least: usize, limit: usize) -> Result<usize> {
        let failed = |error: WaveError| Error::failed(format_args!("{}: {error}", self.scene().name));
        let first = match (self.solver(wavelength_nm)?, self.graph(wavelength_nm)?) {
            (Solver::CrossedModes, _) => MIN_CROSSED,
            (Solver::Coordinates, Some(graph)) => 2 * enough_orders(&graph, wavelength_nm).map_err(failed)? / 3,
            _ => least + 2,
        };
        // Room for a second truncation, without which there is no error bar.
        let crossed = self.periodicity() == Periodicity::Both;
        Ok(first.min(if crossed { limit - 1 } else { 2 * limit / 3 }).max(least))
    }

    /// The cell as one interface, if it is one.
    fn graph(&self, wavelength_nm: f64) -> Result<Option<Graph>> {
        let Some(points_nm) = self.graph.clone() else { return Ok(None) };
        Ok(Some(Graph {
            period_nm: self.sections.period_nm[0],
            above: self.index_at_cell(wavelength_nm)?,
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
        let plate = self.index_at_cell(wavelength_nm)?;
        let front = self.scene().front.map(|_| self.index_above(wavelength_nm)).transpose()?;
        let face = front.map(|outside| FrontFace { outside, plate });
        let arrivals: Vec<Arrival> = seconds
            .iter()
            .map(|&second| Arrival {
                second,
                numbers: if face.is_some() { self.numbers(wavelength_nm, first, second, plate) } else { vec![0] },
            })
            .collect();
        let along = if self.periodicity() == Periodicity::Both { self.index_above(wavelength_nm)? } else { first };
        let least = self.least_order(wavelength_nm, along)?;
        let limit = self.limit(accuracy);
        self.refuse_large(wavelength_nm, least, limit)?;
        let counts = Cell::new([0; 2]);
        let goal = Goal { target: accuracy.target, first: self.first_order(wavelength_nm, least, limit)?, limit };
        let solve = |max| {
            let responses = self.responses(wavelength_nm, first, &arrivals, max, &counts)?;
            Ok(self.powers(wavelength_nm, first, &arrivals, face, responses))
        };
        let found = converge_by(goal, solve, |coarse, fine| DirectionPowers::largest_change(coarse, fine))?;
        let Converged { responses: mut directions, max_order, error_bar, met, .. } = found;
        if self.periodicity() == Periodicity::Y {
            for powers in &mut directions {
                powers.reflected.iter_mut().chain(&mut powers.transmitted).for_each(|order| order.index.swap(0, 1));
            }
        }
        let [decompositions, layers] = counts.get();
        Ok(WaveOrders { directions, error: error_bar, max_order, met, decompositions, layers })
    }

    /// Powers of the orders for each arrival, seen through the front face if there is one.
    fn powers(
        &self,
        wavelength_nm: f64,
        first: f64,
        arrivals: &[Arrival],
        face: Option<FrontFace>,
        responses: Vec<Response>,
    ) -> Vec<DirectionPowers> {
        let Some(face) = face else { return responses.iter().map(DirectionPowers::of).collect() };
        let mut responses = responses.into_iter();
        let seen = |arrival: &Arrival| {
            let structure: Vec<OrderResponse> = arrival
                .numbers
                .iter()
                .zip(responses.by_ref())
                .map(|(&number, response)| OrderResponse {
                    number,
                    tangential: self.along_first(wavelength_nm, first, number).hypot(arrival.second),
                    response,
                })
                .collect();
            face.seen(&structure)
        };
        arrivals.iter().map(seen).collect()
    }

    /// First component of the wavevector of an order.
    fn along_first(&self, wavelength_nm: f64, first: f64, number: i32) -> f64 {
        first + f64::from(number) * wavelength_nm / self.sections.period_nm[0]
    }

    /// Numbers of the orders that travel in a medium of this index, order 0 among them.
    fn numbers(&self, wavelength_nm: f64, first: f64, second: f64, index: f64) -> Vec<i32> {
        let reach = (2.0 * index * self.sections.period_nm[0] / wavelength_nm).ceil() as i32;
        let travels = |number: &i32| self.along_first(wavelength_nm, first, *number).hypot(second) < index;
        (-reach..=reach).filter(travels).collect()
    }

    /// Responses of the structure to all arrivals with orders up to `max`; adds to the counts of decompositions and of
    /// passages of layers.
    fn responses(
        &self,
        wavelength_nm: f64,
        first: f64,
        arrivals: &[Arrival],
        max: usize,
        counts: &Cell<[usize; 2]>,
    ) -> Result<Vec<Response>> {
        let failed = |error: WaveError| {
            let name = &self.scene().name;
            Error::failed(format_args!("{name}: {wavelength_nm} nm: {error}; change an angle or a length a little"))
        };
        let count = |decompositions: usize, layers: usize| {
            let [made, met] = counts.get();
            counts.set([made + decompositions, met + layers]);
        };
        let (above, below) = (self.index_at_cell(wavelength_nm)?, self.eta(self.sections.below, wavelength_nm)?);
        let period_nm = self.sections.period_nm;
        let mut found = Vec::new();
        match self.solver(wavelength_nm)? {
            Solver::Coordinates => {
                let graph = self.graph(wavelength_nm)?.expect("the solver was chosen for it");
                let modes = GraphModes::new(&graph, wavelength_nm, first, max).map_err(failed)?;
                for arrival in arrivals {
                    // The half-spaces, for each direction anew.
                    count(2, 2);
                    let waves = modes.waves(arrival.second).map_err(failed)?;
                    for &number in &arrival.numbers {
                        found.push(waves.response_at(number).map_err(failed)?);
                    }
                }
            }
            Solver::Modes => {
                let slices = self.layers(max)?.into_iter().map(|layer| {
                    let SectionLayer { thickness_nm, strips, .. } = layer;
                    let eta = self.etas(&strips[0], wavelength_nm)?;
                    Ok(Slice { thickness_nm, edges_nm: strips[0].edges_nm(), eta })
                });
                let slices = slices.collect::<Result<Vec<_>>>()?;
                let structured = slices.iter().filter(|slice| slice.eta.len() > 1).count();
                let profile = Profile { period_nm: period_nm[0], above, below, slices };
                let modes = Modes::new(&profile, wavelength_nm, first, max).map_err(failed)?;
                count(modes.decompositions(), structured * arrivals.len());
                for arrival in arrivals {
                    for &number in &arrival.numbers {
                        found.push(modes.response_at(number, arrival.second).map_err(failed)?);
                    }
                }
            }
            Solver::CrossedModes => {
                let slices = self.layers(max)?.into_iter().map(|layer| {
                    let SectionLayer { thickness_nm, strip_edges_nm, strips } = layer;
                    let strips = strips
                        .iter()
                        .map(|line| Ok(Strip { edges_nm: line.edges_nm(), eta: self.etas(line, wavelength_nm)? }));
                    Ok(CrossedSlice { thickness_nm, strip_edges_nm, strips: strips.collect::<Result<_>>()? })
                });
                let slices = slices.collect::<Result<Vec<_>>>()?;
                let profile = CrossedProfile { period_nm, above, below, slices };
                for arrival in arrivals {
                    let light = Light { wavelength_nm, tangential: [first, arrival.second] };
                    let modes = CrossedModes::new(&profile, &light, truncation(period_nm, max)).map_err(failed)?;
                    count(modes.decompositions(), profile.slices.len());
                    found.push(modes.response().map_err(failed)?);
                }
            }
        }
        Ok(found)
    }

    /// The layers of the cell for waves of orders up to `max`: slopes are divided into steps as fine as the finest
    /// period that these orders resolve, and half as fine in cells with two periods, where `max` is small.
    fn layers(&self, max: usize) -> Result<Vec<SectionLayer>> {
        let harmonics = (2 * max + 1) as f64;
        let per_harmonic = if self.periodicity() == Periodicity::Both { 2.0 } else { 1.0 };
        let step_nm = self.sections.period_nm[0] / (per_harmonic * harmonics);
        self.sections.layers(self.scene(), step_nm)
    }

    /// Indices of the media along a line.
    fn etas(&self, line: &LineMedia, wavelength_nm: f64) -> Result<Vec<Complex64>> {
        line.media.iter().map(|&medium| self.eta(medium, wavelength_nm)).collect()
    }
}
