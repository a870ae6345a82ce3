//! Pictures in OpenEXR files: R, G, B or luminance, in any part or layer.
//!
//! A channel is named by its layer, a point, and its own name: `View Layer.Combined.R`. Channels without a layer are
//! preferred; among several layers, the one that Blender calls Combined is the picture. Any other choice is ambiguous
//! and refused.

use std::io::Cursor;
use std::sync::Mutex;

use exr::math::Vec2;
use exr::meta::MetaData;
use exr::meta::header::Header;
use exr::prelude::{ReadChannels, ReadLayers, ReadSpecificChannel, Text};

use super::picture::{Decoded, ReadResult, check_size};
use crate::support::memory;

/// Largest number of layers or channels that a message lists.
const MAX_LISTED: usize = 12;

/// The channels of a picture in a file.
#[derive(Debug, PartialEq)]
struct PictureChannels {
    /// The part of the file that holds them.
    part: usize,
    /// The prefix of their names: a layer and a point, or nothing.
    prefix: String,
    /// Whether the picture is Y instead of R, G, B.
    is_grey: bool,
}

/// Reads the picture in the bytes of a file.
pub(super) fn read(bytes: &[u8]) -> ReadResult<Decoded> {
    let broken = |error: exr::error::Error| format!("not a readable EXR file: {error}; export it anew");
    let meta = MetaData::read_from_buffered(bytes, false).map_err(broken)?;
    let is_table = |name: &Text| name.to_string().starts_with("goniochrome.");
    if meta.headers.iter().any(|header| header.own_attributes.other.keys().any(is_table)) {
        return Err("a BRDF table, where an environment is expected: swap the two".to_owned());
    }
    let source = choose(&meta.headers)?;
    let header = &meta.headers[source.part];
    let (width, height) = (header.layer_size.0, header.layer_size.1);
    let whole = header.shared_attributes.display_window.size;
    if whole != header.layer_size {
        return Err(format!(
            "its pixels are {width} × {height} of a picture of {} × {}; export the whole picture",
            whole.0, whole.1
        ));
    }
    check_size(width, height)?;
    let texels = memory::filled([0.0f32; 3], width * height, "the environment").map_err(|error| error.to_string())?;
    let texels = texels_of(bytes, &source, width, texels).map_err(broken)?;
    let named = header.shared_attributes.chromaticities;
    let primaries = named.map(|c| [c.red, c.green, c.blue, c.white].map(|Vec2(x, y)| [x, y].map(f64::from)));
    Ok(Decoded { size: [width, height], texels, primaries, is_grey: source.is_grey })
}

/// Fills texels from the channels of a picture.
fn texels_of(
    bytes: &[u8],
    source: &PictureChannels,
    width: usize,
    texels: Vec<[f32; 3]>,
) -> Result<Vec<[f32; 3]>, exr::error::Error> {
    // Allocated beforehand, where too little memory is an error; the reader asks for it once, from the layer that it
    // finds.
    let made = Mutex::new(texels);
    let take = || std::mem::take(&mut *made.lock().unwrap_or_else(std::sync::PoisonError::into_inner));
    let name = |channel: &str| Text::from(format!("{}{channel}", source.prefix).as_str());
    let levels = exr::prelude::read().no_deep_data().largest_resolution_level();
    if source.is_grey {
        let set = move |texels: &mut Vec<[f32; 3]>, at: Vec2<usize>, (y,): (f32,)| texels[at.1 * width + at.0] = [y; 3];
        let channels = levels.specific_channels().required(name("Y")).collect_pixels(|_, _| take(), set);
        let read = channels.first_valid_layer().all_attributes().non_parallel();
        return Ok(read.from_buffered(Cursor::new(bytes))?.layer_data.channel_data.pixels);
    }
    let set = move |texels: &mut Vec<[f32; 3]>, at: Vec2<usize>, (r, g, b): (f32, f32, f32)| {
        texels[at.1 * width + at.0] = [r, g, b];
    };
    let channels = levels.specific_channels().required(name("R")).required(name("G")).required(name("B"));
    let read = channels.collect_pixels(|_, _| take(), set).first_valid_layer().all_attributes().non_parallel();
    Ok(read.from_buffered(Cursor::new(bytes))?.layer_data.channel_data.pixels)
}

