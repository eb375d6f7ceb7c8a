//! Binary STL.

use std::collections::HashMap;

use super::error::MeshError;
use super::source::{Format, Source};

const FORMAT: &str = "binary STL";
const HEADER: usize = 84;
const TRIANGLE: usize = 50;
/// MuJoCo's limit.
const MOST_TRIANGLES: i32 = 200_000;
/// MuJoCo's limit of a coordinate, 2^30.
const LARGEST: f32 = 1_073_741_824.0;

/// Reads binary STL as MuJoCo does: corners with equal bits are one vertex, in the order of their
/// first appearance; normals are ignored. Text is refused.
pub(super) fn read(bytes: &[u8]) -> Result<Source, MeshError> {
    if bytes.len() < HEADER {
        return Err(MeshError::Header {
            format: FORMAT,
            expected: HEADER,
            found: bytes.len(),
        });
    }
    let (header, triangles) = bytes.split_at(HEADER);
    let count = i32::from_le_bytes([header[80], header[81], header[82], header[83]]);
    if !(1..=MOST_TRIANGLES).contains(&count) {
        return Err(MeshError::Count {
            format: FORMAT,
            found: i64::from(count),
            what: "triangles",
            range: "1 to 200,000 are allowed; if the file is text, convert it to binary",
        });
    }
    let expected = TRIANGLE * count as usize;
    if triangles.len() != expected {
        return Err(MeshError::Size {
            format: FORMAT,
            declared: count as u64,
            what: "triangles",
            expected: (HEADER + expected) as u64,
            found: bytes.len() as u64,
            hint: "; if the file is text, convert it to binary",
        });
    }
    let mut source = Source {
        format: Some(Format::Stl),
        ..Source::default()
    };
    let mut seen: HashMap<[u8; 12], i32> = HashMap::new();
    for triangle in triangles.chunks_exact(TRIANGLE) {
        for corner in triangle[12..48].chunks_exact(12) {
            let mut key = [0; 12];
            key.copy_from_slice(corner);
            let vertices = source.vertices.len() / 3;
            let index = match seen.get(&key) {
                Some(&index) => index,
                None => {
                    for bytes in key.chunks_exact(4) {
                        let x = f32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]);
                        if x.abs() > LARGEST {
                            return Err(MeshError::NotFinite("vertex", vertices));
                        }
                        source.vertices.push(x);
                    }
                    seen.insert(key, vertices as i32);
                    vertices as i32
                }
            };
            source.faces.push(index);
        }
    }
    Ok(source)
}
