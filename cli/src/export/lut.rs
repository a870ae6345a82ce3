//! Look-up textures for shaders: linear RGB reflectance over cos θ and, optionally, over the thickness of a layer.
//!
//! The first and the last texel centre lie at the ends of an axis: column x of N is cos θ = x/(N − 1), from grazing to
//! normal incidence. Row y of M, from the top of the image, is parameter y/(M − 1); [`Lut::turned_over`] counts rows
//! from the bottom. OpenEXR keeps values as half floats, negative ones (out of gamut) too; [`super::png`] brings them
//! into the gamut. The header describes the texels: see [`Lut::about`]. A finish is in the shader functions, not in the
//! texels.

use std::collections::BTreeMap;

use exr::meta::attribute::Chromaticities;
use exr::prelude::{FlatSamples, Vec2, f16};
use goniochrome::colour::{Illuminant, RgbSpace, VISIBLE_NM};
use goniochrome::microfacet::{Compensation, Distribution, Masking};
use goniochrome::optics::interface::Model;

use super::shader::ShaderLanguage;
use super::texture;
use crate::colour::space_name;
use crate::scene::vary::Vary;
use crate::scene::{DISTRIBUTIONS, MASKINGS, OwnedFinish, Scene};
use crate::solve::integral::Integral;
use crate::solve::planar_scene::PlanarScene;
use crate::solve::precision::Precision;
use crate::solve::spectra::{Method, SpectraRequest};
use crate::support::error::Result;
use crate::support::parallel;
use crate::support::text;
use crate::table::file::PREFIX;
use crate::table::finish::{TABULATED, name_of, returned};
use crate::table::mirror::{MirrorTable, ThicknessAxis, neighbours};

/// A look-up texture.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Lut {
    /// Number of texels over cos θ.
    pub width: usize,
    /// Linear RGB, row by row from the top.
    pub texels: Vec<[f32; 3]>,
    /// The colour space of the texels.
    pub space: RgbSpace,
    /// Entries of the header about the scene, the light and, where a thickness is varied, the layer.
    pub(super) facts: BTreeMap<&'static str, String>,
    /// Thickness of the varied layer in the first and the last row, in nm.
    pub rows_nm: Option<[f64; 2]>,
    /// The finish of the surface, which the shader functions hold.
    pub finish: Option<OwnedFinish>,
}

/// The angle θ of each column, in degrees.
fn angles(width: usize) -> impl Iterator<Item = f64> {
    (0..width).map(move |x| (x as f64 / (width - 1) as f64).acos().to_degrees())
}

impl Lut {
    /// A texture of a table, in the table's colour space, constant beyond its last angle: one row, or as many rows at
    /// even steps of the thickness as the table has thicknesses.
    ///
    /// # Errors
    /// A table without colours.
    pub fn of_table(table: &MirrorTable, width: usize) -> Result<Self> {
        table.colours()?;
        let mut facts = facts(table.metadata.scene_name(), table.metadata.illuminant());
        let last = table.thicknesses() - 1;
        let row = |step: usize| {
            let (below, above, weight) = match &table.thickness {
                None => (0, 0, 0.0),
                Some(axis) => {
                    let [from, to] = axis.range_nm();
                    neighbours(&axis.nm, from + (to - from) * step as f64 / last as f64)
                }
            };
            angles(width).map(move |theta| {
                let [low, high] = [below, above].map(|thickness| table.rgb_of(thickness, theta));
                std::array::from_fn(|c| low[c] + weight as f32 * (high[c] - low[c]))
            })
        };
        if let Some(axis) = &table.thickness {
            facts.insert("varied_layer", axis.layer.to_string());
        }
        Ok(Self {
            width,
            texels: (0..=last).flat_map(row).collect(),
            space: table.metadata.space(),
            facts,
            rows_nm: table.thickness.as_ref().map(ThicknessAxis::range_nm),
            finish: None,
        })
    }

    /// A texture of a planar scene, exact at every texel: closed form, D65, linear sRGB.
    ///
    /// # Errors
    /// A scene that is not planar, has no such layer, or names media that are unknown at visible wavelengths.
    pub fn of_scene(scene: &Scene, width: usize, vary: Option<Vary>) -> Result<Self> {
        let facts = facts(&scene.name, Illuminant::D65);
        let Some(vary) = vary else {
            return Ok(Self { width, texels: row(scene, width)?, facts, ..Self::default() });
        };
        let mut texels = Vec::with_capacity(width * usize::from(vary.steps));
        for thickness_nm in vary.thicknesses() {
            texels.extend(row(&vary.scene_at(scene, thickness_nm)?, width)?);
        }
        let mut lut = Self { width, texels, facts, rows_nm: Some(vary.range_nm), ..Self::default() };
        lut.facts.insert("varied_layer", vary.layer.to_string());
        Ok(lut)
    }

