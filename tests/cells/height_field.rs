//! Cells of height fields for random tests: a height field over a small grid, and copies of it further down, with any
//! media between them. Such sheets are closed and never cross, so every cell is a good scene.

use glam::DVec3;
use goniochrome::geometry::mesh_cell::MeshCell;
use goniochrome::geometry::side::Side;
use goniochrome::optics::interface::{Below, Interface};
use goniochrome::optics::medium::MediaLanes;
use goniochrome::simd::lanes::{F64, Lanes};
use goniochrome::trace::coherent_mesh::IncidentWave;
use goniochrome::trace::incoherent_mesh::{Coherency, ExitPath, IncoherentMesh, Path, free_slot};
use goniochrome::trace::paths::{Paths, follow_paths};
use goniochrome::trace::random::Random;
use goniochrome::trace::waves::{Limits, Propagated, Sink, Slot, Target};
use goniochrome_cli::scene::{Mesh, NamedInterface, NamedMedium, OwnedMedium, Scene, Shape, Triangle};
use goniochrome_cli::solve::groups::Groups;
use goniochrome_cli::solve::mesh_scene::MeshScene;

/// A cell of one or more sheets with equal heights; lengths are in nanometres.
#[derive(Clone, Debug)]
pub struct HeightField {
    pub period_nm: [f64; 2],
    /// Number of squares along x and y.
    pub squares: [usize; 2],
    /// Heights of the corners, row by row along x; the far borders repeat the near ones.
    pub heights_nm: Vec<f64>,
    /// Depth of each sheet below the one before it.
    pub depths_nm: Vec<f64>,
    /// n and k of each medium, from the top: one more than there are sheets, or as many over a mirror.
    pub media: Vec<[f64; 2]>,
}

impl HeightField {
    pub fn sheets(&self) -> usize {
        1 + self.depths_nm.len()
    }

    pub fn scene(&self) -> Scene {
        let [nx, ny] = self.squares;
        let mut mesh = Mesh { vertices: Vec::new(), triangles: Vec::new(), path: "random.obj".into() };
        let mut depth = 0.0;
        for sheet in 0..self.sheets() {
            let first = mesh.vertices.len();
            depth += sheet.checked_sub(1).map_or(0.0, |above| self.depths_nm[above]);
            for (j, i) in (0..=ny).flat_map(|j| (0..=nx).map(move |i| (j, i))) {
                let along = |axis: usize, k: usize| self.period_nm[axis] * k as f64 / self.squares[axis] as f64;
                mesh.vertices.push([along(0, i), along(1, j), self.heights_nm[(j % ny) * nx + i % nx] - depth]);
            }
            for (j, i) in (0..ny).flat_map(|j| (0..nx).map(move |i| (j, i))) {
                let corner = |di: usize, dj: usize| (first + (j + dj) * (nx + 1) + i + di) as u32;
                for vertices in [[corner(0, 0), corner(1, 0), corner(1, 1)], [corner(0, 0), corner(1, 1), corner(0, 1)]]
                {
                    mesh.triangles.push(Triangle { vertices, interface: sheet as u16, line: 1 });
                }
            }
        }
        let below = |sheet: usize| match sheet + 1 < self.media.len() {
            true => Below::Medium(sheet as u16 + 1),
            false => Below::Mirror,
        };
        let interface = |sheet: usize| NamedInterface {
            name: format!("sheet {sheet}"),
            interface: Interface { above: sheet as u16, below: below(sheet) },
            coating: Vec::new(),
        };
        let interfaces = (0..self.sheets()).map(interface).collect();
        let medium = |&[n, k]: &[f64; 2]| NamedMedium {
            name: format!("{n}+{k}i"),
            medium: OwnedMedium::constant(n, k).expect("passive"),
        };
        let media: Vec<NamedMedium> = self.media.iter().map(medium).collect();
        let shape = Shape::of_mesh(mesh, self.period_nm, interfaces, &media).expect("a height field is closed");
        Scene {
            name: "random".to_owned(),
            toml: String::new(),
            media,
            shape,
            finish: None,
            periods: None,
            front: None,
            notes: Vec::new(),
            files: Vec::new(),
        }
    }
}

/// The cell of a scene with its vertices moved, and with another period.
pub fn moved(scene: &Scene, period_nm: [f64; 2], to: impl Fn([f64; 3]) -> [f64; 3]) -> Scene {
    let cell = scene.shape.polygons().expect("a cell");
    let mut mesh = cell.mesh().clone();
    mesh.vertices.iter_mut().for_each(|vertex| *vertex = to(*vertex));
    let shape = Shape::of_mesh(mesh, period_nm, cell.interfaces().to_vec(), &scene.media);
    Scene { shape: shape.expect("still closed"), ..scene.clone() }
}

