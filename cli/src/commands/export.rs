//! The command `goniochrome export`.

use std::path::{Path, PathBuf};
use std::slice;

use goniochrome::table::blob::Precision;

use crate::commands::args::{ExportArgs, ExportKind, Origin, RoughnessArg, finish_choice, spelled};
use crate::commands::thickness_option::one_surface;
use crate::export::blob;
use crate::export::gltf::Fitted;
use crate::export::lut::Lut;
use crate::export::order_lut::{self, OrderLut};
use crate::export::{LobeWidth, ShaderLanguage, bsdf, merl, png};
use crate::scene::vary::Vary;
use crate::scene::{OwnedFinish, Scene, load, parse_without_finish};
use crate::support::error::{Error, Result};
use crate::support::output;
use crate::support::progress::note;
use crate::table::finish::FinishChoice;
use crate::table::metadata::MetadataKey;
use crate::table::{Table, file};

/// The default number of texels over cos θ.
const WIDTH: u16 = 256;

pub fn run(args: &ExportArgs) -> Result<()> {
    check_options(args)?;
    if args.to == ExportKind::Blob {
        return write_blob(args);
    }
    check_name(args)?;
    let inputs = [PathBuf::from(&args.source)];
    output::check_destination(&args.output, &inputs)?;
    if args.to == ExportKind::Lut {
        return lut(args, &inputs);
    }
    if args.to == ExportKind::Gltf {
        return gltf(args);
    }
    if args.to == ExportKind::OrderLut {
        return order_lut(args, &inputs);
    }
    let table = one_surface(read_table(args)?, args.thickness)?;
    let named = |error| named(args, error);
    let width = LobeWidth {
        finish: finish_choice(args.roughness, args.distribution, args.compensating.energy_compensation),
        spread_deg: args.spread,
    };
    let (bytes, residual) = match args.to {
        ExportKind::Merl => merl::encode(&table, width).map_err(named)?,
        _ => (bsdf::encode(&table, width, args.rgb.then(|| args.gamut.unwrap_or_default())).map_err(named)?, None),
    };
    output::write_file(&args.output, &bytes)?;
    let output = args.output.display();
    note(args.quiet, format_args!("{output}: {} bytes", bytes.len()));
    if let Some(residual) = residual {
        note(args.quiet, format_args!("{output}: {residual}"));
    }
    if matches!(&table, Table::Mirror(mirror) if mirror.is_transparent()) {
        note(args.quiet, format_args!("{output}: {} holds reflected light alone", spelled(args.to)));
    }
    Ok(())
}

/// Writes the blob of a table.
fn write_blob(args: &ExportArgs) -> Result<()> {
    let source = Path::new(&args.source);
    output::check_destination(&args.output, slice::from_ref(&source.to_owned()))?;
    let table = read_table(args)?;
    let finish = finish_choice(args.roughness, args.distribution, args.compensating.energy_compensation);
    if finish.is_given() && !matches!(table, Table::Mirror(_)) {
        return Err(Error::usage(format_args!(
            "--roughness, --distribution, --energy-compensation: are for mirror-like tables, and {} is none; leave them out",
            args.source
        )));
    }
    let precision = if args.half { Precision::Half } else { Precision::Single };
    let bytes = blob::encode(&table, finish, precision).map_err(|error| named(args, error))?;
    output::write_file(&args.output, &bytes)?;
    note(args.quiet, format_args!("{}: {} bytes", args.output.display(), bytes.len()));
    Ok(())
}

/// The error of a source, with its name.
fn named(args: &ExportArgs, error: Error) -> Error {
    let line = format!("{}: {error}", args.source);
    if error.exit_code() == 2 { Error::usage(line) } else { Error::failed(line) }
}

/// Reads the table, for formats that take nothing else.
fn read_table(args: &ExportArgs) -> Result<Table> {
    let path = Path::new(&args.source);
    if !is_table(path) {
        return Err(Error::usage(format_args!(
            "--to {} takes a table; make one by `goniochrome estimate {} -o table.exr`",
            spelled(args.to),
            args.source
        )));
    }
    file::read(path)
}

/// Whether a file name is that of a table.
fn is_table(path: &Path) -> bool {
    has_extension(path, "exr")
}

fn has_extension(path: &Path, wanted: &str) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case(wanted))
}

