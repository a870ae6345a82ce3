//! The choice between waves and rays for diffraction orders.

use crate::scene::{Scene, Shape};
use crate::solve::waves::{Accuracy, OrderMethod, WaveCell};
use crate::support::error::{Error, Result};
use crate::support::progress::note;

/// Default number of starting rays for one direction of the light.
pub(super) const RAYS: u32 = 65_536;

/// The first of several options that the user gave.
pub(super) fn first_given(options: &[(&'static str, bool)]) -> Option<&'static str> {
    options.iter().find(|(_, given)| *given).map(|(option, _)| *option)
}

/// The cell for waves, if they are to be used: as `--method` says, else where the cell allows it and no option of rays
/// is given. `ray_option` is the first option of rays that the user gave, if any.
pub(super) fn wave_cell<'s>(
    scene: &'s Scene,
    method: Option<OrderMethod>,
    ray_option: Option<&str>,
    wavelength_nm: &[f64],
    accuracy: Accuracy,
    quiet: bool,
) -> Result<Option<WaveCell<'s>>> {
    match (method, ray_option) {
        (Some(OrderMethod::Waves), Some(option)) => {
            return Err(Error::usage(format_args!("{option}: is of rays, and waves have none; leave it out")));
        }
        (Some(OrderMethod::Rays), _) | (None, Some(_)) => return Ok(None),
        (_, None) => {}
    }
    if let Shape::Stack { .. } = scene.shape {
        return Ok(None); // rays say what is wrong with it
    }
    let usable = match WaveCell::new(scene) {
        Ok(cell) => {
            cell.check_media(wavelength_nm)?;
            cell.check_size(wavelength_nm, accuracy).map(|()| cell)
        }
        Err(error) => Err(error),
    };
    match usable {
        Ok(cell) => Ok(Some(cell)),
        Err(error) if method.is_some() => Err(error),
        Err(error) => {
            note(quiet, format_args!("by rays, not waves: {error}"));
            Ok(None)
        }
    }
}
