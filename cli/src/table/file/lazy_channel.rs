//! Channel of an image whose values are computed when a line is written, so that a table is not copied first.

use exr::block::lines::LineRefMut;
use exr::image::write::samples::{SamplesWriter, WritableSamples};
use exr::math::RoundingMode;
use exr::meta::attribute::{LevelMode, SampleType};
use exr::meta::header::Header;

/// Channel given by a function of the pixel, counted row by row from the top.
pub(super) struct LazyChannel<'t>(Box<dyn Fn(usize) -> f32 + Sync + 't>);

impl<'t> LazyChannel<'t> {
    /// Channel whose pixel i has the value `at(i)`.
    pub fn new(at: impl Fn(usize) -> f32 + Sync + 't) -> Self {
        Self(Box::new(at))
    }
}

/// Writer of the lines of a channel.
pub(super) struct Lines<'c> {
    at: &'c (dyn Fn(usize) -> f32 + Sync + 'c),
    width: usize,
}

impl<'c> WritableSamples<'c> for LazyChannel<'_> {
    type Writer = Lines<'c>;

    fn sample_type(&self) -> SampleType {
        SampleType::F32
    }

    fn infer_level_modes(&self) -> (LevelMode, RoundingMode) {
        (LevelMode::Singular, RoundingMode::Down)
    }

    fn create_samples_writer(&'c self, header: &Header) -> Lines<'c> {
        Lines { at: &*self.0, width: header.layer_size.width() }
    }
}

impl SamplesWriter for Lines<'_> {
    fn extract_line(&self, line: LineRefMut<'_>) {
        let from = line.location.position.y() * self.width + line.location.position.x();
        line.write_samples(|x| (self.at)(from + x)).expect("a line has room for its samples");
    }
}