/// Refuses options that the format has no use for, so that none is silently ignored.
fn check_options(args: &ExportArgs) -> Result<()> {
    let lut = args.to == ExportKind::Lut;
    for (given, name, fits, of) in [
        (args.roughness.is_some(), "roughness", args.to != ExportKind::OrderLut, "other formats"),
        (args.distribution.is_some(), "distribution", args.to != ExportKind::OrderLut, "other formats"),
        (
            args.compensating.energy_compensation.is_some(),
            "energy-compensation",
            args.to != ExportKind::OrderLut,
            "other formats",
        ),
        (
            args.thickness.is_some(),
            "thickness",
            matches!(args.to, ExportKind::Merl | ExportKind::Bsdf | ExportKind::Gltf),
            "merl, bsdf and gltf",
        ),
        (args.rgb, "rgb", args.to == ExportKind::Bsdf, "bsdf"),
        (args.gamut.is_some(), "gamut", args.to == ExportKind::Bsdf && args.rgb, "bsdf with --rgb"),
        (args.width.is_some(), "width", lut, "lut"),
        (args.vary.is_some(), "vary", lut, "lut"),
        (args.origin.is_some(), "origin", lut, "lut"),
        (args.bands.is_some(), "bands", args.to == ExportKind::OrderLut, "order-lut"),
        (args.spread.is_some(), "spread", matches!(args.to, ExportKind::Merl | ExportKind::Bsdf), "merl and bsdf"),
        (args.shader.is_some(), "shader", lut || args.to == ExportKind::OrderLut, "lut and order-lut"),
        (args.facets.is_some(), "facets", lut, "lut"),
        (args.compensation.is_some(), "compensation", lut, "lut"),
        (args.half, "half", args.to == ExportKind::Blob, "blob"),
    ] {
        if given && !fits {
            return Err(Error::usage(format_args!(
                "--{name} is for --to {of}; leave it out of --to {}",
                spelled(args.to)
            )));
        }
    }
    if matches!(args.to, ExportKind::Merl | ExportKind::Bsdf) && args.roughness == Some(RoughnessArg([0.0; 2])) {
        return Err(Error::usage(format_args!(
            "--roughness 0: must lie in (0, 1], since --to {} holds no mirrors",
            spelled(args.to)
        )));
    }
    Ok(())
}

/// Refuses file names with the extension of another format.
fn check_name(args: &ExportArgs) -> Result<()> {
    let wanted: &[&str] = match args.to {
        ExportKind::Lut => &["exr", "png"],
        ExportKind::OrderLut => &["exr"],
        ExportKind::Merl => &["binary"],
        ExportKind::Bsdf => &["bsdf"],
        ExportKind::Gltf => &["gltf"],
        ExportKind::Blob => return Ok(()), // any name will do
    };
    if !wanted.iter().any(|extension| has_extension(&args.output, extension)) {
        let (output, kind, wanted) = (args.output.display(), spelled(args.to), wanted.join(" or ."));
        return Err(Error::usage(format_args!("{output}: --to {kind} writes .{wanted}; name it so")));
    }
    Ok(())
}

