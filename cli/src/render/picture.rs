//! A picture as a file holds it, before it is taken as an environment.

use super::primaries::Primaries;

/// Number of texels that an image may have; 8192 × 4096 and half as much again fit in 600 MB.
const MAX_TEXELS: usize = 50_000_000;

/// The result of reading a file; an error is a message that does not name the file yet.
pub(super) type ReadResult<T> = Result<T, String>;

/// A picture in the colour space of its file.
#[derive(Debug, PartialEq)]
pub(super) struct Decoded {
    /// Width and height.
    pub size: [usize; 2],
    /// R, G and B, row by row from the upper left.
    pub texels: Vec<[f32; 3]>,
    /// The primaries of R, G and B, where the file names them.
    pub primaries: Option<Primaries>,
    /// Whether the file holds luminance alone.
    pub is_grey: bool,
}

/// Refuses sizes that a lat-long image cannot have, and more than [`MAX_TEXELS`] texels.
pub(super) fn check_size(width: usize, height: usize) -> ReadResult<()> {
    if height == 0 || height.checked_mul(2) != Some(width) {
        return Err(format!(
            "{width} × {height} texels are no lat-long image, which is twice as wide as high; convert cube maps and mirror balls"
        ));
    }
    if width.checked_mul(height).is_none_or(|count| count > MAX_TEXELS) {
        return Err(format!("{width} × {height} texels are too many; {MAX_TEXELS} is the limit, so scale it down"));
    }
    Ok(())
}
