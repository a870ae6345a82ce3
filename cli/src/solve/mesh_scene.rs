//! The polygons of a scene as a cell, in the form that the general tracer takes.

use std::collections::HashMap;

use glam::DVec3;
use goniochrome::geometry::bvh::{Bvh, Node};
use goniochrome::geometry::facet::Facet;
use goniochrome::geometry::mesh_cell::MeshCell;
use goniochrome::optics::interface::{Below, Interface};
use goniochrome::optics::medium::{Medium, MediumIndex};
use goniochrome::optics::stack::Film;

use crate::scene::{Mesh, NamedInterface, Scene};
use crate::solve::groups::media_of;
use crate::support::error::{Error, Result};

/// A scene of polygons, grouped into facets, and the media between them.
#[derive(Debug, Clone)]
pub struct MeshScene<'s> {
    scene: &'s Scene,
    vertices: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
    facet_of: Vec<u32>,
    facets: Vec<Facet>,
    interfaces: Vec<Interface>,
    /// The films of each interface.
    coatings: Vec<Vec<Film>>,
    period_nm: [f64; 2],
    above: MediumIndex,
}

/// Memory that a [`MeshCell`] borrows: its tree, triangles and coatings.
#[derive(Debug)]
pub struct CellBuffer<'b> {
    nodes: Vec<Node>,
    order: Vec<u32>,
    corners: Vec<f64>,
    coatings: Vec<&'b [Film]>,
}

impl<'s> MeshScene<'s> {
    /// Groups a mesh's triangles into facets.
    ///
    /// # Errors
    /// A stack of layers; a mesh without area; a mesh whose top is the back of a mirror.
    pub fn new(scene: &'s Scene) -> Result<Self> {
        let Some(cell) = scene.shape.polygons() else {
            return Err(Error::failed(format_args!(
                "{}: is a [stack] of plane layers, which sends light into one direction; use spectrum, colour or estimate, \
                 or describe a [cell]",
                scene.name
            )));
        };
        let (mesh, interfaces, period_nm) = (cell.mesh(), cell.interfaces(), cell.period_nm());
        let vertices: Vec<DVec3> = mesh.vertices.iter().copied().map(DVec3::from).collect();
        let solid: Vec<_> =
            mesh.triangles.iter().filter(|t| area_vector(&vertices, t.vertices).length() > 0.0).collect();
        if solid.is_empty() {
            return Err(Error::failed(format_args!("{}: no triangle has an area", mesh.path.display())));
        }
        let triangles: Vec<[u32; 3]> = solid.iter().map(|t| t.vertices).collect();
        let kinds: Vec<u16> = solid.iter().map(|t| t.interface).collect();
        let (facet_of, facets) = group_into_facets(&vertices, &triangles, &kinds);
        let above = topmost(mesh, &vertices, interfaces)?;
        let coating = |named: &NamedInterface| {
            named.coating.iter().map(|layer| Film { medium: layer.medium, thickness_nm: layer.thickness_nm }).collect()
        };
        let coatings = interfaces.iter().map(coating).collect();
        let interfaces = interfaces.iter().map(|named| named.interface).collect();
        Ok(Self { scene, vertices, triangles, facet_of, facets, interfaces, coatings, period_nm, above })
    }

