//! Prints what `tests/agree.c` prints, computed through the Rust interface. First it writes the table blobs that the C
//! program reads, into the folder named on the command line.

use std::path::Path;

use glam::{DVec3, Vec3};
use goniochrome::colour::{Illuminant, Quadrature, RgbSpace, xyz, xyz_weights};
use goniochrome::geometry::bvh::{Bvh, Node};
use goniochrome::geometry::facet::Facet;
use goniochrome::geometry::mesh_cell::MeshCell;
use goniochrome::geometry::side::Side;
use goniochrome::measure::bins::{DirectionBins, ExitBuffer, ExitRecord, Histogram};
use goniochrome::microfacet::{Compensation, Distribution, FacetTable, Finish, Masking};
use goniochrome::optics::incidence::Incidence;
use goniochrome::optics::interface::{Below, Interface, Model};
use goniochrome::optics::medium::{Dispersion, Extrapolate, MediaLanes, Medium};
use goniochrome::optics::stack::{Film, PreparedStack, PreparedStackArrays, Stack, StackArrays};
use goniochrome::simd::complex::ComplexLanes;
use goniochrome::simd::lanes::{F32, F64, Lanes, simd_level};
use goniochrome::table::blob::{Blob, Contents, Precision};
use goniochrome::table::{
    DiffractedLight, FacetLobe, FilmArrays, FilmTable, HalfVectorWarp, MirrorTable, OrderArrays, OrderLayout,
    OrderTable, Periodicity, ScatterLayout, ScatterSampler, ScatterTable,
};
use goniochrome::trace::coherent_mesh::{CoherentMesh, IncidentWave, free_slot};
use goniochrome::trace::incoherent_mesh::{self, IncoherentMesh};
use goniochrome::trace::paths::{IncoherentFallback, follow_paths, trace_with_fallback};
use goniochrome::trace::random::Random;
use goniochrome::trace::sobol::sobol;
use goniochrome::trace::waves::Limits;
use num_complex::Complex64;

/// Prints a number as `%a` of C does.
fn print(what: &str, x: f64) {
    let bits = x.to_bits();
    let sign = if x.is_sign_negative() { "-" } else { "" };
    if x == 0.0 {
        println!("{what} {sign}0x0p+0");
        return;
    }
    let exponent = (bits >> 52 & 0x7ff) as i64 - 1023;
    let digits = format!("{:013x}", bits & ((1 << 52) - 1));
    let digits = digits.trim_end_matches('0');
    let point = if digits.is_empty() { "" } else { "." };
    println!("{what} {sign}0x1{point}{digits}p{exponent:+}");
}

fn films() {
    let table = |value| Dispersion::Table { wavelength_nm: &[350.0, 560.0, 800.0], value };
    let media = [
        Medium::VACUUM,
        Medium::new(table(&[2.6, 2.45, 2.3]), table(&[0.02, 0.0, 0.0]), Extrapolate::Refuse).unwrap(),
        Medium::constant(Complex64::new(0.9, 6.0)).unwrap(),
    ];
    let film = |thickness_nm, medium| Film { thickness_nm, medium };
    let layers = [film(180.0, 1), film(90.0, 0), film(410.0, 1)];
    let mut arrays = StackArrays::<4>::new();
    let stack = Stack::new(0, layers, Below::Medium(2), arrays.memory()).unwrap();
    let reflectance = |cos_theta: f64, nm: &[f64]| {
        let incidence = Incidence::from_cosine(cos_theta);
        let mut found = Vec::new();
        for nm in nm.chunks(F64::WIDTH) {
            let mut eta = [ComplexLanes::zero(); 3];
            let lanes = MediaLanes::<F64>::evaluate(&media, nm, &mut eta).unwrap();
            let mut memory = PreparedStackArrays::<F64, 4>::new();
            let prepared = PreparedStack::new(stack, &lanes, incidence, Model::Physical, memory.memory());
            let r = prepared.reflectance(prepared.reflection());
            found.extend((0..nm.len()).map(|lane| [Lanes::lane(r.s, lane), Lanes::lane(r.p, lane)]));
        }
        found
    };
    let nm: Vec<f64> = (0..23).map(|i| 390.0 + 17.0 * f64::from(i)).collect();
    let visible: Vec<f64> = (0..81).map(|i| 380.0 + 5.0 * f64::from(i)).collect();
    let mut weights = [[0.0; 3]; 81];
    xyz_weights(&visible, Illuminant::D65, Quadrature::Interpolated, &mut weights).unwrap();
    for cos_theta in [1.0, 0.8, 0.31, 1e-3, 0.0] {
        for [s, p] in reflectance(cos_theta, &nm) {
            print("R_s", f64::from(s as f32));
            print("R_p", f64::from(p as f32));
        }
        let mean = reflectance(cos_theta, &visible).into_iter().map(|[s, p]| 0.5 * (s + p));
        for c in RgbSpace::Rec2020.from_xyz(xyz(&weights, mean)) {
            print("rgb", f64::from(c as f32));
        }
    }
}

