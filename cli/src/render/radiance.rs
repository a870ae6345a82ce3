//! Radiance pictures, `.hdr` or `.pic`: red, green and blue with a common exponent.
//!
//! Source: Ward, "Real pixels", Graphics Gems II (1991), and the Radiance file formats (Ward, 1992;
//! `ray/src/common/color.c`).
//!
//! The header is a list of lines that an empty line ends. Each `EXPOSURE` and `COLORCORR` is a factor by which some
//! program multiplied the pixels; all of them are divided out, so that radiance is what it was. The line of the
//! resolution names the axes in the order in which they are stored, the slower first, with the directions in which they
//! run. A scan line is stored plainly, with runs of pixels (old), or with runs of bytes for each component (new).

use super::picture::{Decoded, ReadResult, check_size};
use super::primaries::Primaries;
use crate::support::memory;

/// Largest header in bytes: those that long chains of programs leave are a hundredth of this.
const MAX_HEADER: usize = 1 << 20;

/// What a header says of the pixels.
struct Header {
    /// The factor by which each component was multiplied.
    multiplied: [f64; 3],
    primaries: Option<Primaries>,
}

/// The orientation of scan lines in the picture.
struct Layout {
    size: [usize; 2],
    /// Whether scan lines are columns.
    by_columns: bool,
    from_right: bool,
    from_bottom: bool,
}

/// Reads the picture in the bytes of a file.
pub(super) fn read(bytes: &[u8]) -> ReadResult<Decoded> {
    let mut rest = bytes;
    let broken = |what: String| format!("not a readable Radiance HDR file: {what}");
    let header = header(&mut rest).map_err(broken)?;
    let layout = text_line(&mut rest).and_then(|line| layout(&line)).map_err(broken)?;
    let [width, height] = layout.size;
    check_size(width, height)?;
    let mut texels = memory::filled([0.0f32; 3], width * height, "the environment").map_err(|e| e.to_string())?;
    let (count, length) = if layout.by_columns { (width, height) } else { (height, width) };
    let mut line = vec![[0u8; 4]; length];
    for number in 0..count {
        let place = |what| broken(format!("{what} in scan line {} of {count}; export it anew", number + 1));
        scan_line(&mut rest, &mut line).map_err(place)?;
        for (along, pixel) in line.iter().enumerate() {
            let [x, y] = if layout.by_columns { [number, along] } else { [along, number] };
            let x = if layout.from_right { width - 1 - x } else { x };
            let y = if layout.from_bottom { height - 1 - y } else { y };
            texels[y * width + x] = radiance(*pixel, header.multiplied);
        }
    }
    Ok(Decoded { size: layout.size, texels, primaries: header.primaries, is_grey: false })
}

/// The radiance of a pixel. Mantissas are fractions of 256, exponents are 128 too large; exponent 0 is black.
fn radiance([r, g, b, exponent]: [u8; 4], multiplied: [f64; 3]) -> [f32; 3] {
    if exponent == 0 {
        return [0.0; 3];
    }
    let scale = (f64::from(exponent) - 136.0).exp2();
    let mantissas = [r, g, b];
    std::array::from_fn(|c| (f64::from(mantissas[c]) * scale / multiplied[c]) as f32)
}

/// Takes the next line, without its end, off the bytes.
fn text_line(rest: &mut &[u8]) -> ReadResult<String> {
    let end = rest
        .iter()
        .take(MAX_HEADER)
        .position(|&byte| byte == b'\n')
        .ok_or("its header does not end; export it anew")?;
    let line = String::from_utf8_lossy(&rest[..end]).trim_end_matches('\r').to_owned();
    *rest = &rest[end + 1..];
    Ok(line)
}

