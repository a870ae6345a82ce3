//! A periodic cell as the solvers of waves take it, and its diffraction orders for light from several directions.

use std::fmt::Write as _;

use glam::DVec3;
use goniochrome::optics::medium::MediumIndex;
use goniochrome::table::Periodicity;
use goniochrome_waves::Complex64;

use crate::scene::Scene;
use crate::solve::waves::powers::is_opaque;
use crate::solve::waves::sections::Sections;
use crate::support::error::{Error, Result};

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
    /// The accuracy of a table, for pictures. Sharp edges of metal converge slowly: a table says what it reaches with
    /// 97 orders.
    pub const TABLE: Self = Self { target: 2e-3, max_order: Some(48) };
    /// The accuracy of a table of a cell with two periods. Time grows with the sixth power of the largest order.
    pub const CROSSED_TABLE: Self = Self { target: 2e-3, max_order: Some(4) };
}

/// Default of [`Accuracy::max_order`] for lines: 241 orders, whose equations take some seconds for 33 layers.
const MAX_ORDER_LINES: usize = 120;
/// Default of [`Accuracy::max_order`] for cells with two periods: 225 orders, of which each layer takes seconds.
const MAX_ORDER_CROSSED: usize = 7;

/// Periodic cell whose diffraction is computed by waves.
#[derive(Clone, Debug)]
pub struct WaveCell<'s> {
    scene: &'s Scene,
    pub(super) sections: Sections,
    pub(super) graph: Option<Vec<[f64; 2]>>,
}

