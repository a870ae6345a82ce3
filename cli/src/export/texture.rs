//! OpenEXR images as textures for shaders.

use std::collections::BTreeMap;
use std::io::Cursor;

use exr::meta::attribute::{AttributeValue, Chromaticities, Text};
use exr::prelude::{AnyChannel, AnyChannels, Encoding, FlatSamples, Image, WritableImage};

use crate::support::error::{Error, Result};
use crate::table::file::sort_attributes;

/// Bytes of an uncompressed image: channels of width × height values by rows from the top, and text for the header.
///
/// # Errors
/// What the OpenEXR encoder refuses.
pub(super) fn encode(
    size: (usize, usize),
    channels: impl IntoIterator<Item = (&'static str, FlatSamples)>,
    chromaticities: Option<Chromaticities>,
    about: BTreeMap<String, String>,
) -> Result<Vec<u8>> {
    let channels = channels.into_iter().map(|(name, values)| AnyChannel::new(name, values));
    let channels = AnyChannels::sort(channels.collect());
    let mut image = Image::from_encoded_channels(size, Encoding::UNCOMPRESSED, channels);
    image.attributes.chromaticities = chromaticities;
    // Text is UTF-8, as in tables.
    let text = |string: &str| Text::from_slice_unchecked(string.as_bytes());
    let attributes = about.into_iter().map(|(key, value)| (text(&key), AttributeValue::Text(text(&value))));
    image.layer_data.attributes.other.extend(attributes);
    let mut bytes = Cursor::new(Vec::new());
    let failed = |error: &dyn std::fmt::Display| Error::failed(format_args!("cannot encode the table as EXR: {error}"));
    image.write().non_parallel().to_buffered(&mut bytes).map_err(|error| failed(&error))?;
    let mut bytes = bytes.into_inner();
    sort_attributes(&mut bytes).ok_or_else(|| failed(&"malformed header"))?;
    Ok(bytes)
}
