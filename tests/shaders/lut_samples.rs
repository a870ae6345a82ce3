//! Reads lines of "cos θ, parameter" and prints the texture's colour at each, by the library's own look-up: the truth
//! for the shader functions. Arguments: exr or png (colours in the gamut), the scene, the width and, if any, what is
//! varied.

use std::error::Error;
use std::io::stdin;

use goniochrome_cli::export::lut::Lut;
use goniochrome_cli::plot::in_gamut;
use goniochrome_cli::scene::load;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let (kind, scene, width, vary) = match arguments.as_slice() {
        [kind, scene, width] => (kind, scene, width, None),
        [kind, scene, width, vary] => (kind, scene, width, Some(vary.parse()?)),
        _ => return Err("usage: lut_samples exr|png SCENE WIDTH [LAYER=FROM:TO:STEPS]".into()),
    };
    let mut lut = Lut::of_scene(&load(scene)?, width.parse()?, vary)?;
    if kind == "png" {
        for texel in &mut lut.texels {
            *texel = in_gamut(*texel).map(|c| c as f32);
        }
    }
    for line in stdin().lines() {
        let line = line?;
        let (cos, parameter) = line.split_once(',').ok_or("expected COS,PARAMETER")?;
        let [r, g, b] = lut.sample(cos.trim().parse()?, parameter.trim().parse()?);
        println!("{r},{g},{b}");
    }
    Ok(())
}