    /// The texture with its rows counted from the bottom of the image.
    #[must_use]
    pub fn turned_over(mut self) -> Self {
        self.texels = self.texels.chunks(self.width).rev().flatten().copied().collect();
        self.rows_nm = self.rows_nm.map(|[first, last]| [last, first]);
        self
    }

    /// Keys and values of the header: scene, light and space of the colours, and the meaning of columns and rows.
    #[must_use]
    pub fn about(&self) -> BTreeMap<String, String> {
        let space = space_name(self.space).to_owned();
        let mut about = self.facts.clone();
        about.insert("kind", "lut".into());
        about.insert("colour_space", space);
        about.insert("first_column_cos_theta", "0".into());
        about.insert("last_column_cos_theta", "1".into());
        if let Some([first, last]) = self.rows_nm {
            about.insert("first_row_thickness_nm", first.to_string());
            about.insert("last_row_thickness_nm", last.to_string());
        }
        if let Some(finish) = self.finish.as_ref().map(OwnedFinish::uncompensated) {
            let distribution = finish.distribution().map_or(TABULATED, |known| name_of(&DISTRIBUTIONS, known));
            about.insert("finish_distribution", distribution.into());
            about.insert("finish_masking", name_of(&MASKINGS, finish.masking()).into());
            if self.finish.as_ref().is_some_and(OwnedFinish::is_compensated) {
                about.insert("finish_energy_compensation", "true".into());
            }
            if let Some([x, y]) = finish.alpha() {
                about.insert("finish_roughness", format!("{x} {y}"));
            }
        }
        about.into_iter().map(|(key, value)| (format!("{PREFIX}{key}"), value)).collect()
    }

    /// The bytes of an OpenEXR file of half floats.
    ///
    /// # Errors
    /// What the OpenEXR encoder refuses.
    pub fn exr(&self) -> Result<Vec<u8>> {
        let channel =
            |name, c: usize| (name, FlatSamples::F16(self.texels.iter().map(|t| f16::from_f32(t[c])).collect()));
        let size = (self.width, self.texels.len() / self.width);
        let channels = [channel("R", 0), channel("G", 1), channel("B", 2)];
        texture::encode(size, channels, chromaticities(self.space), self.about())
    }

    /// The bytes of an OpenEXR file of tabulated facets, for the shader functions: their numbers as
    /// [`goniochrome::table::blob`] specifies them, in rows of 256 texels of single precision. `None` for other
    /// finishes.
    ///
    /// # Errors
    /// What the OpenEXR encoder refuses.
    pub fn facets_exr(&self) -> Result<Option<Vec<u8>>> {
        const WIDTH: usize = 256;
        let Some(facets) = self.finish.as_ref().and_then(OwnedFinish::tabulated) else { return Ok(None) };
        let mut numbers = facets.numbers().to_vec();
        numbers.resize(numbers.len().next_multiple_of(WIDTH), 0.0);
        let size = (WIDTH, numbers.len() / WIDTH);
        let mut about = self.about();
        about.insert(format!("{PREFIX}kind"), "facets".into());
        texture::encode(size, [("R", FlatSamples::F32(numbers))], None, about).map(Some)
    }

    /// Linear RGB of what several bounces return, for each row; empty without energy compensation.
    #[must_use]
    pub fn returned(&self) -> Vec<[f32; 3]> {
        let Some(finish) = self.finish.as_ref().map(OwnedFinish::finish) else { return Vec::new() };
        // Columns are in the order of cos θ; angles count from the normal.
        let mut theta_deg: Vec<f64> = angles(self.width).collect();
        theta_deg.reverse();
        let rho: Vec<f32> =
            self.texels.chunks(self.width).flat_map(|row| row.iter().rev().copied().flatten()).collect();
        returned(&finish, &theta_deg, &rho, 3).as_chunks().0.to_vec()
    }