fn header(rest: &mut &[u8]) -> ReadResult<Header> {
    let start = rest.len();
    let mut header = Header { multiplied: [1.0; 3], primaries: None };
    loop {
        let line = text_line(rest)?;
        if line.is_empty() {
            return Ok(header);
        }
        if start - rest.len() > MAX_HEADER {
            return Err("its header does not end; export it anew".to_owned());
        }
        // Lines that start with a blank repeat the headers of a program's inputs.
        let Some((key, value)) = line.split_once('=') else { continue };
        let value = value.trim();
        match key {
            "FORMAT" if value == "32-bit_rle_rgbe" => {}
            "FORMAT" if value == "32-bit_rle_xyze" => {
                return Err("its pixels are X, Y, Z; convert it to R, G, B, with `ra_xyze -r` of Radiance".to_owned());
            }
            "FORMAT" => return Err(format!("its format is {value:?}; save it as 32-bit_rle_rgbe")),
            "EXPOSURE" => {
                let factor = factors::<1>(&line, value)?[0];
                header.multiplied = header.multiplied.map(|m| m * factor);
            }
            "COLORCORR" => {
                let by = factors::<3>(&line, value)?;
                header.multiplied = std::array::from_fn(|c| header.multiplied[c] * by[c]);
            }
            "GAMMA" if factors::<1>(&line, value)? != [1.0] => {
                return Err(format!("{line}: its pixels are not linear; save it with a gamma of 1"));
            }
            "PRIMARIES" => {
                let numbers = numbers::<8>(&line, value, |x| x.is_finite())?;
                // Photoshop writes zeros for what it does not know.
                let is_known = numbers != [0.0; 8];
                header.primaries = is_known.then(|| std::array::from_fn(|i| [numbers[2 * i], numbers[2 * i + 1]]));
            }
            _ => {}
        }
        let sound = |m: &f64| m.is_finite() && *m > 0.0;
        if !header.multiplied.iter().all(sound) {
            return Err(format!("{line}: its exposures multiply to what is no number above 0; correct its header"));
        }
    }
}

/// Reads the factors in a header line, each finite and above 0.
fn factors<const N: usize>(line: &str, value: &str) -> ReadResult<[f64; N]> {
    numbers(line, value, |x| x.is_finite() && x > 0.0)
}

/// Reads the numbers in a header line.
fn numbers<const N: usize>(line: &str, value: &str, is_sound: impl Fn(f64) -> bool) -> ReadResult<[f64; N]> {
    let numbers: Option<Vec<f64>> = value.split_ascii_whitespace().map(|word| word.parse().ok()).collect();
    let numbers = numbers.and_then(|numbers| <[f64; N]>::try_from(numbers).ok());
    let shown: String = line.chars().take(80).collect();
    numbers
        .filter(|numbers| numbers.iter().all(|x| is_sound(*x)))
        .ok_or_else(|| format!("{shown:?} is not the {N} numbers that belong there; correct its header"))
}

/// Reads the line of the resolution, such as `-Y 512 +X 1024`.
fn layout(line: &str) -> ReadResult<Layout> {
    let words: Vec<&str> = line.split_ascii_whitespace().collect();
    let shown: String = line.chars().take(80).collect();
    let wrong = || format!("{shown:?} is no resolution such as \"-Y 512 +X 1024\"");
    let [first, slow, second, fast] = <[&str; 4]>::try_from(words).map_err(|_| wrong())?;
    let [slow, fast] = [slow, fast].map(|word| word.parse::<usize>().ok());
    let (slow, fast) = slow.zip(fast).ok_or_else(wrong)?;
    // Y grows upwards, rows are counted from the top.
    let (by_columns, x, y) = match (first, second) {
        ("-Y" | "+Y", "+X" | "-X") => (false, second, first),
        ("+X" | "-X", "-Y" | "+Y") => (true, first, second),
        _ => return Err(wrong()),
    };
    let size = if by_columns { [slow, fast] } else { [fast, slow] };
    Ok(Layout { size, by_columns, from_right: x == "-X", from_bottom: y == "+Y" })
}

/// Reads a scan line in any of the three codings.
fn scan_line(rest: &mut &[u8], line: &mut [[u8; 4]]) -> ReadResult<()> {
    const ENDS: &str = "it ends";
    let head: [u8; 4] = *rest.first_chunk().ok_or(ENDS)?;
    let coded = head[0] == 2 && head[1] == 2 && head[2] < 128 && (8..1 << 15).contains(&line.len());
    if !coded {
        return old_scan_line(rest, line);
    }
    if usize::from(head[2]) << 8 | usize::from(head[3]) != line.len() {
        return Err("a wrong length".to_owned());
    }
    *rest = &rest[4..];
    for component in 0..4 {
        let mut at = 0;
        while at < line.len() {
            let (&code, after) = rest.split_first().ok_or(ENDS)?;
            let count = usize::from(if code > 128 { code - 128 } else { code });
            let stored = if code > 128 { 1 } else { count };
            if count == 0 || at + count > line.len() {
                return Err("a run of a wrong length".to_owned());
            }
            let (values, after) = after.split_at_checked(stored).ok_or(ENDS)?;
            for (pixel, value) in line[at..at + count].iter_mut().zip(values.iter().cycle()) {
                pixel[component] = *value;
            }
            *rest = after;
            at += count;
        }
    }
    Ok(())
}