/// Writes a lut, with its shader function if one is asked for.
fn lut(args: &ExportArgs, inputs: &[PathBuf]) -> Result<()> {
    let shader = args.shader.as_deref().map(language).transpose()?;
    if let Some(path) = &args.shader {
        output::check_destination(path, inputs)?;
        output::refuse_same_output(&args.output, path)?;
    }
    let mut outputs: Vec<&PathBuf> = [Some(&args.output), args.shader.as_ref()].into_iter().flatten().collect();
    for (option, path) in [("facets", &args.facets), ("compensation", &args.compensation)] {
        let Some(path) = path else { continue };
        if !has_extension(path, "exr") {
            return Err(Error::usage(format_args!("--{option} {}: name it .exr", path.display())));
        }
        output::check_destination(path, inputs)?;
        for other in &outputs {
            output::refuse_same_output(other, path)?;
        }
        outputs.push(path);
    }
    let width = usize::from(args.width.unwrap_or(WIDTH));
    let finish = finish_choice(args.roughness, args.distribution, args.compensating.energy_compensation);
    let path = Path::new(&args.source);
    let to_png = has_extension(&args.output, "png");
    let lut = if is_table(path) {
        if args.vary.is_some() {
            return Err(Error::usage(
                "--vary needs a scene; a table has the thicknesses that `estimate --vary` has given it",
            ));
        }
        match file::read(path)? {
            Table::Mirror(table) => {
                let named = |error| named(args, error);
                let mut lut = Lut::of_table(&table, width).map_err(named)?;
                lut.finish = finish.of(&table.metadata).map_err(named)?;
                if table.is_transparent() {
                    let output = args.output.display();
                    note(args.quiet, format_args!("{output}: a lut holds the reflectance, and not what goes through"));
                }
                if to_png {
                    // Its chunks say sRGB, whatever the table's space.
                    lut.texels = table.metadata.screen_rgb(&lut.texels);
                    lut.space = table.metadata.screen_space();
                }
                lut
            }
            Table::Scatter(_) => {
                return Err(Error::failed(format_args!(
                    "{}: the table scatters into all directions, a lut holds mirror-like reflection alone; export a bsdf",
                    args.source
                )));
            }
            Table::Orders(_) => {
                return Err(Error::failed(format_args!(
                    "{}: the table holds diffraction orders, a lut holds mirror-like reflection alone; export an order-lut",
                    args.source
                )));
            }
        }
    } else {
        let scene = load(&args.source)?;
        output::check_destination(&args.output, &scene.files)?;
        let finish = finish.instead_of(scene.finish.clone()).map_err(|error| named(args, error))?;
        let mut lut = Lut::of_scene(&scene, width, args.vary)?;
        lut.finish = finish;
        lut
    };
    if args.origin.is_some() && lut.rows_nm.is_none() {
        return Err(Error::usage("--origin is for the rows of --vary; this lut has one row: leave it out"));
    }
    let tabulated = lut.finish.as_ref().is_some_and(|finish| finish.tabulated().is_some());
    let compensated = lut.finish.as_ref().is_some_and(OwnedFinish::is_compensated);
    for (option, path, is_used, what, held) in [
        ("facets", &args.facets, tabulated, "a finish of tabulated facets", "tabulated facets"),
        ("compensation", &args.compensation, compensated, "a finish with energy compensation", "energy compensation"),
    ] {
        if path.is_some() && !is_used {
            return Err(Error::usage(format_args!(
                "--{option} is for {what}, and {} has none: leave it out",
                args.source
            )));
        }
        if is_used && shader.is_some() && path.is_none() {
            return Err(Error::usage(format_args!(
                "--{option} is missing: the shader functions of {} read its {held} from a texture; name it, as \
                 --{option} {option}.exr",
                args.source
            )));
        }
    }
    if lut.finish.is_some() && shader.is_none() {
        note(
            args.quiet,
            format_args!(
                "{}: the texture holds the reflectance of the facets; --shader writes functions for the finish",
                args.output.display()
            ),
        );
    }
    let lut = if args.origin == Some(Origin::Bottom) { lut.turned_over() } else { lut };
    let bytes = if to_png { png::encode(&lut)? } else { lut.exr()? };
    let mut files = vec![(&args.output, bytes)];
    files.extend(args.shader.as_ref().zip(shader).map(|(path, language)| (path, lut.shader(language).into_bytes())));
    if let Some(path) = &args.facets {
        files.extend(lut.facets_exr()?.map(|bytes| (path, bytes)));
    }
    if let Some(path) = &args.compensation {
        files.extend(lut.compensation_exr()?.map(|bytes| (path, bytes)));
    }
    write_all(&files)?;
    let height = lut.texels.len() / width;
    let output = args.output.display();
    note(args.quiet, format_args!("{output}: {width} × {height} texels"));
    if let Some([first, last]) = lut.rows_nm {
        let bottom = args.origin == Some(Origin::Bottom);
        let fits = if bottom { "v = 0 is the bottom of a picture" } else { "rows are uploaded in the file's order" };
        let other = if bottom { "" } else { "; for Blender and three.js add --origin bottom" };
        note(
            args.quiet,
            format_args!("{output}: first row {first} nm, last row {last} nm, for programs in which {fits}{other}"),
        );
    }
    Ok(())
}

/// Writes files, each of which appears when those after it have been written.
fn write_all(files: &[(&PathBuf, Vec<u8>)]) -> Result<()> {
    let Some(((path, bytes), rest)) = files.split_first() else { return Ok(()) };
    output::write_file_and(path, bytes, || write_all(rest))
}