/// Chooses the channels that are the picture.
fn choose(headers: &[Header]) -> ReadResult<PictureChannels> {
    let (mut colours, mut greys, mut chromas, mut all) = (Vec::new(), Vec::new(), 0, Vec::new());
    for (part, header) in headers.iter().enumerate().filter(|(_, header)| !header.deep) {
        let names: Vec<String> = header.channels.list.iter().map(|channel| channel.name.to_string()).collect();
        for name in &names {
            let has = |prefix: &str, own: &str| names.iter().any(|name| name.strip_prefix(prefix) == Some(own));
            let (prefix, own) = name.rfind('.').map_or(("", name.as_str()), |point| name.split_at(point + 1));
            let source = |is_grey| PictureChannels { part, prefix: prefix.to_owned(), is_grey };
            match own {
                "R" if has(prefix, "G") && has(prefix, "B") => colours.push(source(false)),
                "Y" if has(prefix, "RY") || has(prefix, "BY") => chromas += 1,
                "Y" if !has(prefix, "X") => greys.push(source(true)),
                _ => {}
            }
        }
        all.extend(names);
    }
    if headers.iter().all(|header| header.deep) {
        return Err("its pixels are deep, with many samples each; export a flat picture".to_owned());
    }
    if colours.is_empty() && chromas > 0 {
        return Err("its pixels are luminance and chroma (Y, RY, BY); export R, G, B".to_owned());
    }
    let mut found = if colours.is_empty() { greys } else { colours };
    let count = |test: &dyn Fn(&PictureChannels) -> bool| found.iter().filter(|source| test(source)).count();
    let is_plain = |source: &PictureChannels| source.prefix.is_empty();
    let is_combined = |source: &PictureChannels| source.prefix == "Combined." || source.prefix.ends_with(".Combined.");
    match (count(&is_plain), count(&is_combined)) {
        (1, _) => found.retain(is_plain),
        (0, 1) => found.retain(is_combined),
        _ => {}
    }
    match found.len() {
        1 => Ok(found.remove(0)),
        0 => Err(format!("it holds the channels {}, but neither R, G, B nor Y; export a picture", listed(&all))),
        count => {
            let name = |source: &PictureChannels| {
                let part = headers[source.part].own_attributes.layer_name.as_ref().map(Text::to_string);
                let layer = source.prefix.trim_end_matches('.');
                if layer.is_empty() {
                    part.unwrap_or_else(|| format!("part {}", source.part + 1))
                } else {
                    layer.to_owned()
                }
            };
            let names: Vec<String> = found.iter().map(name).collect();
            Err(format!("it holds {count} pictures: {}; export the one that is the environment", listed(&names)))
        }
    }
}

fn listed(names: &[String]) -> String {
    let shown: Vec<String> = names.iter().take(MAX_LISTED).map(|name| format!("{name:?}")).collect();
    let more = if names.len() > MAX_LISTED { format!(" and {} more", names.len() - MAX_LISTED) } else { String::new() };
    format!("{}{more}", shown.join(", "))
}

#[cfg(test)]
mod tests {
    use exr::prelude::{
        AnyChannel, AnyChannels, Encoding, FlatSamples, Image, ImageAttributes, IntegerBounds, Layer, LayerAttributes,
        WritableImage, f16,
    };

    use super::*;

    const SIZE: (usize, usize) = (4, 2);

    /// A file of these parts. Each channel is its number among all, from 1, everywhere.
    fn file(parts: &[(&str, &[&str])], change: impl Fn(&mut ImageAttributes)) -> Vec<u8> {
        let mut number = 0.0;
        let mut channel = |name: &&str| {
            number += 1.0;
            // Every type of sample takes its turn.
            let samples = match number as usize % 3 {
                0 => FlatSamples::F32(vec![number; 8]),
                1 => FlatSamples::F16(vec![f16::from_f32(number); 8]),
                _ => FlatSamples::U32(vec![number as u32; 8]),
            };
            AnyChannel::new(*name, samples)
        };
        let layers: Vec<_> = parts
            .iter()
            .map(|(name, channels)| {
                let channels = AnyChannels::sort(channels.iter().map(&mut channel).collect());
                Layer::new(SIZE, LayerAttributes::named(*name), Encoding::UNCOMPRESSED, channels)
            })
            .collect();
        let mut attributes = ImageAttributes::new(IntegerBounds::from_dimensions(SIZE));
        change(&mut attributes);
        let mut bytes = Cursor::new(Vec::new());
        let image = Image::from_layers(attributes, layers);
        image.write().non_parallel().to_buffered(&mut bytes).unwrap();
        bytes.into_inner()
    }