    /// Memory for [`MeshScene::cell`].
    #[must_use]
    pub fn buffer(&self) -> CellBuffer<'_> {
        let count = self.triangles.len();
        CellBuffer {
            nodes: vec![Node::default(); Bvh::required_nodes(count)],
            order: vec![0; count],
            corners: vec![0.0; Bvh::required_corners(count)],
            coatings: self.coatings.iter().map(Vec::as_slice).collect(),
        }
    }

    /// The cell, checked by the core.
    ///
    /// # Errors
    /// A mesh that the core refuses, such as one with a triangle outside of the period.
    pub fn cell<'b>(&'b self, buffer: &'b mut CellBuffer<'b>) -> Result<MeshCell<'b>> {
        let CellBuffer { nodes, order, corners, coatings } = buffer;
        let named = |error: &dyn std::fmt::Display| Error::failed(format_args!("{}: {error}", self.scene.name));
        let bvh = Bvh::build(&self.vertices, &self.triangles, nodes, order, corners).map_err(|error| named(&error))?;
        MeshCell::new(bvh, &self.facet_of, &self.facets, &self.interfaces, self.period_nm, self.above)
            .and_then(|cell| cell.with_coatings(coatings))
            .map_err(|error| named(&error))
    }

    /// The media, in the scene's order.
    #[must_use]
    pub fn media(&self) -> Vec<Medium<'s>> {
        media_of(self.scene)
    }

    /// Every triangle that has an area: its corners, the interface that it belongs to, and whether a coating lies on
    /// it.
    pub fn triangles(&self) -> impl Iterator<Item = ([DVec3; 3], Interface, bool)> + '_ {
        self.triangles.iter().zip(&self.facet_of).map(|(triangle, &facet)| {
            let kind = usize::from(self.facets[facet as usize].interface);
            (triangle.map(|v| self.vertices[v as usize]), self.interfaces[kind], !self.coatings[kind].is_empty())
        })
    }

    /// The height of the mesh.
    #[must_use]
    pub fn height_nm(&self) -> f64 {
        let extreme = |of: fn(f64, f64) -> f64| self.vertices.iter().map(|v| v.z).reduce(of).unwrap_or(0.0);
        extreme(f64::max) - extreme(f64::min)
    }

    /// The media on either side of the interfaces, some several times. Those of coatings do not count.
    pub fn sides(&self) -> impl Iterator<Item = MediumIndex> + '_ {
        self.interfaces.iter().flat_map(|interface| {
            let below = if let Below::Medium(medium) = interface.below { Some(medium) } else { None };
            [Some(interface.above), below].into_iter().flatten()
        })
    }

    /// Whether a facet has films.
    #[must_use]
    pub fn is_coated(&self) -> bool {
        self.facets.iter().any(|facet| !self.coatings[usize::from(facet.interface)].is_empty())
    }

    /// The facets.
    #[must_use]
    pub fn facets(&self) -> &[Facet] {
        &self.facets
    }

    /// The period in x and in y.
    #[must_use]
    pub fn period_nm(&self) -> [f64; 2] {
        self.period_nm
    }

    /// The medium that light arrives in.
    #[must_use]
    pub fn above(&self) -> MediumIndex {
        self.above
    }

    /// The longest optical path across a film: Σ n d of a coating, or the distance between the mean heights of two
    /// interfaces times the index of a medium between interfaces. Media without data at this wavelength count as 0.
    #[must_use]
    pub fn film_path_nm(&self, wavelength_nm: f64) -> f64 {
        let index = |medium: MediumIndex| {
            let medium = &self.scene.media[usize::from(medium)].medium;
            medium.borrow().eta(wavelength_nm).map_or(0.0, |eta| eta.re)
        };
        let coating = |films: &Vec<Film>| films.iter().map(|film| index(film.medium) * film.thickness_nm).sum::<f64>();
        let coated = self.coatings.iter().map(coating).fold(0.0, f64::max);
        let mean_height_nm = |kind: usize| {
            let of_kind = |&(_, facet): &(&[u32; 3], &u32)| usize::from(self.facets[*facet as usize].interface) == kind;
            let corners = self.triangles.iter().zip(&self.facet_of).filter(of_kind).flat_map(|(triangle, _)| triangle);
            let (sum, count) =
                corners.fold((0.0, 0), |(sum, count), &v| (sum + self.vertices[v as usize].z, count + 1));
            (count > 0).then(|| sum / f64::from(count))
        };
        let heights = || (0..self.interfaces.len()).filter_map(mean_height_nm);
        let height_nm = heights().fold(f64::NEG_INFINITY, f64::max) - heights().fold(f64::INFINITY, f64::min);
        let between =
            |medium: &MediumIndex| self.interfaces.iter().any(|interface| interface.below == Below::Medium(*medium));
        let inner = self.interfaces.iter().map(|interface| interface.above).filter(between).map(index);
        coated.max(height_nm * inner.fold(0.0, f64::max))
    }

    /// The number of interfaces that have facets.
    #[must_use]
    pub fn interface_count(&self) -> usize {
        let mut kinds: Vec<u16> = self.facets.iter().map(|facet| facet.interface).collect();
        kinds.sort_unstable();
        kinds.dedup();
        kinds.len()
    }

    /// The scene.
    #[must_use]
    pub fn scene(&self) -> &'s Scene {
        self.scene
    }
}

