//! A layer whose thickness varies from surface to surface, as an option names it.

use std::str::FromStr;

use crate::scene::{Scene, Shape};
use crate::support::error::{Error, Result};

/// A layer of varied thickness, written as `LAYER=FROM:TO:STEPS` such as `1=100:800:64`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Vary {
    /// The layer, counted from 1 at the top.
    pub layer: usize,
    /// First and last thickness in nm.
    pub range_nm: [f64; 2],
    /// Number of rows, ends included.
    pub steps: u16,
}

/// Largest number of rows; a row has at most as many columns.
const MAX_STEPS: u16 = 4096;

impl FromStr for Vary {
    type Err = String;

    fn from_str(text: &str) -> std::result::Result<Self, String> {
        let parsed = || {
            let (layer, range) = text.split_once('=')?;
            let [from, to, steps] = range.split(':').collect::<Vec<_>>().try_into().ok()?;
            let length = |text: &str| text.parse::<f64>().ok().filter(|nm| nm.is_finite() && *nm >= 0.0);
            let layer = layer.parse().ok().filter(|layer| *layer > 0)?;
            let steps = steps.parse().ok().filter(|steps| (2..=MAX_STEPS).contains(steps))?;
            Some(Self { layer, range_nm: [length(from)?, length(to)?], steps })
        };
        match parsed() {
            Some(vary) if vary.range_nm[0] < vary.range_nm[1] => Ok(vary),
            _ => Err(format!("expected LAYER=FROM:TO:STEPS such as 1=100:800:64, FROM < TO, 2 to {MAX_STEPS} steps")),
        }
    }
}

impl Vary {
    /// The thicknesses in nm: evenly spaced, ends included.
    pub fn thicknesses(&self) -> impl Iterator<Item = f64> + use<> {
        let Self { range_nm: [from, to], steps, .. } = *self;
        (0..steps).map(move |step| from + (to - from) * f64::from(step) / f64::from(steps - 1))
    }

    /// The scene whose layer is so thick.
    ///
    /// # Errors
    /// A scene without layers, or without so many.
    pub fn scene_at(&self, scene: &Scene, thickness_nm: f64) -> Result<Scene> {
        let mut scene = scene.clone();
        let Shape::Stack { layers, .. } = &mut scene.shape else {
            return Err(Error::usage(format_args!("--vary: {} has no [stack] of layers", scene.name)));
        };
        let (layer, count) = (self.layer, layers.len());
        let Some(varied) = layers.get_mut(layer - 1) else {
            return Err(Error::usage(format_args!(
                "--vary {layer}=…: {} has {count} layers; name one of them, 1 is the top",
                scene.name
            )));
        };
        varied.thickness_nm = thickness_nm;
        Ok(scene)
    }
}