const NM: [f64; 3] = [450.0, 550.0, 650.0];
const GRID: DirectionBins = DirectionBins { cos: 4, phi: 8 };
const RAYS: u32 = 256;
const SEED: u32 = 7;

#[derive(Default)]
struct Tally {
    reflected: [f64; 3],
    transmitted: [f64; 3],
    bins: [[f64; 32]; 3],
}

impl Histogram for Tally {
    fn add(&mut self, lane: usize, side: Side, bin: usize, power: f64) {
        if lane >= NM.len() {
            return;
        }
        if side == Side::Above {
            self.reflected[lane] += power;
            self.bins[lane][bin] += power;
        } else {
            self.transmitted[lane] += power;
        }
    }
}

fn ridge(interference: bool) {
    let vertices = [[0, 0, 0], [500, 0, 300], [1000, 0, 0], [0, 800, 0], [500, 800, 300], [1000, 800, 0]]
        .map(|v| DVec3::from_array(v.map(f64::from)));
    let triangles = [[0, 1, 4], [0, 4, 3], [1, 2, 5], [1, 5, 4]];
    let mut nodes = [Node::EMPTY; 4];
    let (mut order, mut corners) = ([0; 4], [0.0; Bvh::required_corners(4)]);
    let bvh = Bvh::build(&vertices, &triangles, &mut nodes, &mut order, &mut corners).unwrap();
    let slope = |[a, b, c]: [usize; 3]| Facet {
        normal: (vertices[b] - vertices[a]).cross(vertices[c] - vertices[a]).normalize(),
        anchor_nm: vertices[a],
        interface: 0,
    };
    let facets = [slope([0, 1, 4]), slope([1, 2, 5])];
    let interfaces = [Interface { above: 0, below: Below::Medium(1) }];
    let cell = MeshCell::new(bvh, &[0, 0, 1, 1], &facets, &interfaces, [1000.0, 800.0], 0).unwrap();
    let media = [Medium::VACUUM, Medium::constant(1.5.into()).unwrap()];
    let mut eta = [ComplexLanes::zero(); 2];
    let lanes = MediaLanes::<F32>::evaluate(&media, &NM, &mut eta).unwrap();
    let wi = DVec3::new(0.6, 0.0, 0.8).normalize_or_zero();
    let incident = IncidentWave::new(wi, lanes.eta()[0]);
    let (mut coherent, mut incoherent) =
        (CoherentMesh::new(cell, lanes, incident), IncoherentMesh::new(cell, lanes, incident));
    let mut memory = vec![ExitRecord::<F32>::none(); 128];
    let mut exits = ExitBuffer::new(&mut memory, GRID, &lanes);
    let (mut waves, mut waiting) = (vec![free_slot::<F32>(); 26], vec![incoherent_mesh::free_slot::<F32>(); 10]);
    let paths = Limits { in_flight: 0.01, generations: 10_000 };
    let mut tally = Tally::default();
    let mut truncated = F32::zero();
    for ray in 0..RAYS {
        let [u, v] = sobol(ray, SEED);
        let (path, light) = incoherent.start(u, v).expect("the ridge has no holes");
        exits.begin();
        let mut random = Random::new(ray, SEED);
        let trace = if interference {
            let (state, field) = coherent.start_at(path.at());
            let fallback = IncoherentFallback::new(&mut incoherent, &mut waiting, paths, &mut random);
            let limits = Limits { in_flight: 1e-13, generations: 10_000 };
            trace_with_fallback(&mut coherent, state, field, &mut waves, limits, fallback, &mut exits)
        } else {
            follow_paths(&mut incoherent, path, light, &mut waiting, paths, &mut random, &mut exits)
        };
        truncated += trace.truncated + exits.flush(&mut tally);
    }
    truncated += coherent.lost() + incoherent.lost();
    let absorbed = coherent.absorbed();
    let absorbed = (absorbed.s + absorbed.p) * F32::splat(0.5) + incoherent.absorbed();
    let per_ray = 1.0 / f64::from(RAYS);
    for lane in 0..NM.len() {
        print("reflected", tally.reflected[lane] * per_ray);
        print("transmitted", tally.transmitted[lane] * per_ray);
        print("absorbed", absorbed.lane(lane) * per_ray);
        print("truncated", truncated.lane(lane) * per_ray);
    }
    tally.bins.as_flattened().iter().for_each(|bin| print("bin", bin * per_ray));
}