    /// The bytes of an OpenEXR file of a finish's energy compensation, for the shader functions: half floats. Columns
    /// are the nodes of [`Compensation`], rows those of the texture; A is the loss, and R, G and B are what several
    /// bounces return. `None` without compensation.
    ///
    /// # Errors
    /// What the OpenEXR encoder refuses.
    pub fn compensation_exr(&self) -> Result<Option<Vec<u8>>> {
        let losses = self.finish.as_ref().map(OwnedFinish::finish).and_then(|finish| finish.compensation());
        let Some(losses) = losses else { return Ok(None) };
        let rows = self.returned();
        let half = |x: f32| f16::from_f32(x.min(f16::MAX.to_f32()));
        let channel = |name, c: usize| {
            let row = |rgb: &[f32; 3]| vec![half(rgb[c]); Compensation::LEN];
            (name, FlatSamples::F16(rows.iter().flat_map(row).collect()))
        };
        let loss: Vec<f16> =
            (0..Compensation::LEN).map(|node| half(losses.loss(Compensation::cosine(node) as f32))).collect();
        let channels =
            [channel("R", 0), channel("G", 1), channel("B", 2), ("A", FlatSamples::F16(loss.repeat(rows.len())))];
        let mut about = self.about();
        about.insert(format!("{PREFIX}kind"), "compensation".into());
        texture::encode((Compensation::LEN, rows.len()), channels, chromaticities(self.space), about).map(Some)
    }

    /// The function that samples the texture, in a shading language; with a finish, those that evaluate and sample its
    /// facets too; with energy compensation, those that add it.
    #[must_use]
    pub fn shader(&self, language: ShaderLanguage) -> String {
        let [look_up, analytic, tabulated, compensation] = match language {
            ShaderLanguage::Glsl => [
                include_str!("../../data/shaders/lut.glsl"),
                include_str!("../../data/shaders/finish.glsl"),
                include_str!("../../data/shaders/facets.glsl"),
                include_str!("../../data/shaders/compensation.glsl"),
            ],
            ShaderLanguage::Hlsl => [
                include_str!("../../data/shaders/lut.hlsl"),
                include_str!("../../data/shaders/finish.hlsl"),
                include_str!("../../data/shaders/facets.hlsl"),
                include_str!("../../data/shaders/compensation.hlsl"),
            ],
            ShaderLanguage::Wgsl => [
                include_str!("../../data/shaders/lut.wgsl"),
                include_str!("../../data/shaders/finish.wgsl"),
                include_str!("../../data/shaders/facets.wgsl"),
                include_str!("../../data/shaders/compensation.wgsl"),
            ],
        };
        let Some(own) = &self.finish else { return look_up.into() };
        let finish = own.uncompensated();
        let compensation = if own.is_compensated() {
            format!("\n{}", with_facets(compensation, finish.facets().is_some()))
        } else {
            String::new()
        };
        let constant = |kind: [&str; 3], name: &str, value: String| {
            let [glsl, hlsl, wgsl] = kind;
            match language {
                ShaderLanguage::Glsl => format!("const {glsl} GONIOCHROME_{name} = {value};\n"),
                ShaderLanguage::Hlsl => format!("static const {hlsl} GONIOCHROME_{name} = {value};\n"),
                ShaderLanguage::Wgsl => format!("const GONIOCHROME_{name}: {wgsl} = {value};\n"),
            }
        };
        let separable = constant(["bool"; 3], "SEPARABLE", (finish.masking() == Masking::Separable).to_string());
        if let Some([rings, sectors]) = finish.facets().map(|facets| facets.size()) {
            let whole = ["int", "int", "i32"];
            let size = [("RINGS", rings), ("SECTORS", sectors)];
            let size = size.map(|(name, count)| constant(whole, name, count.to_string())).concat();
            return format!(
                "{look_up}\n// Rings and sectors of the facets; separable masking in place of correlated.\n\
                 {size}{separable}\n{tabulated}{compensation}"
            );
        }
        let pair = ["vec2", "float2", "vec2<f32>"];
        let (of_pair, [x, y]) = (pair[language as usize], finish.alpha().unwrap_or_default());
        let beckmann = finish.distribution() == Some(Distribution::Beckmann);
        let roughness = constant(pair, "ROUGHNESS", format!("{of_pair}({x:?}, {y:?})"));
        let beckmann = constant(["bool"; 3], "BECKMANN", beckmann.to_string());
        format!(
            "{look_up}\n// Roughness along x and y; Beckmann's facets in place of GGX; separable masking in place of \
             correlated.\n{roughness}{beckmann}{separable}\n{analytic}{compensation}"
        )
    }

