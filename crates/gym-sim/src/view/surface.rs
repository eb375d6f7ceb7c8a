//! Surfaces of geoms as triangles.

use gym_core::math;
use mujoco_engine::Model;
use mujoco_engine::math::Vec3;
use mujoco_engine::model::{GeomType, Hfields};

/// The number of sides of a round shape.
const SIDES: usize = 32;
/// The number of rings of half a sphere.
const RINGS: usize = 8;

/// Triangles with normals, in a frame of their own. Their corners go round against the clock as seen
/// from outside.
#[derive(Clone, Debug, Default)]
pub(super) struct Surface {
    pub(super) points: Vec<[f32; 3]>,
    /// The normal of each point.
    pub(super) normals: Vec<[f32; 3]>,
    pub(super) faces: Vec<[u32; 3]>,
}

/// Triangles of a surface or of a mesh of the model.
#[derive(Clone, Copy)]
pub(super) struct Triangles<'a> {
    pub(super) points: &'a [[f32; 3]],
    pub(super) normals: &'a [[f32; 3]],
    /// Texture coordinates; empty if there are none.
    pub(super) texture: &'a [[f32; 2]],
    /// The points, normals and texture coordinates of each triangle's corners.
    pub(super) faces: &'a [[u32; 3]],
    pub(super) face_normals: &'a [[u32; 3]],
    pub(super) face_texture: &'a [[u32; 3]],
}

impl<'a> Triangles<'a> {
    pub(super) fn of_surface(surface: &'a Surface) -> Self {
        Self {
            points: &surface.points,
            normals: &surface.normals,
            texture: &[],
            faces: &surface.faces,
            face_normals: &surface.faces,
            face_texture: &surface.faces,
        }
    }

    pub(super) fn of_mesh(m: &'a Model, id: usize) -> Self {
        let m = &*m.meshes;
        let first = m.mesh_vertadr[id];
        let faces = m.mesh_faceadr[id]..m.mesh_faceadr[id] + m.mesh_facenum[id];
        let normals = m.mesh_normaladr[id]..m.mesh_normaladr[id] + m.mesh_normalnum[id];
        let texture = usize::try_from(m.mesh_texcoordadr[id]).unwrap_or_default();
        Self {
            points: &m.mesh_vert[first..first + m.mesh_vertnum[id]],
            normals: &m.mesh_normal[normals],
            texture: &m.mesh_texcoord[texture..texture + m.mesh_texcoordnum[id]],
            faces: &m.mesh_face[faces.clone()],
            face_normals: &m.mesh_facenormal[faces.clone()],
            face_texture: &m.mesh_facetexcoord[faces],
        }
    }
}

impl Surface {
    /// The surface of a geom that is no mesh, of the sizes that `geom_size` has; empty for a plane
    /// without bounds.
    pub(super) fn of_shape(kind: GeomType, [x, y, z]: Vec3) -> Self {
        match kind {
            GeomType::Sphere => Self::round([x; 3], 0.0),
            GeomType::Capsule => Self::round([x; 3], y),
            GeomType::Ellipsoid => Self::round([x, y, z], 0.0),
            GeomType::Cylinder => Self::cylinder(x, y),
            GeomType::Box => Self::cuboid([x, y, z]),
            GeomType::Plane if x > 0.0 && y > 0.0 => {
                let corners = [[x, y], [-x, y], [-x, -y], [x, -y]];
                let mut plane = Self::default();
                plane.quad(corners.map(|[x, y]| [x, y, 0.0]), [0.0, 0.0, 1.0]);
                plane
            }
            _ => Self::default(),
        }
    }