fn written(contents: Contents<'_>, precision: Precision, path: &Path) -> Vec<u8> {
    let blob = Blob { space: Some(RgbSpace::Rec2020), contents };
    let mut bytes = vec![0; blob.required_len(precision).unwrap()];
    blob.write(precision, &mut bytes).unwrap();
    std::fs::write(path, &bytes).unwrap();
    bytes
}

fn print_light(light: Option<DiffractedLight>) {
    let light = light.unwrap_or(DiffractedLight { direction: Vec3::ZERO, efficiency: 0.0 });
    light.direction.to_array().into_iter().for_each(|x| print("direction", f64::from(x)));
    print("efficiency", f64::from(light.efficiency));
}

fn orders(table: &OrderTable<'_>) {
    for order in 0..table.order_count() {
        table.order(order).into_iter().for_each(|number| print("order", f64::from(number)));
    }
    for wavelength in 0..table.wavelength_count() {
        print("nm", f64::from(table.wavelength_nm(wavelength)));
        table.rgb_weight(wavelength).into_iter().for_each(|c| print("rgb", f64::from(c)));
    }
    for i in 0..64u8 {
        let wo = Vec3::new(f32::from(i % 8) - 3.5, f32::from(i / 8) - 3.5, 2.0);
        let view = table.view(wo.normalize()).unwrap();
        for wavelength in 0..table.wavelength_count() {
            for order in 0..table.order_count() {
                print_light(view.light_between(wavelength, 0.25 * f32::from(i % 5), order));
                print("probability", f64::from(view.probability(wavelength, order)));
            }
            let drawn = view.sample(wavelength, f32::from(i) / 64.0);
            print("drawn", drawn.map_or(0.0, |drawn| drawn.order as f64));
            print_light(drawn.map(|d| DiffractedLight { direction: d.direction, efficiency: d.efficiency }));
            print("probability", drawn.map_or(0.0, |drawn| f64::from(drawn.probability)));
        }
    }
}

fn film(table: &FilmTable<'_>) {
    print("thicknesses", table.thicknesses() as f64);
    table.range_nm().into_iter().for_each(|nm| print("nm", f64::from(nm)));
    print("transparent", f64::from(u8::from(table.is_transparent())));
    let number = |finish: Finish<'_>| match (finish.distribution(), finish.masking()) {
        (Some(Distribution::Beckmann), Masking::Correlated) => 3.0,
        (None, Masking::Separable) => 6.0,
        other => panic!("{other:?} is the finish of no table here"),
    };
    print("finish", table.finish().map_or(0.0, number));
    table
        .finish()
        .and_then(|finish| finish.alpha())
        .unwrap_or_default()
        .into_iter()
        .for_each(|alpha| print("alpha", alpha.into()));
    for i in 0..64u8 {
        let (x, y, nm) = (f32::from(i % 8) - 3.5, f32::from(i / 8) - 3.5, 10.0 * f32::from(i));
        let (wi, wo) = (Vec3::new(x, y, 2.0).normalize(), Vec3::new(-y, 0.5 * x, 1.0).normalize());
        let (cos, u) = (f32::from(i) / 64.0, [f32::from(i) / 64.0, f32::from(i % 8) / 8.0]);
        table.reflectance(cos, nm).into_iter().for_each(|c| print("reflectance", f64::from(c)));
        table.transmittance(cos, nm).into_iter().for_each(|c| print("transmittance", f64::from(c)));
        table.eval(wi, wo, nm).into_iter().for_each(|c| print("rgb", f64::from(c)));
        let drawn = table.sample(wi, u, nm);
        let wo = drawn.map_or(Vec3::new(-wi.x, -wi.y, wi.z), |drawn| drawn.wo);
        wo.to_array().into_iter().for_each(|x| print("wo", f64::from(x)));
        print("pdf", drawn.map_or(0.0, |drawn| f64::from(drawn.pdf.unwrap_or(1.0))));
        drawn.map_or([0.0; 3], |drawn| drawn.weight).into_iter().for_each(|c| print("weight", f64::from(c)));
    }
}