    fn texel(parts: &[(&str, &[&str])]) -> [f32; 3] {
        let read = read(&file(parts, |_| {})).unwrap();
        assert!(read.size == [4, 2] && read.texels.iter().all(|texel| *texel == read.texels[0]));
        read.texels[0]
    }

    fn refusal(parts: &[(&str, &[&str])]) -> String {
        read(&file(parts, |_| {})).unwrap_err()
    }

    #[test]
    fn the_one_picture_is_found_in_whatever_layer_and_part() {
        assert_eq!(texel(&[("a", &["R", "G", "B", "A", "Z"])]), [1.0, 2.0, 3.0]);
        assert_eq!(
            texel(&[("a", &["View Layer.Combined.R", "View Layer.Combined.G", "View Layer.Combined.B"])]),
            [1.0, 2.0, 3.0]
        );
        assert_eq!(texel(&[("a", &["beauty.B", "beauty.G", "beauty.R", "depth.Z"])]), [3.0, 2.0, 1.0]);
        // Plain channels before layers, Combined before other layers.
        assert_eq!(texel(&[("a", &["d.R", "d.G", "d.B", "R", "G", "B"])]), [4.0, 5.0, 6.0]);
        assert_eq!(
            texel(&[("a", &["L.Emit.R", "L.Emit.G", "L.Emit.B", "L.Combined.R", "L.Combined.G", "L.Combined.B"])]),
            [4.0, 5.0, 6.0]
        );
        assert_eq!(texel(&[("depth", &["Z"]), ("rgba", &["R", "G", "B"])]), [2.0, 3.0, 4.0]);
    }

    #[test]
    fn luminance_alone_is_grey() {
        assert_eq!(texel(&[("a", &["A", "Y"])]), [2.0; 3]);
        assert!(read(&file(&[("a", &["grey.Y"])], |_| {})).unwrap().is_grey);
        // The middle coordinate of normals is not a luminance.
        assert!(refusal(&[("a", &["N.X", "N.Y", "N.Z"])]).contains("it holds the channels \"N.X\", \"N.Y\", \"N.Z\""));
    }

    #[test]
    fn what_is_ambiguous_is_told_with_what_is_there() {
        let two = refusal(&[("a", &["d.R", "d.G", "d.B", "s.R", "s.G", "s.B"])]);
        assert_eq!(two, "it holds 2 pictures: \"d\", \"s\"; export the one that is the environment");
        let parts = refusal(&[("left", &["R", "G", "B"]), ("right", &["R", "G", "B"])]);
        assert!(parts.contains("it holds 2 pictures: \"left\", \"right\""), "{parts}");
        assert!(refusal(&[("a", &["R", "G"])]).contains("but neither R, G, B nor Y"));
        assert!(refusal(&[("a", &["Y", "RY", "BY"])]).contains("luminance and chroma"));
    }

    #[test]
    fn primaries_are_read_and_cut_pictures_refused() {
        let rgb: [(&str, &[&str]); 1] = [("a", &["R", "G", "B"])];
        let named = exr::meta::attribute::Chromaticities {
            red: Vec2(0.713, 0.293),
            green: Vec2(0.165, 0.83),
            blue: Vec2(0.128, 0.044),
            white: Vec2(0.32168, 0.33767),
        };
        let aces = read(&file(&rgb, |attributes| attributes.chromaticities = Some(named))).unwrap();
        assert!((aces.primaries.unwrap()[1][1] - 0.83).abs() < 1e-6);
        assert_eq!(read(&file(&rgb, |_| {})).unwrap().primaries, None);
        let cut = file(&rgb, |attributes| attributes.display_window = IntegerBounds::from_dimensions((8, 4)));
        assert_eq!(read(&cut).unwrap_err(), "its pixels are 4 × 2 of a picture of 8 × 4; export the whole picture");
    }
}