/// The normal of a triangle, as long as twice its area.
fn area_vector(vertices: &[DVec3], triangle: [u32; 3]) -> DVec3 {
    let [a, b, c] = triangle.map(|v| vertices[v as usize]);
    (b - a).cross(c - a)
}

/// Groups triangles into facets: triangles that share an edge, an interface and a plane are one facet. Returns the
/// facet of each triangle, and the facets.
fn group_into_facets(vertices: &[DVec3], triangles: &[[u32; 3]], kinds: &[u16]) -> (Vec<u32>, Vec<Facet>) {
    /// Normals of coplanar triangles differ by the rounding of single-precision files over the length of an edge.
    const COPLANAR: f64 = 1e-6;
    let normals: Vec<DVec3> = triangles.iter().map(|&t| area_vector(vertices, t).normalize()).collect();
    let position = |v: u32| vertices[v as usize].to_array().map(f64::to_bits);
    let mut parent: Vec<usize> = (0..triangles.len()).collect();
    let mut edges: HashMap<[[u64; 3]; 2], usize> = HashMap::new();
    for (index, triangle) in triangles.iter().enumerate() {
        for corner in 0..3 {
            let mut edge = [position(triangle[corner]), position(triangle[(corner + 1) % 3])];
            edge.sort_unstable();
            if let Some(&other) = edges.get(&edge) {
                if kinds[other] == kinds[index] && (normals[other] - normals[index]).length() < COPLANAR {
                    let (a, b) = (root(&mut parent, other), root(&mut parent, index));
                    parent[a.max(b)] = a.min(b);
                }
            } else {
                edges.insert(edge, index);
            }
        }
    }
    let mut facets = Vec::new();
    let mut numbers = HashMap::new();
    let facet_of = (0..triangles.len())
        .map(|index| {
            let root = root(&mut parent, index);
            *numbers.entry(root).or_insert_with(|| {
                facets.push(Facet {
                    normal: normals[root],
                    anchor_nm: vertices[triangles[root][0] as usize],
                    interface: kinds[root],
                });
                facets.len() as u32 - 1
            })
        })
        .collect();
    (facet_of, facets)
}

/// The representative of a set in the forest `parent`; halves the path to it.
fn root(parent: &mut [usize], mut index: usize) -> usize {
    while parent[index] != index {
        parent[index] = parent[parent[index]];
        index = parent[index];
    }
    index
}

/// The medium that light arrives in: the one on the upper side of the triangle with the highest vertex.
fn topmost(mesh: &Mesh, vertices: &[DVec3], interfaces: &[NamedInterface]) -> Result<MediumIndex> {
    let top_z = |t: [u32; 3]| t.iter().map(|&v| vertices[v as usize].z).fold(f64::NEG_INFINITY, f64::max);
    // A vertical facet beside the top does not tell which medium lies above.
    let leaning = mesh.triangles.iter().filter(|t| {
        let normal = area_vector(vertices, t.vertices);
        normal.z.abs() > 1e-9 * normal.length()
    });
    let top = leaning
        .max_by(|a, b| top_z(a.vertices).total_cmp(&top_z(b.vertices)))
        .ok_or_else(|| Error::failed(format_args!("{}: every facet is vertical", mesh.path.display())))?;
    let interface = interfaces[usize::from(top.interface)].interface;
    let faces_up = area_vector(vertices, top.vertices).z > 0.0;
    match (faces_up, interface.below) {
        (true, _) => Ok(interface.above),
        (false, Below::Medium(below)) => Ok(below),
        (false, Below::Mirror) => Err(Error::failed(format_args!(
            "{}:{}: a mirror faces the light with its back; turn the facet over",
            mesh.path.display(),
            top.line
        ))),
    }
}