    /// The upper surface of a height field.
    pub(super) fn of_hfield(m: &Hfields, id: usize) -> Self {
        let [x, y, top, _] = m.hfield_size[id];
        let (rows, columns) = (m.hfield_nrow[id], m.hfield_ncol[id]);
        if rows < 2 || columns < 2 {
            return Self::default();
        }
        let height = |row: usize, column: usize| {
            f64::from(m.hfield_data[m.hfield_adr[id] + row * columns + column]) * top
        };
        // points from -1 to 1
        let place = |at: usize, count: usize| 2.0 * at as f64 / (count - 1) as f64 - 1.0;
        let mut surface = Self::default();
        for row in 0..rows {
            for column in 0..columns {
                let (before, after) = (column.saturating_sub(1), (column + 1).min(columns - 1));
                let width = x * (place(after, columns) - place(before, columns));
                let along = (height(row, after) - height(row, before)) / width;
                let (below, above) = (row.saturating_sub(1), (row + 1).min(rows - 1));
                let depth = y * (place(above, rows) - place(below, rows));
                let across = (height(above, column) - height(below, column)) / depth;
                let at = [
                    x * place(column, columns),
                    y * place(row, rows),
                    height(row, column),
                ];
                surface.point(at, unit([-along, -across, 1.0]));
            }
        }
        for row in 1..rows {
            for column in 1..columns {
                let index = |row: usize, column: usize| (row * columns + column) as u32;
                let [a, b] = [index(row - 1, column - 1), index(row - 1, column)];
                let [c, d] = [index(row, column - 1), index(row, column)];
                surface.faces.extend([[a, b, d], [a, d, c]]);
            }
        }
        surface
    }

    fn point(&mut self, at: Vec3, normal: Vec3) -> u32 {
        self.points.push(at.map(|x| x as f32));
        self.normals.push(normal.map(|x| x as f32));
        self.points.len() as u32 - 1
    }

    fn quad(&mut self, corners: [Vec3; 4], normal: Vec3) {
        let [a, b, c, d] = corners.map(|corner| self.point(corner, normal));
        self.faces.extend([[a, b, c], [a, c, d]]);
    }

    fn cuboid(size: Vec3) -> Self {
        let mut surface = Self::default();
        for axis in 0..3 {
            for side in [1.0, -1.0] {
                let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
                let corner = |(s, t): (f64, f64)| {
                    let mut at = [0.0; 3];
                    (at[axis], at[u], at[v]) = (side * size[axis], s * size[u], side * t * size[v]);
                    at
                };
                let mut normal = [0.0; 3];
                normal[axis] = side;
                let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
                surface.quad(corners.map(corner), normal);
            }
        }
        surface
    }

    /// An ellipsoid, whose halves are moved along z by `half` and joined.
    fn round(size: Vec3, half: f64) -> Self {
        let mut surface = Self::default();
        // rings from the top to the bottom; the equator twice, once for each half
        for ring in 0..2 * RINGS + 2 {
            let (step, lift) = match ring {
                ..=RINGS => (ring, half),
                _ => (ring - 1, -half),
            };
            let angle = step as f64 / RINGS as f64 * std::f64::consts::FRAC_PI_2;
            let (radius, height) = math::sin_cos(angle);
            for side in 0..SIDES {
                let (sin, cos) = turn(side);
                let on_ball = [radius * cos, radius * sin, height];
                let [x, y, z] = [0, 1, 2].map(|k| on_ball[k] * size[k]);
                let normal = [0, 1, 2].map(|k| on_ball[k] / size[k]);
                surface.point([x, y, z + lift], unit(normal));
            }
        }
        surface.join_rings(2 * RINGS + 2);
        surface
    }

    /// Joins rings of points, the first at the top, by triangles.
    fn join_rings(&mut self, rings: usize) {
        for ring in 1..rings {
            for side in 0..SIDES {
                let next = (side + 1) % SIDES;
                let index = |ring: usize, side: usize| (ring * SIDES + side) as u32;
                let [a, b] = [index(ring - 1, side), index(ring - 1, next)];
                let [c, d] = [index(ring, side), index(ring, next)];
                self.faces.extend([[a, c, d], [a, d, b]]);
            }
        }
    }