impl<'s> WaveCell<'s> {
    /// The cell of a scene.
    ///
    /// # Errors
    /// One line that says why waves cannot be computed: a stack of layers, a perfect mirror, a coating of tilted
    /// facets, a plate's front face over a cell with two periods.
    pub fn new(scene: &'s Scene) -> Result<Self> {
        let sections = Sections::new(scene)?;
        if scene.front.is_some() && !sections.periodicity.has_lines() {
            return Err(Error::failed(format_args!(
                "{}: front: waves take a plate's front face over lines alone; remove it",
                scene.name
            )));
        }
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

    /// Whether the surface is its own mirror image across the first axis of the solver, and across the second.
    ///
    /// # Errors
    /// Bodies that overlap.
    pub(super) fn mirrors(&self) -> Result<[bool; 2]> {
        self.sections.mirrors(self.scene)
    }

    /// The order that light from a mirrored direction leaves in where light from the direction itself leaves in
    /// `order`.
    pub(super) fn mirrored_order(&self, order: [i32; 2], [first, second]: [bool; 2]) -> [i32; 2] {
        let flips = if self.periodicity() == Periodicity::Y { [second, first] } else { [first, second] };
        [0, 1].map(|axis| if flips[axis] { -order[axis] } else { order[axis] })
    }

    /// Wavevector along the axes of the solver, in units of k₀, of light from `wi` in a medium of this index.
    pub(super) fn wavevector(&self, wi: DVec3, index: f64) -> [f64; 2] {
        let [x, y] = self.order_tangential(wi, index, [0, 0], 0.0);
        if self.periodicity() == Periodicity::Y { [y, x] } else { [x, y] }
    }

    /// Wavevector along x and y, in units of k₀, of an order for light from `wi` in a medium of this index.
    pub(super) fn order_tangential(&self, wi: DVec3, index: f64, [m, n]: [i32; 2], wavelength_nm: f64) -> [f64; 2] {
        let [x, y] = self.period_nm();
        let along = |wi: f64, order: i32, period: f64| f64::from(order) * wavelength_nm / period - index * wi;
        [along(wi.x, m, x), along(wi.y, n, y)]
    }

    /// Complex index of a medium.
    pub(super) fn eta(&self, medium: MediumIndex, wavelength_nm: f64) -> Result<Complex64> {
        let place = usize::from(medium);
        let eta = self.scene.media[place].medium.borrow().eta(wavelength_nm);
        eta.map_err(|error| self.scene.medium_error(place, &error))
    }

    /// Index of the medium in which light arrives: that above the cell, or in front of the plate that it is under. Weak
    /// absorption is neglected.
    ///
    /// # Errors
    /// A medium without data at the wavelength, or one that absorbs too much for light to arrive in it.
    pub fn index_above(&self, wavelength_nm: f64) -> Result<f64> {
        self.index_of_ambient(self.scene.front.unwrap_or(self.sections.above), wavelength_nm)
    }

    /// Index of the medium directly above the cell.
    pub(super) fn index_at_cell(&self, wavelength_nm: f64) -> Result<f64> {
        self.index_of_ambient(self.sections.above, wavelength_nm)
    }

    fn index_of_ambient(&self, medium: MediumIndex, wavelength_nm: f64) -> Result<f64> {
        let place = usize::from(medium);
        let eta = self.scene.media[place].medium.borrow().ambient_eta(wavelength_nm);
        eta.map(|eta| eta.re).map_err(|error| self.scene.medium_error(place, &error))
    }

    /// Index of the medium below; 0 if it is opaque.
    ///
    /// # Errors
    /// A medium without data at the wavelength.
    pub fn index_below(&self, wavelength_nm: f64) -> Result<f64> {
        let eta = self.eta(self.sections.below, wavelength_nm)?;
        Ok(if is_opaque(eta) { 0.0 } else { eta.re })
    }

    /// Least number |m| of orders with which waves may be computed: those that travel in the densest medium that does
    /// not absorb, for light whose wavevector along the surface has a component of up to `along`. In cells with two
    /// periods it is that of the level that `truncation` divides between the axes.
    pub(super) fn least_order(&self, wavelength_nm: f64, along: f64) -> Result<usize> {
        let mut densest = self.index_at_cell(wavelength_nm)?;
        for medium in 0..self.scene.media.len() {
            let eta = self.eta(medium as MediumIndex, wavelength_nm)?;
            if eta.im < eta.re {
                densest = densest.max(eta.re);
            }
        }
        let [first, second] = self.sections.period_nm;
        let period = if self.periodicity() == Periodicity::Both { (first * second).sqrt() } else { first };
        Ok(((densest + along.abs()) * period / wavelength_nm).ceil().max(1.0) as usize)
    }

    /// Largest |m| that a solver takes along.
    pub(super) fn limit(&self, accuracy: Accuracy) -> usize {
        let crossed = self.periodicity() == Periodicity::Both;
        accuracy.max_order.unwrap_or(if crossed { MAX_ORDER_CROSSED } else { MAX_ORDER_LINES })
    }

    /// Refuses wavelengths at which a medium has no data or light cannot arrive.
    ///
    /// # Errors
    /// Names the medium and the wavelength.
    pub fn check_media(&self, wavelength_nm: &[f64]) -> Result<()> {
        for &nm in wavelength_nm {
            self.index_above(nm)?;
            self.index_at_cell(nm)?;
            for medium in 0..self.scene.media.len() {
                self.eta(medium as MediumIndex, nm)?;
            }
        }
        Ok(())
    }

    /// Refuses wavelengths at which waves need more orders than are allowed.
    ///
    /// # Errors
    /// Says how many orders the period needs and how long they would take; a medium without data at a wavelength.
    pub fn check_size(&self, wavelength_nm: &[f64], accuracy: Accuracy) -> Result<()> {
        for &nm in wavelength_nm {
            let grazing = self.index_above(nm)?;
            self.refuse_large(nm, self.least_order(nm, grazing)?, self.limit(accuracy))?;
        }
        Ok(())
    }

    /// Refuses a period that needs more orders than are allowed, and says how many and how long they would take.
    pub(super) fn refuse_large(&self, wavelength_nm: f64, least: usize, allowed: usize) -> Result<()> {
        // Two truncations give an error bar.
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
             layer; waves take periods of up to {:.0} wavelengths here; orders --method rays takes any",
            self.scene.name,
            0.9 * allowed as f64,
        )))
    }
}

/// Time of an eigenvalue decomposition over the cube of its size: 16 ms for 121 orders, of one core.
const SECONDS_PER_CUBE: f64 = 0.016 / (121.0 * 121.0 * 121.0);
