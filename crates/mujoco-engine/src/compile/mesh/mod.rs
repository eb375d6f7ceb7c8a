//! Meshes: what a file holds becomes the arrays that contacts, inertia and pictures need, with the
//! bits of libmujoco.
//!
//! A [`Source`] comes from a file (`stl.rs`, `obj.rs` with `polygon.rs`, `msh.rs`) or from
//! attributes. [`Mesh::compile`] then finds its convex hull from the vertices as the file gives
//! them, joins the hull's triangles to polygons (`polygons.rs`, in the order of `order.rs`), makes
//! normals (`normals.rs`), moves and scales the mesh, finds its volume and moments of inertia
//! (`integrals.rs`), and expresses it in its principal frame. The formulas and the order of
//! operations are those of MuJoCo 3.12 (`user_mesh.cc`, `user_util.cc`, Apache-2.0).

mod builtin;
mod error;
mod fit;
mod integrals;
mod msh;
mod normals;
mod obj;
mod order;
mod polygon;
mod polygons;
#[cfg(test)]
pub(crate) mod samples;
mod source;
mod stl;
#[cfg(test)]
mod tests;

pub use builtin::Builtin;
pub use error::MeshError;
pub use source::{Format, Source};

pub use crate::mjcf::spec::{Inertia, MeshOptions as Options};

use polygons::Polygons;

use crate::Revision;
use crate::compile::hull::{Graph, convex_hull};
use crate::compile::inertia::principal_axes_within;
use crate::math::spatial::{
    EPS, InTurn, MINVAL, Order, Quat, Vec3, cross, dot, rotate, rotate_back,
};
use crate::mjcf::orientation::unit;

/// From MuJoCo 3.14 on, off-diagonal moments of a mesh that are smaller, relative to the largest
/// moment, count as zero. Found by experiment with 4.0.0: of 77 meshes, the largest that was left
/// was 9.4e-8.
const AXES_REST: f64 = 1e-7;

/// A compiled mesh, in its principal frame: the origin is the centre of mass, and the axes are the
/// principal axes of inertia.
#[derive(Clone, Debug, PartialEq)]
pub struct Mesh {
    /// `mesh_vert`: x, y, z of each vertex, in m.
    pub vertices: Vec<f32>,
    /// `mesh_normal`: x, y, z of each normal.
    pub normals: Vec<f32>,
    /// `mesh_texcoord`: u, v of each texture coordinate.
    pub texture: Vec<f32>,
    /// `mesh_face`: the vertices of each triangle.
    pub faces: Vec<[i32; 3]>,
    /// `mesh_facenormal`: the normals of each triangle's corners.
    pub face_normals: Vec<i32>,
    /// `mesh_facetexcoord`: the texture coordinates of each triangle's corners; empty if there are
    /// none.
    pub face_texture: Vec<i32>,
    /// `mesh_graph`: the convex hull, if one is needed.
    pub graph: Option<Graph>,
    /// `mesh_extrema`: for each of 27 directions the furthest vertex of the hull, by its number in
    /// the graph.
    pub extrema: [i32; 27],
    /// `mesh_polyvert`: the vertices of each polygon of the hull.
    pub polygons: Vec<Vec<i32>>,
    /// `mesh_polynormal`: the unit normal of each polygon.
    pub polygon_normals: Vec<Vec3>,
    /// `mesh_polymap`: the polygons of each vertex.
    pub polygons_of_vertex: Vec<Vec<i32>>,
    /// `mesh_pos`: the frame's origin in the file's coordinates, after `scale` and the like.
    pub position: Vec3,
    /// `mesh_quat`: the frame's orientation.
    pub orientation: Quat,
    /// The volume in m^3; of a shell, the area in m^2.
    pub volume: f64,
    /// Half the sizes of the box with the same mass and inertia, in m.
    pub half_sizes: Vec3,
    /// The least coordinates.
    pub lower: Vec3,
    /// The greatest coordinates.
    pub upper: Vec3,
}