/// The unpolarised powers of one starting ray with coherence `none`.
#[derive(Clone, Debug, Default)]
pub struct Outcome {
    /// Unit directions of the light that leaves through the top, and the power in each.
    pub up: Vec<(DVec3, f64)>,
    pub transmitted: f64,
    pub absorbed: f64,
    pub truncated: f64,
    /// Σ power × length of the paths between facets, in nanometres, those in the ambient medium included.
    pub path_nm: f64,
}

impl Outcome {
    pub fn reflected(&self) -> f64 {
        self.up.iter().map(|(_, power)| power).sum()
    }

    pub fn total(&self) -> f64 {
        self.reflected() + self.transmitted + self.absorbed + self.truncated
    }
}

impl Sink<ExitPath<F64>, Coherency<F64>> for Outcome {
    fn exit(&mut self, exit: ExitPath<F64>, light: Coherency<F64>) {
        let power = Lanes::lane(light.power(), 0);
        match exit.side {
            Side::Above => self.up.push((exit.direction.lane(0).normalize(), power)),
            Side::Below => self.transmitted += power,
        }
    }
}

/// Paths whose lengths are measured.
struct Measured<'a> {
    paths: IncoherentMesh<'a, F64>,
    path_nm: f64,
}

impl<'a> Paths<F64> for Measured<'a> {
    type State = Path<F64>;
    type Branch = <IncoherentMesh<'a, F64> as Paths<F64>>::Branch;
    type Light = Coherency<F64>;
    type Exit = ExitPath<F64>;

    fn power(light: &Self::Light) -> F64 {
        light.power()
    }

    fn scale_power(light: &Self::Light, by: f64) -> Self::Light {
        IncoherentMesh::<F64>::scale_power(light, by)
    }

    fn split(&mut self, state: &Self::State, light: &Self::Light) -> [Option<(Self::Branch, Self::Light)>; 2] {
        self.paths.split(state, light)
    }

    fn propagate(
        &mut self,
        from: &Self::State,
        branch: &Self::Branch,
        light: &Self::Light,
    ) -> Propagated<Self::State, Self::Exit, Self::Light> {
        let sent = self.paths.propagate(from, branch, light);
        if let Some((Target::State(to), _)) = &sent {
            self.path_nm += Lanes::lane(light.power(), 0) * to.at().point_nm.distance(from.at().point_nm);
        }
        sent
    }
}

/// A starting ray.
#[derive(Clone, Copy, Debug)]
pub struct Start {
    /// Unit vector towards the light.
    pub wi: DVec3,
    /// Place along x, in periods.
    pub u: f64,
    /// Place along y, in periods.
    pub v: f64,
    /// Seed of the draws among weak branches.
    pub seed: u32,
}

/// Calls `work` with a scene's cell, and its media at one wavelength.
pub fn with_cell<T>(scene: &Scene, wavelength_nm: f64, work: impl FnOnce(MeshCell<'_>, MediaLanes<'_, F64>) -> T) -> T {
    let mesh_scene = MeshScene::new(scene).expect("a good mesh");
    let mut buffer = mesh_scene.buffer();
    let cell = mesh_scene.cell(&mut buffer).expect("a good mesh");
    let wavelengths = [wavelength_nm];
    let mut groups = Groups::<F64>::new(scene, &wavelengths);
    let groups = groups.evaluate(scene, cell.above(), &wavelengths).expect("constant media");
    work(cell, groups[0].0)
}

/// Follows the paths of each starting ray without interference, in a workspace of so many states.
pub fn follow(scene: &Scene, wavelength_nm: f64, states: usize, starts: &[Start]) -> Vec<Outcome> {
    /// Limits: paths of less power are no longer split, and light that a layer traps is truncated in the end.
    const LIMITS: Limits = Limits { in_flight: 0.02, generations: 200 };
    let mut slots: Vec<Slot<Path<F64>, Coherency<F64>>> = vec![free_slot(); states];
    let mut one = |cell: MeshCell<'_>, media: MediaLanes<'_, F64>, start: &Start| {
        let eta = media.eta()[usize::from(cell.above())];
        let paths = IncoherentMesh::new(cell, media, IncidentWave::new(start.wi, eta));
        let mut outcome = Outcome::default();
        let (path, light) = paths.start(start.u, start.v).expect("no hole");
        let mut random = Random::new(start.seed, 0);
        let mut measured = Measured { paths, path_nm: 0.0 };
        let done = follow_paths(&mut measured, path, light, &mut slots, LIMITS, &mut random, &mut outcome);
        let Measured { paths, path_nm } = measured;
        outcome.truncated += done.truncated.lane(0) + paths.lost().lane(0);
        outcome.absorbed += paths.absorbed().lane(0);
        outcome.path_nm = path_nm;
        outcome
    };
    with_cell(scene, wavelength_nm, |cell, media| starts.iter().map(|start| one(cell, media, start)).collect())
}
