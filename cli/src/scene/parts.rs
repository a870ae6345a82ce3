//! Parts of a scene: media with names, layers and interfaces.

use goniochrome::optics::interface::Interface;
use goniochrome::optics::medium::MediumIndex;

use super::medium::OwnedMedium;

/// Maximum length in a scene, a metre: no film is thicker, and its phase still has ten digits.
pub(super) const MAX_LENGTH_NM: f64 = 1e9;

/// A medium with the name that the scene gives it.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedMedium {
    /// A material's name or its numbers, `1.56+0.06i`.
    pub name: String,
    /// Complex refractive index η(λ) of the medium.
    pub medium: OwnedMedium,
}

/// A plane layer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Layer {
    /// Medium of the layer.
    pub medium: MediumIndex,
    /// Thickness, 0 or more; a layer of no thickness is legal and does nothing.
    pub thickness_nm: f64,
    /// Variation of the thickness from place to place, if the scene names one.
    pub spread: Option<ThicknessSpread>,
}

/// Gaussian distribution of a layer's thickness over the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThicknessSpread {
    /// Standard deviation, more than 0.
    pub sigma_nm: f64,
    /// The entry of the scene file, counted from 0. Layers that `repeat` makes of one entry vary together.
    pub entry: u32,
}

/// Interface between two media, `[interface.NAME]` in a scene file.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedInterface {
    /// The `usemtl` name of the interface's facets.
    pub name: String,
    /// The media on the two sides.
    pub interface: Interface,
    /// Films on the side of the facet's normal, the outermost first; they take up no room in the mesh.
    pub coating: Vec<Layer>,
}

#[cfg(test)]
pub(super) mod tests {
    use goniochrome::optics::interface::Below;

    use super::*;

    /// Medium of one n + ik.
    pub fn medium(name: &str, n: f64, k: f64) -> NamedMedium {
        NamedMedium { name: name.to_owned(), medium: OwnedMedium::constant(n, k).unwrap() }
    }

    /// Interface without a coating.
    pub fn interface(name: &str, above: MediumIndex, below: Below) -> NamedInterface {
        NamedInterface { name: name.to_owned(), interface: Interface { above, below }, coating: Vec::new() }
    }
}