fn table(bytes: &[u8]) {
    let Blob { contents, .. } = Blob::read(bytes).unwrap();
    let kind = match contents {
        Contents::Mirror(_) => 1.0,
        Contents::Scatter(..) => 2.0,
        Contents::Orders(_) => 3.0,
        Contents::Film(_) => 4.0,
    };
    print("kind", kind);
    print("channels", 3.0);
    print("space", 2.0);
    match contents {
        Contents::Orders(table) => return orders(&table),
        Contents::Film(table) => film(&table),
        Contents::Mirror(table) => film(&table.into()),
        Contents::Scatter(..) => {}
    }
    for i in 0..64u8 {
        let (x, y) = (f32::from(i % 8) / 8.0 - 0.4375, f32::from(i / 8) / 8.0 - 0.4375);
        let (wi, wo) = (Vec3::new(x, y, 1.0 - 0.5 * (x * x + y * y)), Vec3::new(-y, 0.5 * x, 0.75));
        let u = [0.5 + x, 0.5 + y];
        let (rgb, drawn, weight) = match contents {
            Contents::Mirror(table) => {
                let out = (Vec3::new(-wi.x, -wi.y, wi.z), 1.0);
                (table.rgb(libm::acosf(u[0])), out, table.rgb(libm::acosf(wi.z)))
            }
            Contents::Film(table) => {
                let (wi, wo, first) = (wi.normalize(), wo.normalize(), table.range_nm()[0]);
                print("pdf", f64::from(table.pdf(wi, wo)));
                let drawn = table.sample(wi, u, first);
                let out = drawn.map_or((Vec3::new(-wi.x, -wi.y, wi.z), 0.0), |d| (d.wo, d.pdf.unwrap_or(1.0)));
                (table.eval(wi, wo, first), out, drawn.map_or([0.0; 3], |drawn| drawn.weight))
            }
            Contents::Scatter(table, sampler) => {
                print("pdf", f64::from(sampler.pdf(wi, wo)));
                let mut albedo = [0.0; 3];
                table.albedo(wi, &mut albedo);
                albedo.into_iter().for_each(|c| print("albedo", f64::from(c)));
                for lobe in 0..table.layout().lobes() {
                    let mut rgb = [0.0; 3];
                    let direction = table.reflected(wi, lobe, &mut rgb).unwrap_or(Vec3::ZERO);
                    direction.to_array().into_iter().for_each(|x| print("direction", f64::from(x)));
                    rgb.into_iter().for_each(|c| print("reflectance", f64::from(c)));
                }
                let (drawn, pdf) = sampler.sample(wi, u).unwrap_or((Vec3::new(-wi.x, -wi.y, wi.z), 0.0));
                let weight = |f: f32| if pdf > 0.0 { f * drawn.z / pdf } else { 0.0 };
                (table.rgb(wi, wo), (drawn, pdf), table.rgb(wi, drawn).map(weight))
            }
            Contents::Orders(_) => unreachable!("printed above"),
        };
        print("pdf", f64::from(drawn.1));
        for c in 0..3 {
            print("rgb", f64::from(rgb[c]));
            print("wo", f64::from(drawn.0[c]));
            print("weight", f64::from(weight[c]));
        }
    }
}