impl Mesh {
    /// Compiles a mesh as the given revision of MuJoCo does.
    ///
    /// # Errors
    ///
    /// [`MeshError`] if the data do not fit together, the mesh is flat though it collides, it has
    /// no area or volume, or it is beyond the limits of
    /// [`MOST_POINTS`](crate::compile::hull::MOST_POINTS) vertices and 2^25 corners of faces.
    pub fn compile(
        mut source: Source,
        options: &Options,
        revision: Revision,
    ) -> Result<Self, MeshError> {
        let right_handed = options.scale[0] * options.scale[1] * options.scale[2] > 0.0;
        if source.format == Some(Format::Msh) && !right_handed && !revision.turns_mirrored_hulls() {
            // 3.12 turns these faces here and once more below
            turn(source.faces.as_chunks_mut().0);
        }
        source.check()?;
        let mut points: Vec<Vec3> = source
            .vertices
            .as_chunks()
            .0
            .iter()
            .map(|v: &[f32; 3]| v.map(f64::from))
            .collect();
        let mut faces: Vec<[i32; 3]> = source.faces.as_chunks().0.to_vec();
        if options.inertia == Inertia::Exact {
            check_orientation(&points, &faces)?;
        }

        let needs_hull = options.collides || options.inertia == Inertia::Convex || faces.is_empty();
        let mut graph = needs_hull
            .then(|| hull(&points, options.max_hull_vertices))
            .transpose()?;
        let hull_faces = graph.iter().flat_map(|graph| &graph.faces);
        let mut hull_faces: Vec<[i32; 3]> = hull_faces.map(|face| face.map(|v| v as i32)).collect();
        if faces.is_empty() {
            faces.clone_from(&hull_faces);
        }

        let mut normals = source.normals;
        let mut face_normals = source.face_normals;
        if normals.is_empty() {
            normals = normals::vertex_normals(&points, &faces, options.smooth);
            face_normals = faces.as_flattened().to_vec();
        }
        if !face_normals.is_empty() && face_normals.len() != 3 * faces.len() {
            return Err(MeshError::FaceNormals {
                normals: face_normals.len(),
                faces: 3 * faces.len(),
            });
        }
        let mut face_texture = source.face_texture;
        if face_texture.is_empty() && !source.texture.is_empty() {
            face_texture = faces.as_flattened().to_vec();
        }
        if face_normals.is_empty() {
            let per_vertex = (normals.len() / source.vertices.len()) as i32;
            face_normals = faces
                .as_flattened()
                .iter()
                .map(|&v| per_vertex.wrapping_mul(v))
                .collect();
        }
        check_corners("normals", &face_normals, normals.len() / 3)?;
        if !source.texture.is_empty() {
            if face_texture.len() != 3 * faces.len() {
                return Err(MeshError::FaceTexture {
                    found: face_texture.len(),
                    faces: 3 * faces.len(),
                });
            }
            check_corners(
                "texture coordinates",
                &face_texture,
                source.texture.len() / 2,
            )?;
        }
        let mut polygons = Polygons::new(&points, &hull_faces, revision);
        if !right_handed {
            turn(&mut faces);
            turn(face_normals.as_chunks_mut().0);
            turn(face_texture.as_chunks_mut().0);
            if revision.turns_mirrored_hulls() {
                // 3.12 leaves the hull inside out
                turn(graph.as_mut().map_or(&mut [], |graph| &mut graph.faces));
                turn(&mut hull_faces);
                for corners in &mut polygons.corners {
                    corners[1..].reverse();
                }
            }
        }

        transform(&mut points, &mut normals, options);
        let (area, centroid) = integrals::face_centroid(&points, &faces);
        if area < MINVAL {
            return Err(MeshError::Area(area));
        }
        let solid = if options.inertia == Inertia::Convex {
            &hull_faces
        } else {
            &faces
        };
        let (volume, center) = integrals::center_of_mass(&points, solid, centroid, options.inertia);
        if volume < MINVAL {
            return Err(match options.inertia {
                Inertia::Shell => MeshError::Area(volume),
                _ if volume < 0.0 => MeshError::NegativeVolume(volume),
                _ => MeshError::Volume(volume),
            });
        }
        let (volume, moments) = integrals::moments(&points, solid, center, options.inertia);
        let (moments, orientation) = principal_axes_within(moments, revision, AXES_REST);
        let half_sizes = inertia_box(moments, volume)?;

        let [w, x, y, z] = orientation;
        let turn = InTurn::quat_to_mat([w, -x, -y, -z]);
        let (mut lower, mut upper) = ([1e10; 3], [-1e10; 3]);
        for point in &mut points {
            *point = rotate(&turn, [0, 1, 2].map(|k| point[k] - center[k]));
            for k in 0..3 {
                lower[k] = if point[k] < lower[k] {
                    point[k]
                } else {
                    lower[k]
                };
                upper[k] = if upper[k] < point[k] {
                    point[k]
                } else {
                    upper[k]
                };
            }
        }
        normals::rotate_all(&mut normals, |normal| rotate(&turn, normal));
        let polygon_normals = polygons
            .corners
            .iter()
            .map(|corners| polygon_normal(&points, corners, revision))
            .collect();
        let vertices: Vec<f32> = points.iter().flatten().map(|&x| x as f32).collect();
        for (what, numbers, width) in [
            ("vertex", &vertices, 3),
            ("normal", &normals, 3),
            ("texture coordinate", &source.texture, 2),
        ] {
            if let Some(i) = numbers.iter().position(|x| !x.is_finite()) {
                return Err(MeshError::NotFinite(what, i / width));
            }
        }
        Ok(Self {
            extrema: graph
                .as_ref()
                .map_or([0; 27], |graph| extrema(&vertices, graph)),
            vertices,
            normals,
            texture: source.texture,
            faces,
            face_normals,
            face_texture,
            graph,
            polygons: polygons.corners,
            polygon_normals,
            polygons_of_vertex: polygons.of_vertex,
            position: center,
            orientation,
            volume,
            half_sizes,
            lower,
            upper,
        })
    }

