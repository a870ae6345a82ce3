//! Metadata of tables: how a table was made.

use crate::commands::args::{EstimateArgs, spelled};
use crate::scene::{Periods, Scene};
use crate::solve::backing::Backing;
use crate::solve::precision::Precision;
use crate::solve::scatter::{Coherence, Tracing};
use crate::solve::spectra::{Method, Spectra};
use crate::solve::waves::OrderMethod;
use crate::table::finish;
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
    tracing: &Tracing,
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

/// Metadata of a table of waves: of diffraction orders, or of scattered light where periods are random.
pub(super) fn wave_metadata(
    args: &EstimateArgs,
    scene: &Scene,
    periods: Periods,
    error_max: f64,
    warnings: &[String],
) -> Metadata {
    let mut metadata = common_metadata(args, scene, 0.0);
    metadata.insert(MetadataKey::Precision, spelled(Precision::F64));
    metadata.insert(MetadataKey::Method, spelled(OrderMethod::Waves));
    metadata.insert(MetadataKey::Coherence, spelled(Coherence::Cell));
    let named = match periods {
        Periods::Coherent => "coherent",
        Periods::Random => "random",
    };
    metadata.insert(MetadataKey::Periods, named);
    metadata.insert(MetadataKey::ErrorMax, format!("{error_max:e}"));
    if !warnings.is_empty() {
        metadata.insert(MetadataKey::Warning, warnings.join("; "));
    }
    metadata
}

/// Metadata of a planar scene's table.
pub(super) fn planar_metadata(args: &EstimateArgs, scene: &Scene, spectra: &Spectra, backing: Backing) -> Metadata {
    let mut metadata = common_metadata(args, scene, spectra.worst(|sample| sample.imbalance));
    metadata.insert(MetadataKey::Method, spelled(args.computing.method));
    metadata.insert(MetadataKey::TruncatedMax, format!("{:e}", spectra.worst(|sample| sample.truncated)));
    if let Some(kept) = &scene.finish {
        finish::keep(kept, &mut metadata);
    }
    match backing {
        Backing::Opaque => {}
        Backing::Ambient => metadata.insert(MetadataKey::Backing, "ambient"),
        Backing::Body => metadata.insert(MetadataKey::Backing, "body"),
    }
    metadata.insert(MetadataKey::Recomputed, spectra.recomputed.to_string());
    if args.computing.method == Method::Hits {
        metadata.insert(MetadataKey::FellBack, spectra.fell_back.to_string());
    }
    metadata
}
