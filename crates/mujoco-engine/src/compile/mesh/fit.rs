//! Shapes fitted to a mesh (`FitGeom` in MuJoCo's `user_mesh.cc`).

use super::Mesh;
use crate::math::spatial::Vec3;
use crate::model::GeomType;

impl Mesh {
    /// The size of a shape fitted to the mesh and its centre in the mesh's frame: with the same box
    /// of inertia, or with `by_bounds` the least that has the mesh's bounds within its own. `None`
    /// for shapes that cannot be fitted.
    #[must_use]
    pub fn fit(&self, shape: GeomType, by_bounds: bool, scale: f64) -> Option<(Vec3, Vec3)> {
        let center = if by_bounds {
            [0, 1, 2].map(|k| (self.lower[k] + self.upper[k]) / 2.0)
        } else {
            [0.0; 3]
        };
        let [x, y, z] = if by_bounds {
            [0, 1, 2].map(|k| self.upper[k] - center[k])
        } else {
            self.half_sizes
        };
        let max = |a: f64, b: f64| if a < b { b } else { a };
        let size = match (shape, by_bounds) {
            (GeomType::Sphere, false) => [(x + y + z) / 3.0, 0.0, 0.0],
            (GeomType::Sphere, true) => [max(max(x, y), z), 0.0, 0.0],
            (GeomType::Capsule, false) => {
                let radius = (x + y) / 2.0;
                [radius, max(0.0, z - radius / 2.0), 0.0]
            }
            (GeomType::Capsule, true) => [max(x, y), z - max(x, y), 0.0],
            (GeomType::Cylinder, false) => [(x + y) / 2.0, z, 0.0],
            (GeomType::Cylinder, true) => [max(x, y), z, 0.0],
            (GeomType::Ellipsoid | GeomType::Box, _) => [x, y, z],
            _ => return None,
        };
        Some((size.map(|x| x * scale), center))
    }
}