    /// The principal moments of inertia, in kg m^2, with the mass `mass` in kg.
    #[must_use]
    pub fn moments(&self, mass: f64) -> Vec3 {
        let [x, y, z] = self.half_sizes.map(|x| x * x);
        [y + z, x + z, x + y].map(|square| mass * square / 3.0)
    }
}

/// Requires the numbers of faces' corners to be less than a count.
fn check_corners(what: &'static str, corners: &[i32], count: usize) -> Result<(), MeshError> {
    let wrong = |number: &i32| !usize::try_from(*number).is_ok_and(|number| number < count);
    match corners.iter().position(wrong) {
        None => Ok(()),
        Some(i) => Err(MeshError::NoCorner {
            what,
            face: i / 3,
            number: corners[i],
            count,
        }),
    }
}

fn turn<T>(faces: &mut [[T; 3]]) {
    for face in faces {
        face.swap(1, 2);
    }
}

/// Exact inertia needs faces that go along each edge once in each direction.
fn check_orientation(points: &[Vec3], faces: &[[i32; 3]]) -> Result<(), MeshError> {
    let mut edges = Vec::new();
    for (face, corners) in faces.iter().zip(integrals::corners(points, faces)) {
        if integrals::triangle(corners).0 > MINVAL.sqrt() {
            let [a, b, c] = *face;
            edges.extend([(a, b), (b, c), (c, a)]);
        }
    }
    edges.sort_unstable();
    match edges.windows(2).find(|pair| pair[0] == pair[1]) {
        Some(&[(a, b), _]) => Err(MeshError::Orientation(a, b)),
        _ => Ok(()),
    }
}

/// The convex hull of vertices that have a volume.
fn hull(points: &[Vec3], max_vertices: Option<u32>) -> Result<Graph, MeshError> {
    let from_first = |p: &Vec3| [0, 1, 2].map(|k| p[k] - points[0][k]);
    let length = |v: Vec3| dot(v, v).sqrt();
    let Some(second) = (1..points.len()).find(|&i| length(from_first(&points[i])) > MINVAL) else {
        return Err(MeshError::Flat("at one place", "a small sphere"));
    };
    let edge = from_first(&points[second]);
    let width = length(edge);
    let normal = points
        .iter()
        .enumerate()
        .skip(1)
        .filter(|&(i, _)| i != second)
        .find_map(|(_, p)| {
            let other = from_first(p);
            let normal = cross(edge, other);
            let norm = length(normal);
            (length(other) >= MINVAL && norm > MINVAL * width * length(other))
                .then(|| normal.map(|x| x / norm))
        });
    let Some(normal) = normal else {
        return Err(MeshError::Flat("on one line", "a thin capsule"));
    };
    let height = dot(normal, points[0]);
    if points
        .iter()
        .all(|&p| (dot(normal, p) - height).abs() <= MINVAL * width)
    {
        return Err(MeshError::Flat("in one plane", "a plane or a thin box"));
    }
    Ok(convex_hull(points, max_vertices)?)
}