/// Writes a glTF material and notes how well it fits.
fn gltf(args: &ExportArgs) -> Result<()> {
    let path = Path::new(&args.source);
    let mut scene = if is_table(path) {
        scene_of_table(path, args.thickness)?
    } else {
        if args.thickness.is_some() {
            return Err(Error::usage(
                "--thickness: is for tables over a thickness; a scene names its own: leave it out",
            ));
        }
        load(&args.source)?
    };
    output::check_destination(&args.output, &scene.files)?;
    let finish = finish_choice(args.roughness, args.distribution, args.compensating.energy_compensation);
    scene.finish = finish.instead_of(scene.finish.take()).map_err(|error| named(args, error))?;
    let fitted = Fitted::new(&scene)?;
    output::write_text(&args.output, &fitted.json())?;
    for line in fitted.report() {
        note(args.quiet, format_args!("{}: {line}", args.output.display()));
    }
    Ok(())
}

/// The scene in a table's header.
fn scene_of_table(path: &Path, thickness_nm: Option<f64>) -> Result<Scene> {
    let name = path.display();
    let family = file::read(path)?;
    let axis = if let Table::Mirror(mirror) = &family { mirror.thickness.clone() } else { None };
    let table = match one_surface(family, thickness_nm)? {
        Table::Mirror(table) => table,
        Table::Scatter(_) => {
            return Err(Error::failed(format_args!(
                "{name}: the table scatters into all directions, and glTF's iridescence is a plane film; export a bsdf"
            )));
        }
        Table::Orders(_) => {
            return Err(Error::failed(format_args!(
                "{name}: the table holds diffraction orders, and glTF's iridescence is a plane film; export an order-lut"
            )));
        }
    };
    let metadata = &table.metadata;
    if metadata.get(MetadataKey::Model) == Some("paper") {
        return Err(Error::failed(format_args!(
            "{name}: made with --model paper, and glTF's film obeys physics; make the table without"
        )));
    }
    let toml = metadata
        .get(MetadataKey::SceneToml)
        .ok_or_else(|| Error::failed(format_args!("{name}: its header holds no scene; export the scene itself")))?;
    let mut scene = parse_without_finish(&format!("scene in {name}"), toml)
        .map_err(|error| Error::failed(format_args!("{error}; export the scene file itself")))?;
    scene.finish = FinishChoice::default().of(metadata)?;
    if let Some(known) = metadata.get(MetadataKey::Scene) {
        known.clone_into(&mut scene.name);
    }
    match (axis, thickness_nm) {
        (Some(axis), Some(nm)) => {
            let range_nm = axis.range_nm();
            Vary { layer: axis.layer, range_nm, steps: 2 }.scene_at(&scene, nm)
        }
        _ => Ok(scene),
    }
}

/// The language of a shader file's extension.
fn language(path: &Path) -> Result<ShaderLanguage> {
    match path.extension().and_then(|extension| extension.to_str()) {
        Some("glsl") => Ok(ShaderLanguage::Glsl),
        Some("hlsl") => Ok(ShaderLanguage::Hlsl),
        Some("wgsl") => Ok(ShaderLanguage::Wgsl),
        _ => Err(Error::usage(format_args!("--shader {}: name it .glsl, .hlsl or .wgsl", path.display()))),
    }
}

/// Writes a texture of diffraction orders, with its shader function if one is asked for.
fn order_lut(args: &ExportArgs, inputs: &[PathBuf]) -> Result<()> {
    let shader = args.shader.as_deref().map(|path| language(path).map(|language| (path, language))).transpose()?;
    if let Some((path, _)) = shader {
        output::check_destination(path, inputs)?;
        output::refuse_same_output(&args.output, path)?;
    }
    let Table::Orders(table) = read_table(args)? else {
        return Err(Error::failed(format_args!(
            "{}: the table holds no diffraction orders; export a lut or a bsdf",
            args.source
        )));
    };
    let named = |error: Error| Error::failed(format_args!("{}: {error}", args.source));
    let lut = OrderLut::new(&table, args.bands.unwrap_or(order_lut::WAVELENGTHS)).map_err(named)?;
    let bytes = lut.exr().map_err(named)?;
    match shader {
        Some((path, language)) => {
            let text = lut.shader(language);
            output::write_file_and(&args.output, &bytes, || output::write_file(path, text.as_bytes()))?;
        }
        None => output::write_file(&args.output, &bytes)?,
    }
    let ([width, height], orders, bands) = (lut.size(), table.orders.len(), lut.wavelength_nm().len());
    let output = args.output.display();
    note(args.quiet, format_args!("{output}: {width} × {height} texels, {orders} orders at {bands} wavelengths"));
    Ok(())
}
