//! Pictures as outputs of commands.

use std::path::Path;

use crate::plot::{Picture, PictureFormat};
use crate::scene::Scene;
use crate::support::error::Result;
use crate::support::output;
use crate::support::progress::note;

/// Writes a picture, and notes how many of its colours had to be changed.
pub(super) fn save_picture(picture: &Picture, path: &Path, quiet: bool) -> Result<()> {
    picture.save(path)?;
    if let Some(said) = picture.out_of_gamut().note() {
        note(quiet, format_args!("{}: {said}", path.display()));
    }
    Ok(())
}

/// Refuses, before long work, a CSV and a picture that could not be written at its end.
pub(super) fn check_outputs(csv: &Path, picture: Option<&Path>, scene: &Scene) -> Result<()> {
    output::check_destination(csv, &scene.files)?;
    let Some(picture) = picture else { return Ok(()) };
    PictureFormat::of(picture)?;
    output::check_destination(picture, &scene.files)?;
    output::refuse_same_output(csv, picture)
}