/// Reads a scan line of plain pixels and runs of them: the pixel 1, 1, 1, n repeats the last one n times. The count of
/// a run that directly follows another stands for 256 times as many pixels.
fn old_scan_line(rest: &mut &[u8], line: &mut [[u8; 4]]) -> ReadResult<()> {
    let (mut at, mut shift) = (0, 0);
    while at < line.len() {
        let (&pixel, after) = rest.split_first_chunk::<4>().ok_or("it ends")?;
        *rest = after;
        if let [1, 1, 1, count] = pixel {
            let count = usize::from(count).checked_shl(shift).unwrap_or(usize::MAX);
            let end = at.checked_add(count).filter(|&end| at > 0 && shift < 32 && end <= line.len());
            let end = end.ok_or("a run of a wrong length")?;
            let last = line[at - 1];
            line[at..end].fill(last);
            (at, shift) = (end, shift + 8);
        } else {
            line[at] = pixel;
            (at, shift) = (at + 1, 0);
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A file of 4 × 2 stored pixels with mantissas 128, 64 and their number, stored as they are.
    fn file(header: &str, resolution: &str) -> Vec<u8> {
        let mut bytes = format!("{header}\n{resolution}\n").into_bytes();
        (0..8).for_each(|i: u8| bytes.extend([128, 64, i, 136]));
        bytes
    }

    const RGBE: &str = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n";

    fn numbers(bytes: &[u8]) -> Vec<f32> {
        read(bytes).unwrap().texels.iter().map(|texel| texel[2]).collect()
    }

    fn refusal(bytes: &[u8]) -> String {
        read(bytes).unwrap_err()
    }

    #[test]
    fn every_program_and_orientation_is_read() {
        for header in
            [RGBE, "#?RGBE\n", "#?RGBE\nFORMAT=32-bit_rle_rgbe\r\n# made by nobody\r\n", "#?AUTOPANO\nGAMMA=1\n"]
        {
            let picture = read(&file(header, "-Y 2 +X 4")).unwrap();
            assert_eq!((picture.size, picture.texels[7]), ([4, 2], [128.0, 64.0, 7.0]), "{header}");
        }
        let orders: [(&str, [u8; 8]); 8] = [
            ("-Y 2 +X 4", [0, 1, 2, 3, 4, 5, 6, 7]),
            ("+Y 2 +X 4", [4, 5, 6, 7, 0, 1, 2, 3]),
            ("-Y 2 -X 4", [3, 2, 1, 0, 7, 6, 5, 4]),
            ("+Y 2 -X 4", [7, 6, 5, 4, 3, 2, 1, 0]),
            ("+X 4 -Y 2", [0, 2, 4, 6, 1, 3, 5, 7]),
            ("-X 4 -Y 2", [6, 4, 2, 0, 7, 5, 3, 1]),
            ("+X 4 +Y 2", [1, 3, 5, 7, 0, 2, 4, 6]),
            ("-X 4 +Y 2", [7, 5, 3, 1, 6, 4, 2, 0]),
        ];
        for (resolution, order) in orders {
            assert_eq!(numbers(&file(RGBE, resolution)), order.map(f32::from), "{resolution}");
        }
    }

    #[test]
    fn exposures_and_colour_corrections_are_divided_out() {
        let header = format!("{RGBE}EXPOSURE=2\npcomb a.hdr\n\tEXPOSURE=99\nEXPOSURE= 4.0 \nCOLORCORR=1 2 0.5\n");
        let texel = read(&file(&header, "-Y 2 +X 4")).unwrap().texels[6];
        assert_eq!(texel, [128.0 / 8.0, 64.0 / 16.0, 6.0 / 4.0]);
        for line in
            ["EXPOSURE=0", "EXPOSURE=-1", "EXPOSURE=bright", "EXPOSURE=nan", "COLORCORR=1 1", "COLORCORR=1 1 1 1"]
        {
            let message = refusal(&file(&format!("{RGBE}{line}\n"), "-Y 2 +X 4"));
            assert!(message.contains(line) && message.contains("that belong there"), "{message}");
        }
        let often = format!("{RGBE}{}", "EXPOSURE=1e-300\n".repeat(2));
        assert!(refusal(&file(&often, "-Y 2 +X 4")).contains("multiply to what is no number above 0"));
    }

    #[test]
    fn colours_of_another_kind_are_told() {
        let told = |line: &str| refusal(&file(&format!("#?RADIANCE\n{line}\n"), "-Y 2 +X 4"));
        assert!(told("FORMAT=32-bit_rle_xyze").contains("its pixels are X, Y, Z"));
        assert!(told("FORMAT=8-bit").contains("its format is \"8-bit\""));
        assert!(told("GAMMA=2.2").contains("GAMMA=2.2: its pixels are not linear"));
        let named = |primaries: &str| read(&file(&format!("{RGBE}PRIMARIES={primaries}\n"), "-Y 2 +X 4"));
        let rec_2020 = "0.708 0.292 0.170 0.797 0.131 0.046 0.3127 0.329";
        assert_eq!(named(rec_2020).unwrap().primaries.unwrap()[2], [0.131, 0.046]);
        assert_eq!(named("0 0 0 0 0 0 0 0").unwrap().primaries, None);
        assert!(["", "x", "0.6 0.3"].iter().all(|line| named(line).unwrap_err().contains("is not the 8 numbers")));
    }

    #[test]
    fn all_three_codings_give_one_picture() {
        let plain: Vec<[u8; 4]> = (0..32u8).map(|i| if i < 20 { [9, 8, 7, 136] } else { [i, 200, 1, 130] }).collect();
        let start = format!("{RGBE}\n-Y 4 +X 8\n").into_bytes();
        let flat: Vec<u8> = start.iter().copied().chain(plain.iter().flatten().copied()).collect();
        // Old: one pixel and seven repetitions; runs do not go on into the next line.
        let mut old = start.clone();
        (0..2).for_each(|_| old.extend([9, 8, 7, 136, 1, 1, 1, 7]));
        old.extend([9, 8, 7, 136, 1, 1, 1, 3]);
        old.extend(plain[20..].iter().flatten());
        // New: each component of a line by itself, as a run where it is one.
        let mut new = start.clone();
        for line in plain.chunks(8) {
            new.extend([2, 2, 0, 8]);
            for c in 0..4 {
                if line.iter().all(|pixel| pixel[c] == line[0][c]) {
                    new.extend([128 + 8, line[0][c]]);
                } else {
                    new.extend([3, line[0][c], line[1][c], line[2][c], 5]);
                    new.extend(line[3..].iter().map(|pixel| pixel[c]));
                }
            }
        }
        let texels = read(&flat).unwrap().texels;
        assert_eq!(texels[20], [20.0 / 64.0, 200.0 / 64.0, 1.0 / 64.0]);
        assert_eq!(read(&old).unwrap().texels, texels);
        assert_eq!(read(&new).unwrap().texels, texels);
        for whole in [flat, old, new] {
            for length in 0..whole.len() {
                assert!(!refusal(&whole[..length]).contains('\n'));
            }
        }
    }

    #[test]
    fn long_runs_of_the_old_coding_count_in_their_next_bytes() {
        let mut bytes = format!("{RGBE}\n-Y 300 +X 600\n").into_bytes();
        for _ in 0..300 {
            // 1 + 87 + 2 · 256 pixels.
            bytes.extend([128, 128, 128, 129, 1, 1, 1, 87, 1, 1, 1, 2]);
        }
        assert!(read(&bytes).unwrap().texels.iter().all(|texel| *texel == [1.0; 3]));
        let short = bytes.len() - 1;
        bytes[short] = 3;
        assert!(refusal(&bytes).contains("a run of a wrong length in scan line 300 of 300"));
        // A run that repeats nothing.
        assert!(refusal(&[RGBE.as_bytes(), b"\n-Y 1 +X 2\n", &[1, 1, 1, 2]].concat()).contains("wrong length"));
    }

    #[test]
    fn damaged_headers_are_told() {
        let endless = "not a readable Radiance HDR file: its header does not end; export it anew";
        assert_eq!(refusal(b"#?RADIANCE\n"), endless);
        assert_eq!(refusal(b"#?RADIANCE"), endless);
        for line in ["", "-Y 2", "-Y 2 +X x", "-Y 2 +Y 4", "Y 2 X 4", "-Y -2 +X 4", "-Y 2 +X 99999999999999999999"] {
            assert!(refusal(&file(RGBE, line)).contains("is no resolution such as"), "{line}");
        }
        assert!(refusal(&file(RGBE, "-Y 2 +X 3")).contains("3 × 2 texels are no lat-long image"));
        assert!(refusal(&file(RGBE, "-Y 15000 +X 30000")).contains("too many"));
        let mut wrong = format!("{RGBE}\n-Y 4 +X 8\n").into_bytes();
        wrong.extend([2, 2, 0, 9, 0, 0, 0, 0]);
        assert!(refusal(&wrong).ends_with("a wrong length in scan line 1 of 4; export it anew"));
    }
}