    /// The look-up of the shaders: bilinear, constant beyond the edges.
    #[must_use]
    pub fn sample(&self, cos_theta: f32, parameter: f32) -> [f32; 3] {
        let height = self.texels.len() / self.width;
        let place = |at: f32, count: usize| {
            let at = at.clamp(0.0, 1.0) * (count - 1) as f32;
            let below = (at as usize).min(count.saturating_sub(2));
            (below, (below + 1).min(count - 1), at - below as f32)
        };
        let (x0, x1, u) = place(cos_theta, self.width);
        let (y0, y1, v) = place(parameter, height);
        let at = |x: usize, y: usize, c: usize| self.texels[y * self.width + x][c];
        std::array::from_fn(|c| {
            let along = |y: usize| at(x0, y, c) + u * (at(x1, y, c) - at(x0, y, c));
            along(y0) + v * (along(y1) - along(y0))
        })
    }
}

/// Shader functions whose comments hold the parameter and the argument of tabulated facets: with them, or without.
fn with_facets(text: &str, is_tabulated: bool) -> String {
    let [open, close] = ["/*", "*/"];
    if is_tabulated {
        return text.replace(open, "").replace(close, "");
    }
    text.split(open).map(|part| part.split_once(close).map_or(part, |(_, after)| after)).collect()
}

/// What is known of the colours. The name may come from a file of a stranger.
pub(super) fn facts(scene: &str, illuminant: Illuminant) -> BTreeMap<&'static str, String> {
    let illuminant = match illuminant {
        Illuminant::D65 => "D65",
        Illuminant::E => "E",
    };
    [("scene", text::one_line(scene)), ("illuminant", illuminant.to_owned())].into()
}

/// Primaries and white of a colour space; those of the paper's matrix are unknown.
fn chromaticities(space: RgbSpace) -> Option<Chromaticities> {
    let [red, green, blue, white] = match space {
        RgbSpace::Srgb => [(0.64, 0.33), (0.3, 0.6), (0.15, 0.06), (0.3127, 0.329)],
        RgbSpace::Rec2020 => [(0.708, 0.292), (0.17, 0.797), (0.131, 0.046), (0.3127, 0.329)],
        RgbSpace::AcesCg => [(0.713, 0.293), (0.165, 0.83), (0.128, 0.044), (0.321_68, 0.337_67)],
        RgbSpace::Paper => return None,
    }
    .map(|(x, y)| Vec2(x, y));
    Some(Chromaticities { red, green, blue, white })
}

fn row(scene: &Scene, width: usize) -> Result<Vec<[f32; 3]>> {
    let planar = PlanarScene::new(scene)?;
    let theta_deg: Vec<f64> = angles(width).collect();
    let colours = exact_rgb(&planar, &theta_deg)?;
    Ok(colours.into_iter().map(|rgb| rgb.map(|c| c as f32)).collect())
}

/// Linear sRGB of a planar scene in D65 by the closed form, integrated over the wavelength, unclipped.
pub(super) fn exact_rgb(planar: &PlanarScene<'_>, theta_deg: &[f64]) -> Result<Vec<[f64; 3]>> {
    let request = SpectraRequest {
        model: Model::Physical,
        method: Method::Stack,
        precision: Precision::F64,
        threads: parallel::available(),
    };
    let integral = Integral::new(planar, VISIBLE_NM.map(f64::from), Illuminant::D65, &request)?;
    Ok(integral.colours(theta_deg)?.into_iter().map(|xyz| RgbSpace::Srgb.from_xyz(xyz)).collect())
}

#[cfg(test)]
mod tests {
    use exr::meta::attribute::{AttributeValue, Text};
    use goniochrome::microfacet::Finish;

    use super::*;

    #[test]
    fn texels_come_back_at_their_places() {
        let texels = (0..6).map(|i| [i as f32, 0.5, -1.0]).collect();
        let lut = Lut { width: 3, texels, rows_nm: Some([10.0, 20.0]), ..Lut::default() };
        assert_eq!(lut.sample(0.5, 1.0), [4.0, 0.5, -1.0]);
        assert_eq!(lut.sample(0.25, 0.5), [2.0, 0.5, -1.0]);
        assert_eq!(lut.sample(2.0, -1.0), [2.0, 0.5, -1.0]);
        let over = lut.clone().turned_over();
        assert_eq!(over.sample(0.5, 0.0), lut.sample(0.5, 1.0));
        assert_eq!((over.rows_nm, &over.clone().turned_over()), (Some([20.0, 10.0]), &lut));
    }

