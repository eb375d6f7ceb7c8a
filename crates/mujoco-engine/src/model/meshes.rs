//! The meshes of a model.

use serde::{Deserialize, Serialize};

/// The meshes of a model, with the field names of MuJoCo's `mjModel`.
///
/// Arrays whose names end with `adr` and `num` say where the elements of a mesh, of a polygon
/// (`mesh_polyvert`) or of a vertex (`mesh_polymap`) begin in another array, and how many they are.
/// They follow each other.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Meshes {
    /// First vertex of the mesh.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub mesh_vertadr: Vec<usize>,
    /// Number of vertices.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub mesh_vertnum: Vec<usize>,
    /// Vertices of all meshes, each in its mesh's principal frame.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub mesh_vert: Vec<[f32; 3]>,
    /// First normal of the mesh.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub mesh_normaladr: Vec<usize>,
    /// Number of normals.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub mesh_normalnum: Vec<usize>,
    /// Normals of all meshes, for pictures.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub mesh_normal: Vec<[f32; 3]>,
    /// First texture coordinates of the mesh; -1 if there are none.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub mesh_texcoordadr: Vec<i32>,
    /// Number of texture coordinates.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub mesh_texcoordnum: Vec<usize>,
    /// Texture coordinates of all meshes.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub mesh_texcoord: Vec<[f32; 2]>,
    /// First triangle of the mesh.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub mesh_faceadr: Vec<usize>,
    /// Number of triangles.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub mesh_facenum: Vec<usize>,
    /// Vertices of the triangles, by their numbers in the mesh.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub mesh_face: Vec<[u32; 3]>,
    /// Normals of the triangles' corners, by their numbers in the mesh.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub mesh_facenormal: Vec<[u32; 3]>,
    /// Texture coordinates of the triangles' corners, by their numbers in the mesh; 0 if there
    /// are none.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub mesh_facetexcoord: Vec<[u32; 3]>,
    /// Where the mesh's convex hull begins in `mesh_graph`; -1 if there is none.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub mesh_graphadr: Vec<i32>,
    /// Convex hulls: the numbers of vertices and of triangles; for each vertex where its neighbours
    /// begin, then its number in the mesh; the neighbours of each vertex, by their numbers in the
    /// hull, and -1; the triangles, by their vertices' numbers in the mesh.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub mesh_graph: Vec<i32>,
    /// The furthest vertex of the hull in each direction of a cube's corners, edges and faces, by its
    /// number in the hull.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub mesh_extrema: Vec<[u32; 27]>,
    /// First polygon of the mesh.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub mesh_polyadr: Vec<usize>,
    /// Number of polygons.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub mesh_polynum: Vec<usize>,
    /// Unit normals of the polygons of all hulls.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub mesh_polynormal: Vec<[f64; 3]>,
    /// Where the polygon's vertices begin in `mesh_polyvert`.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub mesh_polyvertadr: Vec<usize>,
    /// Number of vertices of the polygon.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub mesh_polyvertnum: Vec<usize>,
    /// Vertices of the polygons, by their numbers in the mesh.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub mesh_polyvert: Vec<u32>,
    /// Where the polygons of the vertex begin in `mesh_polymap`.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub mesh_polymapadr: Vec<usize>,
    /// Number of polygons of the vertex.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub mesh_polymapnum: Vec<usize>,
    /// Polygons of the vertices, by their numbers in the mesh.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub mesh_polymap: Vec<u32>,
    /// Origin of the mesh's principal frame, in the coordinates of its file after `refpos`,
    /// `refquat` and `scale`.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub mesh_pos: Vec<[f64; 3]>,
    /// Orientation of the mesh's principal frame.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub mesh_quat: Vec<[f64; 4]>,
}