/// Moves and turns vertices and normals to the frame of `position` and `orientation`, and scales
/// them.
fn transform(points: &mut [Vec3], normals: &mut [f32], options: &Options) {
    let Options {
        scale,
        position,
        orientation,
        ..
    } = *options;
    if position != [0.0; 3] {
        for point in &mut *points {
            *point = [0, 1, 2].map(|k| point[k] - position[k]);
        }
    }
    let turn =
        (orientation != [1.0, 0.0, 0.0, 0.0]).then(|| InTurn::quat_to_mat(unit(orientation).0));
    if let Some(turn) = &turn {
        for point in &mut *points {
            *point = rotate_back(turn, *point);
        }
    }
    if scale != [1.0; 3] {
        for point in &mut *points {
            *point = [0, 1, 2].map(|k| point[k] * scale[k]);
        }
    }
    normals::transform(normals, turn.as_ref(), scale);
}

/// Half the sizes of the box with these moments.
fn inertia_box(moments: Vec3, volume: f64) -> Result<Vec3, MeshError> {
    const RELATIVE: f64 = 1.0 - 1e-6;
    const ABSOLUTE: f64 = 1e-9;
    let [a, b, c] = moments;
    let impossible = |a: f64, b: f64, c: f64| a + b < c * RELATIVE - ABSOLUTE;
    if c <= 0.0 || impossible(a, b, c) || impossible(a, c, b) || impossible(b, c, a) {
        return Err(MeshError::Inertia(moments));
    }
    Ok([b + c - a, a + c - b, a + b - c].map(|sum| 0.5 * (6.0 * sum / volume).sqrt()))
}

/// The unit normal of a polygon: in 3.12 that of its first three corners, in 4.0 of all (Newell's
/// method; found by experiment).
fn polygon_normal(points: &[Vec3], corners: &[i32], revision: Revision) -> Vec3 {
    let corner = |i: usize| points[corners[i % corners.len()] as usize];
    let normal = if revision.newell_normals() {
        let mut sum = [0.0; 3];
        for i in 0..corners.len() {
            let (a, b) = (corner(i), corner(i + 1));
            for (k, sum) in sum.iter_mut().enumerate() {
                let (y, z) = ((k + 1) % 3, (k + 2) % 3);
                *sum += (a[y] - b[y]) * (a[z] + b[z]);
            }
        }
        sum
    } else {
        let [a, b, c] = [0, 1, 2].map(corner);
        cross(
            [0, 1, 2].map(|k| b[k] - a[k]),
            [0, 1, 2].map(|k| c[k] - a[k]),
        )
    };
    let length = dot(normal, normal).sqrt();
    if length < EPS {
        [1.0, 0.0, 0.0]
    } else {
        normal.map(|x| x / length)
    }
}

/// The furthest vertices of the hull in the directions of a cube's corners, edges and faces: where
/// searches start.
fn extrema(vertices: &[f32], graph: &Graph) -> [i32; 27] {
    let mut most = [f32::MIN; 27];
    let mut extrema = [0; 27];
    for (number, &v) in graph.points.iter().enumerate() {
        let [x, y, z] = [0, 1, 2].map(|k| vertices[3 * v as usize + k]);
        for (i, (most, best)) in most.iter_mut().zip(&mut extrema).enumerate() {
            let [cx, cy, cz] = [i / 9, i / 3 % 3, i % 3].map(|step| step as f32 - 1.0);
            let product = x * cx + y * cy + z * cz;
            if product > *most {
                (*most, *best) = (product, number as i32);
            }
        }
    }
    extrema
}
