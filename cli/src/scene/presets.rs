//! Presets: the scenes that come with the program.

/// Name and scene file of each preset; the first line of a file is its description.
const PRESETS: &[(&str, &str)] = &[
    ("paper-fig3", include_str!("../../data/presets/paper-fig3.toml")),
    ("paper-fig4", include_str!("../../data/presets/paper-fig4.toml")),
    ("paper-fig6-300", include_str!("../../data/presets/paper-fig6-300.toml")),
    ("paper-fig6-3000", include_str!("../../data/presets/paper-fig6-3000.toml")),
    ("soap-bubble", include_str!("../../data/presets/soap-bubble.toml")),
    ("oil-on-water", include_str!("../../data/presets/oil-on-water.toml")),
    ("jewel-beetle", include_str!("../../data/presets/jewel-beetle.toml")),
    ("morpho-stack", include_str!("../../data/presets/morpho-stack.toml")),
    ("quarter-wave-mirror", include_str!("../../data/presets/quarter-wave-mirror.toml")),
    ("anodised-titanium", include_str!("../../data/presets/anodised-titanium.toml")),
    ("opaline-guanine", include_str!("../../data/presets/opaline-guanine.toml")),
    ("bumpy-glass", include_str!("../../data/presets/bumpy-glass.toml")),
    ("bumpy-soap-film", include_str!("../../data/presets/bumpy-soap-film.toml")),
    ("beetle-pits", include_str!("../../data/presets/beetle-pits.toml")),
    ("morpho-ridges", include_str!("../../data/presets/morpho-ridges.toml")),
    ("compact-disc", include_str!("../../data/presets/compact-disc.toml")),
    ("dvd", include_str!("../../data/presets/dvd.toml")),
    ("blu-ray", include_str!("../../data/presets/blu-ray.toml")),
    ("holographic-foil", include_str!("../../data/presets/holographic-foil.toml")),
    ("moth-eye", include_str!("../../data/presets/moth-eye.toml")),
    ("silicon-lines", include_str!("../../data/presets/silicon-lines.toml")),
    ("silicon-pyramids", include_str!("../../data/presets/silicon-pyramids.toml")),
    ("brushed-metal", include_str!("../../data/presets/brushed-metal.toml")),
    ("pigment-paint", include_str!("../../data/presets/pigment-paint.toml")),
];

/// Names of the presets.
pub fn names() -> impl Iterator<Item = &'static str> {
    PRESETS.iter().map(|&(name, _)| name)
}

/// Scene file of a preset by its name, in upper or lower case.
#[must_use]
pub fn get(name: &str) -> Option<&'static str> {
    find(name).map(|(_, toml)| toml)
}

/// Name as listed, and scene file, of a preset.
pub(super) fn find(name: &str) -> Option<(&'static str, &'static str)> {
    PRESETS.iter().find(|(known, _)| known.eq_ignore_ascii_case(name)).copied()
}

/// Name and one-line description of every preset.
pub fn list() -> impl Iterator<Item = (&'static str, &'static str)> {
    PRESETS.iter().map(|&(name, toml)| (name, description(toml)))
}

fn description(toml: &str) -> &str {
    let line = toml.lines().next().unwrap_or_default();
    line.strip_prefix("description = \"").and_then(|text| text.strip_suffix('"')).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use goniochrome::optics::interface::Below;

    use super::*;
    use crate::scene::{Scene, Shape, load};

    /// (n, k, thickness) from the ambient down; a mirror has no entry.
    fn stack(scene: &Scene) -> (Vec<(f64, f64)>, Vec<f64>) {
        let Shape::Stack { ambient, layers, substrate } = &scene.shape else { panic!("{} is a stack", scene.name) };
        let eta = |index: u16| {
            let eta = scene.media[usize::from(index)].medium.borrow().eta(550.0).unwrap();
            (eta.re, eta.im)
        };
        let mut etas = vec![eta(*ambient)];
        etas.extend(layers.iter().map(|layer| eta(layer.medium)));
        etas.extend(match substrate {
            Below::Medium(index) => Some(eta(*index)),
            Below::Mirror => None,
        });
        (etas, layers.iter().map(|layer| layer.thickness_nm).collect())
    }

    fn alternating(pairs: usize, a: (f64, f64), b: (f64, f64), ends: [(f64, f64); 2]) -> Vec<(f64, f64)> {
        let mut etas = vec![ends[0]];
        (0..pairs).for_each(|_| etas.extend([a, b]));
        etas.push(ends[1]);
        etas
    }

    #[test]
    fn every_preset_loads_over_the_visible_and_says_where_it_comes_from() {
        for (name, description) in list() {
            let scene = load(name).unwrap();
            assert_eq!(scene.name, name);
            assert!(scene.files.is_empty() && description.len() > 20, "{name}: {description}");
            assert!(get(name).unwrap().lines().nth(1).unwrap().starts_with("source = \""), "{name}");
            for medium in &scene.media {
                let [from, to] = medium.medium.borrow().range_nm();
                assert!(from <= 380.0 && to >= 780.0, "{name}: {}", medium.name);
            }
        }
        assert_eq!(load("Soap-Bubble").unwrap().name, "soap-bubble");
    }

    #[test]
    fn the_papers_presets_are_the_papers() {
        let of = |name| stack(&load(name).unwrap());
        assert_eq!(of("paper-fig3"), (vec![(1.0, 0.0), (2.4, 0.0)], vec![300.0]));
        let Shape::Stack { substrate, .. } = load("paper-fig3").unwrap().shape else { panic!("a stack") };
        assert_eq!(substrate, Below::Mirror);
        let films = [1.0, 2.4, 1.0, 2.4, 1.0, 2.4, 1.0].map(|n| (n, 0.0)).to_vec();
        assert_eq!(of("paper-fig4"), (films, vec![180.0; 5]));
        assert_eq!(of("paper-fig6-300"), (vec![(1.0, 0.0), (2.4, 0.0), (1.5, 0.0)], vec![300.0]));
        assert_eq!(of("paper-fig6-3000"), (vec![(1.0, 0.0), (2.4, 0.0), (1.5, 0.0)], vec![3000.0]));
    }

    /// The stacks for which independent reference values exist.
    #[test]
    fn reference_presets_are_the_reference_stacks() {
        let of = |name| stack(&load(name).unwrap());
        let mirror = alternating(10, (2.35, 0.0), (1.38, 0.0), [(1.0, 0.0), (1.52, 0.0)]);
        assert_eq!(of("quarter-wave-mirror"), (mirror, [58.5, 99.6].repeat(10)));
        assert_eq!(of("soap-bubble"), (vec![(1.0, 0.0), (1.33, 0.0), (1.0, 0.0)], vec![420.0]));
    }
}