fn main() {
    let folder = std::env::args().nth(1).expect("a folder for the table blobs");
    let folder = Path::new(&folder);
    println!("version {}\nsimd {}", env!("CARGO_PKG_VERSION"), simd_level());
    films();
    ridge(false);
    ridge(true);
    let layout = ScatterLayout::new([4, 2], [4, 8], 2).unwrap();
    let values: Vec<f32> = (0..3 * layout.count()).map(|i| (0.2 * i as f32).sin().max(-0.1) + 0.3).collect();
    let mut memory = [0.0; HalfVectorWarp::required_len([4, 3])];
    let warp = HalfVectorWarp::new([&[1.0, 2.0, 0.5, 0.25], &[1.0, 0.5, 1.0]], &mut memory).unwrap();
    let (tilted, level) = (FacetLobe::reflection(Vec3::new(0.28, 0.0, 0.96)), FacetLobe::reflection(Vec3::Z));
    let lobes = [tilted, FacetLobe { index: 1.5, ..level }].map(|lobe| lobe.to_numbers());
    let scatter = ScatterTable::new(&values, layout, warp, &lobes, 3).unwrap();
    let mut memory = vec![0.0; ScatterSampler::required_len(&layout)];
    let sampler = ScatterSampler::new(&scatter, &mut memory).unwrap();
    let ramp: Vec<f32> = (0..30).map(|i| 1.0 / (1.0 + i as f32)).collect();
    let mirror = MirrorTable::new(&ramp, 3, 1.5).unwrap();
    table(&written(Contents::Mirror(mirror), Precision::Single, &folder.join("mirror.gonio")));
    table(&written(Contents::Scatter(scatter, sampler), Precision::Single, &folder.join("scatter.gonio")));
    table(&written(Contents::Scatter(scatter, sampler), Precision::Half, &folder.join("half.gonio")));
    let through = ramp.iter().map(|rho| 1.0 - rho).collect::<Vec<_>>();
    let arrays =
        FilmArrays { reflectance: &ramp, transmittance: &through, thickness_nm: &[50.0, 100.0, 200.0, 400.0, 450.0] };
    let finish = Finish::new(Distribution::Beckmann, Masking::Correlated, [0.1, 0.4]).unwrap();
    let film = FilmTable::new(&arrays, 3, 1.5, Some(finish)).unwrap();
    table(&written(Contents::Film(film), Precision::Single, &folder.join("film.gonio")));
    // Facets that depend on the azimuth, a bump along x, with energy compensation.
    let density: Vec<f32> = (0..9 * 4).map(|i| if i % 2 == 0 { 1.0 } else { 0.25 } / (1.0 + (i / 4) as f32)).collect();
    let mut memory = vec![0.0; FacetTable::required_len([8, 4])];
    let facets = FacetTable::new([8, 4], &density, &mut memory).unwrap();
    let losses: [f32; Compensation::LEN] = std::array::from_fn(|node| 0.5 - node as f32 / 512.0);
    let compensation = Compensation::of(&losses).unwrap();
    let finish = Finish::tabulated(facets, Masking::Separable).with_compensation(compensation);
    let film = FilmTable::new(&arrays, 3, 1.5, Some(finish)).unwrap().with_returned(&ramp[..15]).unwrap();
    table(&written(Contents::Film(film), Precision::Single, &folder.join("facets.gonio")));
    let layout = OrderLayout::new([5, 3], Periodicity::X, [1600.0, 1.0]).unwrap();
    let strength: Vec<f32> = (0..3 * layout.count() * 7).map(|i| (i * 31 % 97) as f32 / 970.0).collect();
    let arrays = OrderArrays {
        orders: &[-3.0, -2.0, -1.0, 0.0, 1.0, 2.0, 3.0].map(|m| [m, 0.0]),
        wavelength_nm: &[450.0, 550.0, 650.0],
        index: &[1.0, 1.25, 1.5],
        rgb_weights: &[[0.0, 0.25, 0.75], [0.25, 0.625, 0.25], [0.75, 0.125, 0.0]],
        strength: &strength,
    };
    let orders = OrderTable::new(layout, &arrays).unwrap();
    table(&written(Contents::Orders(orders), Precision::Single, &folder.join("orders.gonio")));
    table(&written(Contents::Orders(orders), Precision::Half, &folder.join("orders-half.gonio")));
}
