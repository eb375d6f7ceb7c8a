//! A mesh as files and attributes give it.

use super::error::MeshError;
use super::{msh, obj, stl};
use crate::Revision;
use crate::compile::hull::MOST_POINTS;

/// The most corners of faces: eleven million triangles.
pub(super) const MOST_CORNERS: usize = 1 << 25;

/// The format of a mesh file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Binary STL: at most 200,000 triangles.
    Stl,
    /// Wavefront OBJ: the faces of the first object or group; polygons are cut into triangles.
    Obj,
    /// MuJoCo's binary format.
    Msh,
}

impl Format {
    /// The format that an extension or a media type names (`model/stl`, `model/obj`,
    /// `model/vnd.mujoco.msh`).
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        match name.to_ascii_lowercase().as_str() {
            "stl" | "model/stl" => Some(Self::Stl),
            "obj" | "model/obj" => Some(Self::Obj),
            "msh" | "model/vnd.mujoco.msh" => Some(Self::Msh),
            _ => None,
        }
    }
}

/// A mesh as files and attributes give it: flat lists, with MuJoCo's meaning.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Source {
    /// The file's format; none if there is no file.
    pub format: Option<Format>,
    /// x, y, z of each vertex, in the mesh's unit.
    pub vertices: Vec<f32>,
    /// x, y, z of each normal.
    pub normals: Vec<f32>,
    /// u, v of each texture coordinate.
    pub texture: Vec<f32>,
    /// Three vertices of each triangle, counterclockwise from outside.
    pub faces: Vec<i32>,
    /// Three normals of each triangle.
    pub face_normals: Vec<i32>,
    /// Three texture coordinates of each triangle.
    pub face_texture: Vec<i32>,
}

impl Source {
    /// Reads a mesh file as the given revision of MuJoCo does; polygons are cut differently.
    ///
    /// # Errors
    ///
    /// [`MeshError`] if the bytes are no file of this format. A declared count is compared with the
    /// number of bytes before anything is allocated.
    pub fn read(format: Format, bytes: &[u8], revision: Revision) -> Result<Self, MeshError> {
        match format {
            Format::Stl => stl::read(bytes),
            Format::Obj => obj::read(bytes, revision),
            Format::Msh => msh::read(bytes),
        }
    }

    /// Adds the lists of attributes that the file lacks.
    ///
    /// # Errors
    ///
    /// If both give a list.
    pub fn complete(&mut self, attributes: Self) -> Result<(), MeshError> {
        fn fill<T>(name: &'static str, list: &mut Vec<T>, other: Vec<T>) -> Result<(), MeshError> {
            if list.is_empty() {
                *list = other;
            } else if !other.is_empty() {
                return Err(MeshError::Repeated(name));
            }
            Ok(())
        }
        if !self.face_normals.is_empty() && !attributes.normals.is_empty() {
            return Err(MeshError::Repeated("normal"));
        }
        fill("normal", &mut self.normals, attributes.normals)?;
        fill("texcoord", &mut self.texture, attributes.texture)?;
        fill("face", &mut self.faces, attributes.faces)?;
        fill("vertex", &mut self.vertices, attributes.vertices)?;
        if self.face_normals.is_empty() {
            self.face_normals = attributes.face_normals;
        }
        fill("texcoord", &mut self.face_texture, attributes.face_texture)
    }

    /// Checks lengths, indices and coordinates.
    pub(super) fn check(&self) -> Result<(), MeshError> {
        for (name, found, multiple) in [
            ("vertex", self.vertices.len(), 3),
            ("normal", self.normals.len(), 3),
            ("texcoord", self.texture.len(), 2),
            ("face", self.faces.len(), 3),
            ("the list of the faces' normals", self.face_normals.len(), 3),
            (
                "the list of the faces' texture coordinates",
                self.face_texture.len(),
                3,
            ),
        ] {
            if found % multiple != 0 {
                return Err(MeshError::Multiple {
                    name,
                    found,
                    multiple,
                });
            }
        }
        let vertices = self.vertices.len() / 3;
        if vertices < 4 {
            return Err(MeshError::TooFewVertices(vertices));
        }
        for (what, found, most) in [
            ("vertices", vertices, MOST_POINTS),
            ("corners of faces", self.faces.len(), MOST_CORNERS),
        ] {
            if found > most {
                return Err(MeshError::TooMany { what, found, most });
            }
        }
        if let Some(i) = self.vertices.iter().position(|x| !x.is_finite()) {
            return Err(MeshError::NotFinite("vertex", i / 3));
        }
        if !self.texture.is_empty()
            && self.texture.len() != 2 * vertices
            && self.face_texture.is_empty()
            && self.format != Some(Format::Obj)
        {
            return Err(MeshError::TextureCoordinates {
                found: self.texture.len() / 2,
                vertices,
            });
        }
        if let Some(i) = self
            .faces
            .iter()
            .position(|&v| v < 0 || v as usize >= vertices)
        {
            return Err(MeshError::NoVertex {
                face: i / 3,
                vertex: self.faces[i],
                vertices,
            });
        }
        Ok(())
    }
}
