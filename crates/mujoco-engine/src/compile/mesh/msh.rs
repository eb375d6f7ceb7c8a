//! MSH, MuJoCo's own binary format.

use super::error::MeshError;
use super::source::{Format, Source};

const FORMAT: &str = "MSH";

/// Reads four counts (of vertices, normals, texture coordinates and faces), then these lists, all
/// little-endian.
pub(super) fn read(bytes: &[u8]) -> Result<Source, MeshError> {
    if bytes.len() < 16 {
        return Err(MeshError::Header {
            format: FORMAT,
            expected: 16,
            found: bytes.len(),
        });
    }
    let word = |i: usize| {
        [
            bytes[4 * i],
            bytes[4 * i + 1],
            bytes[4 * i + 2],
            bytes[4 * i + 3],
        ]
    };
    let [vertices, normals, texture, faces] =
        [0, 1, 2, 3].map(|i| i64::from(i32::from_le_bytes(word(i))));
    let wrong = |found: i64, what: &'static str, range: &'static str| MeshError::Count {
        format: FORMAT,
        found,
        what,
        range,
    };
    if vertices < 4 {
        return Err(wrong(vertices, "vertices", "at least 4 are needed"));
    }
    if faces < 0 {
        return Err(wrong(faces, "faces", "a count is not negative"));
    }
    if normals != 0 && normals != vertices {
        return Err(wrong(
            normals,
            "normals",
            "none, or one per vertex, is allowed",
        ));
    }
    if texture != 0 && texture != vertices {
        return Err(wrong(
            texture,
            "texture coordinates",
            "none, or one per vertex, is allowed",
        ));
    }
    let expected = 16 + 4 * (3 * vertices + 3 * normals + 2 * texture + 3 * faces) as u64;
    if bytes.len() as u64 != expected {
        return Err(MeshError::Size {
            format: FORMAT,
            declared: vertices as u64,
            what: "vertices and the other counts of its header",
            expected,
            found: bytes.len() as u64,
            hint: "",
        });
    }
    let mut rest = bytes[16..]
        .chunks_exact(4)
        .map(|word| [word[0], word[1], word[2], word[3]]);
    let mut floats = |n: i64| -> Vec<f32> {
        rest.by_ref()
            .take(n as usize)
            .map(f32::from_le_bytes)
            .collect()
    };
    let vertices = floats(3 * vertices);
    let normals = floats(3 * normals);
    let texture = floats(2 * texture);
    let faces: Vec<i32> = rest.map(i32::from_le_bytes).collect();
    Ok(Source {
        format: Some(Format::Msh),
        vertices,
        normals,
        face_normals: faces.clone(),
        face_texture: if texture.is_empty() {
            Vec::new()
        } else {
            faces.clone()
        },
        texture,
        faces,
    })
}