    #[test]
    fn a_table_over_a_thickness_has_a_row_for_each_and_a_finish_is_in_its_shader() {
        let table = MirrorTable {
            theta_deg: vec![0.0, 90.0],
            rgb: [0.0, 1.0, 2.0, 3.0, 4.0, 5.0].map(|x| [x, 0.5, -1.0]).to_vec(),
            thickness: Some(ThicknessAxis { layer: 2, nm: vec![100.0, 200.0, 300.0] }),
            ..MirrorTable::default()
        };
        let finish = Finish::new(Distribution::Beckmann, Masking::Correlated, [0.125, 1.0]).unwrap();
        let finish = OwnedFinish::analytic(finish);
        let lut = Lut { finish: Some(finish), ..Lut::of_table(&table, 2).unwrap() };
        // Grazing first.
        assert_eq!(lut.texels.iter().map(|rgb| rgb[0]).collect::<Vec<_>>(), [1.0, 0.0, 3.0, 2.0, 5.0, 4.0]);
        assert_eq!((lut.rows_nm, lut.sample(1.0, 0.25)), (Some([100.0, 300.0]), [1.0, 0.5, -1.0]));
        let about = lut.about();
        let said = |key: &str| about[&format!("{PREFIX}{key}")].clone();
        assert_eq!((said("varied_layer"), said("finish_roughness")), ("2".into(), "0.125 1".into()));
        assert_eq!((said("finish_distribution"), said("finish_masking")), ("beckmann".into(), "correlated".into()));
        for (language, line) in [
            (ShaderLanguage::Glsl, "const vec2 GONIOCHROME_ROUGHNESS = vec2(0.125, 1.0);"),
            (ShaderLanguage::Hlsl, "static const bool GONIOCHROME_BECKMANN = true;"),
            (ShaderLanguage::Wgsl, "const GONIOCHROME_ROUGHNESS: vec2<f32> = vec2<f32>(0.125, 1.0);"),
        ] {
            let shader = lut.shader(language);
            assert!(shader.contains(line) && shader.contains("goniochrome_pdf"), "{shader}");
        }
        // A film that is uneven is resampled.
        let uneven = ThicknessAxis { layer: 2, nm: vec![100.0, 250.0, 300.0] };
        let lut = Lut::of_table(&MirrorTable { thickness: Some(uneven), ..table }, 2).unwrap();
        assert!((lut.texels[3][0] - 4.0 / 3.0).abs() < 1e-6, "{:?}", lut.texels);
    }

    #[test]
    fn the_header_says_what_the_texels_are() {
        let toml = "[stack]\nambient = 1\nlayers = [{ material = 1.33, thickness_nm = 250 }]\nsubstrate = 1\n";
        let scene = crate::scene::parse("film\u{1b}[2J", toml).unwrap();
        let vary = "1=100:300:3".parse().unwrap();
        let lut = Lut::of_scene(&scene, 4, Some(vary)).unwrap().turned_over();
        let bytes = lut.exr().unwrap();
        assert_eq!(bytes, lut.exr().unwrap());
        let header = exr::meta::MetaData::read_from_buffered(bytes.as_slice(), true).unwrap().headers.remove(0);
        let said = |key: &str| {
            let value =
                header.own_attributes.other.get(&Text::from_slice_unchecked(format!("{PREFIX}{key}").as_bytes()));
            let Some(AttributeValue::Text(text)) = value else { panic!("{key} is not said") };
            String::from_utf8(text.bytes().to_vec()).unwrap()
        };
        assert_eq!(lut.shader(ShaderLanguage::Wgsl), include_str!("../../data/shaders/lut.wgsl"));
        for (key, value) in [
            ("kind", "lut"),
            ("scene", "film\\u{1b}[2J"),
            ("colour_space", "srgb"),
            ("illuminant", "D65"),
            ("varied_layer", "1"),
            ("first_row_thickness_nm", "300"),
            ("last_row_thickness_nm", "100"),
            ("first_column_cos_theta", "0"),
            ("last_column_cos_theta", "1"),
        ] {
            assert_eq!(said(key), value);
        }
        assert_eq!(header.shared_attributes.chromaticities.unwrap().red, Vec2(0.64, 0.33));
    }
}