    fn cylinder(radius: f64, half: f64) -> Self {
        let mut surface = Self::default();
        for z in [half, -half] {
            for side in 0..SIDES {
                let (sin, cos) = turn(side);
                surface.point([radius * cos, radius * sin, z], [cos, sin, 0.0]);
            }
        }
        surface.join_rings(2);
        for z in [half, -half] {
            let normal = [0.0, 0.0, z.signum()];
            let middle = surface.point([0.0, 0.0, z], normal);
            let rim: Vec<u32> = (0..SIDES)
                .map(|side| {
                    let (sin, cos) = turn(side);
                    surface.point([radius * cos, radius * sin, z], normal)
                })
                .collect();
            for side in 0..SIDES {
                let [a, b] = [rim[side], rim[(side + 1) % SIDES]];
                let face = if z > 0.0 {
                    [middle, a, b]
                } else {
                    [middle, b, a]
                };
                surface.faces.push(face);
            }
        }
        surface
    }
}

/// Sine and cosine of the angle of a side.
fn turn(side: usize) -> (f64, f64) {
    math::sin_cos(side as f64 / SIDES as f64 * std::f64::consts::TAU)
}

fn unit(v: Vec3) -> Vec3 {
    mujoco_engine::math::normalize(v).0
}

#[cfg(test)]
mod tests {
    use super::*;
    use mujoco_engine::math::{cross, dot, sub};

    /// The volume that the triangles enclose, if all go round in the same direction.
    fn volume(surface: &Surface) -> f64 {
        let point = |i: u32| surface.points[i as usize].map(f64::from);
        let pyramids = surface.faces.iter().map(|face| {
            let [a, b, c] = face.map(point);
            dot(a, cross(b, c)) / 6.0
        });
        pyramids.sum()
    }

    #[test]
    fn a_height_field_has_its_heights() {
        let field = Hfields {
            hfield_size: vec![[2.0, 1.0, 0.5, 0.1]],
            hfield_nrow: vec![2],
            hfield_ncol: vec![3],
            hfield_adr: vec![0],
            hfield_data: vec![0.0, 0.5, 1.0, 0.0, 0.5, 1.0],
        };
        let surface = Surface::of_hfield(&field, 0);
        assert_eq!(surface.points[..2], [[-2.0, -1.0, 0.0], [0.0, -1.0, 0.25]]);
        assert_eq!(
            (surface.points[5], surface.faces.len()),
            ([2.0, 1.0, 0.5], 4)
        );
        // it rises by 0.5 m on 4 m
        let length = (1.0_f32 + 0.125 * 0.125).sqrt();
        for [x, y, z] in &surface.normals {
            assert!(
                (x + 0.125 / length).abs() < 1e-6 && *y == 0.0 && (z - 1.0 / length).abs() < 1e-6
            );
        }
    }

    #[test]
    fn surfaces_enclose_their_shapes() {
        let pi = std::f64::consts::PI;
        for (kind, size, expected) in [
            (GeomType::Sphere, [0.3, 0.0, 0.0], 4.0 / 3.0 * pi * 0.027),
            (GeomType::Ellipsoid, [0.3, 0.2, 0.5], 4.0 / 3.0 * pi * 0.03),
            (
                GeomType::Capsule,
                [0.1, 0.5, 0.0],
                pi * (0.01 + 0.004 / 3.0),
            ),
            (GeomType::Cylinder, [0.1, 0.5, 0.0], pi * 0.01),
            (GeomType::Box, [0.1, 0.2, 0.3], 0.048),
        ] {
            let surface = Surface::of_shape(kind, size);
            let ratio = volume(&surface) / expected;
            assert!((0.96..1.0 + 1e-6).contains(&ratio), "{kind:?}: {ratio}");
            // normals point outwards, and away from the face's back
            for face in &surface.faces {
                let [a, b, c] = face.map(|i| surface.points[i as usize].map(f64::from));
                let across = cross(sub(b, a), sub(c, a));
                for corner in face {
                    let normal = surface.normals[*corner as usize].map(f64::from);
                    assert!(dot(normal, across) >= -1e-6, "{kind:?}");
                    assert!((dot(normal, normal) - 1.0).abs() < 1e-5, "{kind:?}");
                }
            }
        }
    }
}
