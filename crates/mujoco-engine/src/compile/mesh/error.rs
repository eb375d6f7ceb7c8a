//! Why a mesh cannot be compiled.

use crate::compile::hull::HullError;

/// Why a mesh cannot be compiled: the fault, where it is, and what to do. libmujoco refuses the
/// same meshes, except for the limits.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MeshError {
    /// The file ends too early, or is longer than its header says.
    #[error("a file of {format} with {declared} {what} has {expected} bytes, found {found}{}", .hint)]
    Size {
        /// The file's format.
        format: &'static str,
        /// The number that the header declares.
        declared: u64,
        /// What the header counts.
        what: &'static str,
        /// The bytes that it should have.
        expected: u64,
        /// The bytes that it has.
        found: u64,
        /// What may be wrong.
        hint: &'static str,
    },
    /// The file is shorter than a header.
    #[error("a file of {format} begins with {expected} bytes, found {found}")]
    Header {
        /// The file's format.
        format: &'static str,
        /// The bytes of the header.
        expected: usize,
        /// The bytes that the file has.
        found: usize,
    },
    /// A header's number that is out of range.
    #[error("{format} with {found} {what}: {range}")]
    Count {
        /// The file's format.
        format: &'static str,
        /// The number.
        found: i64,
        /// What it counts.
        what: &'static str,
        /// What is allowed.
        range: &'static str,
    },
    /// A line of an OBJ file that cannot be read.
    #[error("line {line} of the OBJ file: {fault}")]
    Line {
        /// The line, from 1.
        line: usize,
        /// What is wrong.
        fault: &'static str,
    },
    /// A list whose length is no multiple.
    #[error("{name} has {found} numbers: expected a multiple of {multiple}")]
    Multiple {
        /// The list.
        name: &'static str,
        /// Its length.
        found: usize,
        /// What its length should be a multiple of.
        multiple: usize,
    },
    /// A list that both the file and the attributes give.
    #[error("both the file and the attribute `{0}` give it: remove one")]
    Repeated(&'static str),
    /// A number that is NaN, infinite or too large.
    #[error("{0} {1} has a number that is not finite, or too large")]
    NotFinite(&'static str, usize),
    /// Fewer than four vertices.
    #[error("a mesh needs at least 4 vertices, found {0}")]
    TooFewVertices(usize),
    /// More of something than the limit.
    #[error("{found} {what}: at most {most} are supported; simplify the mesh")]
    TooMany {
        /// What there is too much of.
        what: &'static str,
        /// How much there is.
        found: usize,
        /// The limit.
        most: usize,
    },
    /// A face names a vertex that does not exist.
    #[error("face {face} names vertex {vertex}, but the mesh has {vertices}")]
    NoVertex {
        /// The face, from 0.
        face: usize,
        /// The vertex, from 0.
        vertex: i32,
        /// The number of vertices.
        vertices: usize,
    },
    /// A corner of a face names a normal or texture coordinate that does not exist.
    #[error("face {face} names {number} of the {what}, but the mesh has {count}")]
    NoCorner {
        /// What there is too little of.
        what: &'static str,
        /// The face, from 0.
        face: usize,
        /// The number, from 0.
        number: i32,
        /// How many there are.
        count: usize,
    },
    /// Faces whose texture coordinates are counted otherwise.
    #[error("{found} indices of texture coordinates for {faces} of vertices")]
    FaceTexture {
        /// The number of indices of texture coordinates.
        found: usize,
        /// The number of indices of vertices.
        faces: usize,
    },
    /// Texture coordinates that faces cannot name.
    #[error(
        "{found} texture coordinates for {vertices} vertices: give one per vertex, or indices of faces in an OBJ file"
    )]
    TextureCoordinates {
        /// The number of texture coordinates.
        found: usize,
        /// The number of vertices.
        vertices: usize,
    },
    /// Faces whose normals are counted otherwise.
    #[error("{normals} indices of normals for {faces} of vertices")]
    FaceNormals {
        /// The number of indices of normals.
        normals: usize,
        /// The number of indices of vertices.
        faces: usize,
    },
    /// All vertices at one place, on one line or in one plane.
    #[error("the vertices are {0}: a mesh that collides needs a volume; use {1} instead")]
    Flat(&'static str, &'static str),
    /// The convex hull failed.
    #[error("no convex hull: {0}")]
    Hull(#[from] HullError),
    /// Two faces on one side of an edge.
    #[error(
        "two faces go from vertex {0} to vertex {1}: turn one, or use another `inertia` than exact"
    )]
    Orientation(i32, i32),
    /// The faces have no area.
    #[error("the area of the faces is too small: {0}")]
    Area(f64),
    /// The volume is negative.
    #[error("the volume is negative, {0}: the faces are turned inside out")]
    NegativeVolume(f64),
    /// The volume is too small.
    #[error("the volume is too small, {0}: set `inertia` to shell")]
    Volume(f64),
    /// Principal moments that no body has.
    #[error(
        "the principal moments of inertia are {0:?}: no body has them; check that the faces enclose a volume"
    )]
    Inertia([f64; 3]),
}
