//! Metadata of tables: how a table was made.

use crate::commands::args::{EstimateArgs, spelled};
use crate::scene::Scene;
use crate::solve::scatter::ScatterRequest;
use crate::solve::spectra::{Method, Spectra};
use crate::table::metadata::{Metadata, MetadataKey};

/// Metadata of every table. Nothing here depends on when or where, so equal runs give equal files.
fn common_metadata(args: &EstimateArgs, scene: &Scene, imbalance_max: f64) -> Metadata {
    [
        (MetadataKey::Generator, format!("goniochrome {}", env!("CARGO_PKG_VERSION"))),
        (MetadataKey::Scene, scene.name.clone()),
        (MetadataKey::SceneToml, scene.toml.clone()),
        (MetadataKey::Model, spelled(args.computing.model)),
        (MetadataKey::Precision, spelled(args.computing.precision)),
        (MetadataKey::Illuminant, spelled(args.colouring.illuminant)),
        (MetadataKey::ColourSpace, spelled(args.colouring.space)),
        (MetadataKey::Observer, "CIE 1931 2 degree".into()),
        (MetadataKey::ImbalanceMax, format!("{imbalance_max:e}")),
    ]
    .into_iter()
    .collect()
}

/// Metadata of a cell's table.
pub(super) fn scatter_metadata(
    args: &EstimateArgs,
    scene: &Scene,
    tracing: &ScatterRequest,
    imbalance: f64,
    warnings: &[String],
) -> Metadata {
    let mut metadata = common_metadata(args, scene, imbalance);
    metadata.insert(MetadataKey::Coherence, spelled(tracing.coherence));
    metadata.insert(MetadataKey::Seed, tracing.seed.to_string());
    metadata.insert(MetadataKey::Reciprocal, args.cell.reciprocal.to_string());
    if !warnings.is_empty() {
        metadata.insert(MetadataKey::Warning, warnings.join("; "));
    }
    metadata
}

/// Metadata of a planar scene's table.
pub(super) fn planar_metadata(args: &EstimateArgs, scene: &Scene, spectra: &Spectra) -> Metadata {
    let mut metadata = common_metadata(args, scene, spectra.worst(|sample| sample.imbalance));
    metadata.insert(MetadataKey::Method, spelled(args.computing.method));
    metadata.insert(MetadataKey::TruncatedMax, format!("{:e}", spectra.worst(|sample| sample.truncated)));
    metadata.insert(MetadataKey::Recomputed, spectra.recomputed.to_string());
    if args.computing.method == Method::Hits {
        metadata.insert(MetadataKey::FellBack, spectra.fell_back.to_string());
    }
    metadata
}
