//! Intersections of rays with the triangles of meshes and height fields.

use std::ops::Range;

use super::{cuboid, faces, near};
use crate::Model;
use crate::math::spatial::{
    MINVAL, Mat3, Vec3, add, add_scaled, column, cross, dot, normalize, rotate, rotate_back, scale,
    sub,
};
use crate::model::GeomType;
use crate::model::bounds::Bounds;

/// A ray in the frame of a geom, and two directions that are orthogonal to it.
struct Local {
    from: Vec3,
    along: Vec3,
    across: [Vec3; 2],
}

impl Local {
    fn new((pos, mat): (Vec3, &Mat3), point: Vec3, along: Vec3) -> Self {
        let from = rotate_back(mat, sub(point, pos));
        let along = rotate_back(mat, along);
        let [x, y, z] = along.map(f64::abs);
        let mut first = [1.0; 3];
        first[match () {
            () if x >= y && x >= z => 0,
            () if y >= z => 1,
            () => 2,
        }] = 0.0;
        let part = -dot(along, first) / dot(along, along);
        let second = normalize(add_scaled(first, along, part)).0;
        let first = normalize(cross(second, along)).0;
        Self {
            from,
            along,
            across: [first, second],
        }
    }

    /// Whether the line through the ray may meet a box, or a triangle within, up to rounding.
    fn meets(&self, [centre, half]: &Bounds) -> bool {
        const ROUNDING: f64 = 1e-12;
        let from = sub(*centre, self.from);
        let size = |[x, y, z]: Vec3| x.abs() + y.abs() + z.abs();
        let rounding = ROUNDING * (size(from) + size(*half));
        let is_beside = |[x, y, z]: Vec3| {
            let reach = dot([x.abs(), y.abs(), z.abs()], *half);
            dot([x, y, z], from).abs() > reach + rounding
        };
        !is_beside(self.across[0]) && !is_beside(self.across[1])
    }

    fn at(&self, distance: f64, axis: usize) -> f64 {
        self.from[axis] + distance * self.along[axis]
    }

    /// The distance to a triangle; `None` if the ray does not meet it. It may be negative.
    fn triangle(&self, corners: [Vec3; 3]) -> Option<f64> {
        // the corners in the plane orthogonal to the ray
        let planar = |corner: Vec3| {
            let corner = sub(corner, self.from);
            [dot(self.across[0], corner), dot(self.across[1], corner)]
        };
        let [p, q, r] = [planar(corners[0]), planar(corners[1]), planar(corners[2])];
        let beside = |k: usize| {
            p[k] > 0.0 && q[k] > 0.0 && r[k] > 0.0 || p[k] < 0.0 && q[k] < 0.0 && r[k] < 0.0
        };
        if beside(0) || beside(1) {
            return None;
        }
        let [a, b, c, d] = [p[0] - r[0], q[0] - r[0], p[1] - r[1], q[1] - r[1]];
        let (x, y) = (-r[0], -r[1]);
        let det = a * d - b * c;
        if det.abs() < MINVAL {
            return None;
        }
        let (first, second) = ((d * x - b * y) / det, (-c * x + a * y) / det);
        if first < 0.0 || second < 0.0 || first + second > 1.0 {
            return None;
        }
        let [p, q, r] = corners;
        let normal = cross(sub(p, r), sub(q, r));
        let slope = dot(self.along, normal);
        (slope.abs() >= MINVAL).then(|| -dot(sub(self.from, r), normal) / slope)
    }
}

/// Keeps the smaller distance that is not negative, and returns whether it is the new one; a negative
/// `found` means none yet.
fn keep(found: &mut f64, distance: Option<f64>) -> bool {
    match distance {
        Some(distance) if distance >= 0.0 && (*found < 0.0 || distance < *found) => {
            *found = distance;
            true
        }
        _ => false,
    }
}

/// Calls `each` with the numbers of a range, in their order, except for parts that `meets` refuses.
fn search(
    range: Range<usize>,
    meets: &impl Fn(&Range<usize>) -> bool,
    each: &mut impl FnMut(usize),
) {
    if range.is_empty() || !meets(&range) {
        return;
    }
    if range.len() == 1 {
        return each(range.start);
    }
    let middle = range.start.midpoint(range.end);
    search(range.start..middle, meets, each);
    search(middle..range.end, meets, each);
}

/// The normal of a triangle, of length 1.
fn upright([p, q, r]: [Vec3; 3]) -> Vec3 {
    normalize(cross(sub(p, r), sub(q, r))).0
}

/// The normal of a mesh or height field where a ray meets it; zero if it does not.
pub(in crate::physics) fn normal(
    m: &Model,
    g: usize,
    place: (Vec3, &Mat3),
    point: Vec3,
    along: Vec3,
) -> Vec3 {
    let local = match m.geom_type[g] {
        GeomType::Mesh => {
            let mut met = None;
            let distance = mesh(m, g, place, point, along, &mut |corners| {
                met = Some(corners);
            });
            met.filter(|_| distance >= 0.0).map(upright)
        }
        _ => {
            let mut met = None;
            let distance = hfield(m, g, place, point, along, &mut |part| met = Some(part));
            met.filter(|_| distance >= 0.0).map(|part| match part {
                Part::Base(side, alone) => {
                    let mut normal = [0.0; 3];
                    normal[side / 2] = if side % 2 == 0 { -1.0 } else { 1.0 };
                    if alone {
                        normal
                    } else {
                        // as MuJoCo, which turns it to the world and back
                        rotate_back(place.1, rotate(place.1, normal))
                    }
                }
                Part::Triangle(corners) => upright(corners),
                Part::Side(side) => {
                    let mut normal = [0.0; 3];
                    normal[side / 2] = if side % 2 == 0 { -1.0 } else { 1.0 };
                    normal
                }
            })
        }
    };
    local.map_or([0.0; 3], |normal| rotate(place.1, normal))
}

/// A part of a height field.
pub(super) enum Part {
    /// A side of the box around the base, and whether the ray does not reach the box of the surface.
    Base(usize, bool),
    Triangle([Vec3; 3]),
    /// A side between the base and the surface.
    Side(usize),
}

/// The distance at which a ray meets the triangles of a mesh; -1 for none: MuJoCo's `mj_rayMesh`.
/// `nearer` takes the corners of each triangle that is nearer than those before.
#[inline]
pub(super) fn mesh(
    m: &Model,
    g: usize,
    place: (Vec3, &Mat3),
    point: Vec3,
    along: Vec3,
    nearer: &mut impl FnMut([Vec3; 3]),
) -> f64 {
    let Ok(mesh) = usize::try_from(m.geom_dataid[g]) else {
        return -1.0;
    };
    let ray = Local::new(place, point, along);
    let size = m.geom_size[g];
    let square = dot(size, size);
    if !near(place.0, square, point, along) || cuboid(size, (ray.from, ray.along)) < 0.0 {
        return -1.0;
    }
    let (all, first) = (&*m.meshes, m.meshes.mesh_vertadr[mesh]);
    let start = all.mesh_faceadr[mesh];
    let corner = |number: u32| all.mesh_vert[first + number as usize].map(f64::from);
    let mut found = -1.0;
    let triangles = m.meshes.triangles(mesh);
    triangles.visit(
        |bounds| ray.meets(bounds),
        |number| {
            let triangle = all.mesh_face[start + number].map(corner);
            if keep(&mut found, ray.triangle(triangle)) {
                nearer(triangle);
            }
        },
    );
    found
}

/// The distance at which a ray meets a height field: its base, its surface or its sides; -1 for
/// none: MuJoCo's `mj_rayHfield`. `nearer` takes each part that is nearer than those before.
#[inline]
pub(super) fn hfield(
    m: &Model,
    g: usize,
    place: (Vec3, &Mat3),
    point: Vec3,
    along: Vec3,
    nearer: &mut impl FnMut(Part),
) -> f64 {
    let Ok(id) = usize::try_from(m.geom_dataid[g]) else {
        return -1.0;
    };
    let all = &*m.hfields;
    let [x, y, height, base] = all.hfield_size[id];
    let (rows, columns) = (all.hfield_nrow[id], all.hfield_ncol[id]);
    let data = &all.hfield_data[all.hfield_adr[id]..][..rows * columns];
    let (pos, mat) = place;
    let up = column(mat, 2);
    // the faces of a box around the base or the surface
    let meet = |shift: f64, size: Vec3| {
        let centre = std::array::from_fn(|k| pos[k] + up[k] * shift * 0.5);
        let local = (
            rotate_back(mat, sub(point, centre)),
            rotate_back(mat, along),
        );
        let square = dot(size, size);
        if near(centre, square, point, along) {
            faces(size, local)
        } else {
            [-1.0; 6]
        }
    };
    let least = |faces: [f64; 6]| {
        let mut found = -1.0;
        for face in faces {
            keep(&mut found, Some(face));
        }
        found
    };
    let bottom = meet(-base, [x, y, base * 0.5]);
    let mut found = least(bottom);
    let top = meet(height, [x, y, height * 0.5]);
    let first = least(top);
    if found >= 0.0 {
        let side = bottom.iter().position(|face| *face == found);
        nearer(Part::Base(side.unwrap_or(0), first < 0.0));
    }
    if first < 0.0 || rows < 2 || columns < 2 {
        return found;
    }
    let ray = Local::new(place, point, along);
    let mut segment = [0.0, first];
    for face in top {
        if face > segment[1] {
            segment = [first, face];
        }
    }
    let dx = 2.0 * x / (columns as f64 - 1.0);
    let dy = 2.0 * y / (rows as f64 - 1.0);
    let cells = |axis: usize, half: f64, step: f64, count: usize| {
        let ends = segment.map(|distance| (ray.at(distance, axis) + half) / step);
        let low = f64::min(ends[0], ends[1]).floor() - 1.0;
        let high = f64::max(ends[0], ends[1]).ceil() + 1.0;
        low.max(0.0) as usize..(high.max(0.0) as usize).min(count - 1)
    };
    let corner = |row: usize, column: usize| {
        [
            dx * column as f64 - x,
            dy * row as f64 - y,
            f64::from(data[row * columns + column]) * height,
        ]
    };
    for row in cells(1, y, dy, rows) {
        let all = cells(0, x, dx, columns);
        // a range of cells has one point more
        let points = |row: usize| data[row * columns..].get(all.start..=all.end);
        let heights = [row, row + 1].into_iter().filter_map(points);
        let heights = heights.flatten().copied();
        let lowest = f64::from(heights.clone().fold(f32::INFINITY, f32::min)) * height;
        let highest = f64::from(heights.fold(f32::NEG_INFINITY, f32::max)) * height;
        let meets = |part: &Range<usize>| {
            let low = [dx * part.start as f64 - x, dy * row as f64 - y, lowest];
            let high = [dx * part.end as f64 - x, dy * (row + 1) as f64 - y, highest];
            ray.meets(&[scale(add(low, high), 0.5), scale(sub(high, low), 0.5)])
        };
        search(all, &meets, &mut |column| {
            let [near, far] = [corner(row, column), corner(row + 1, column + 1)];
            let right = corner(row, column + 1);
            for triangle in [[near, right, far], [near, far, corner(row + 1, column)]] {
                if keep(&mut found, ray.triangle(triangle)) {
                    nearer(Part::Triangle(triangle));
                }
            }
        });
    }
    for (side, distance) in top[..4].iter().copied().enumerate() {
        if distance < 0.0 || (found >= 0.0 && distance >= found) {
            continue;
        }
        // the height of the border, between two points of the grid
        let (axis, half, step, count) = if side < 2 {
            (1, y, dy, rows)
        } else {
            (0, x, dx, columns)
        };
        let place = (ray.at(distance, axis) + half) / step;
        let before = place.floor().min(count as f64 - 2.0).max(0.0);
        let border = |k: usize| {
            let number = before as usize + k;
            f64::from(match side {
                0 => data[number * columns],
                1 => data[number * columns + columns - 1],
                2 => data[number],
                _ => data[(rows - 1) * columns + number],
            })
        };
        let edge = border(0) * (before + 1.0 - place) + border(1) * (place - before);
        if ray.at(distance, 2) / height < edge {
            found = distance;
            nearer(Part::Side(side));
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use gym_numerics::RandomState;

    use super::*;
    use crate::math::spatial::IDENTITY;

    /// The boxes around triangles leave out none that a ray meets, and most others.
    #[test]
    fn few_triangles_are_compared_and_none_is_missed() {
        let mut random = RandomState::new(0);
        let (mut vertices, mut faces) = (String::new(), String::new());
        for k in 0..1500 {
            // slivers, small and large triangles around a centre
            let size = [1e-6, 0.01, 0.1, 1.0][k % 4];
            let centre: Vec3 = std::array::from_fn(|_| random.uniform(-1.0, 1.0));
            for corner in 0..3 {
                let scale = if k % 3 == 0 && corner == 2 {
                    1e-9
                } else {
                    size
                };
                let at = centre.map(|x| x + scale * random.uniform(-1.0, 1.0));
                vertices += &format!("{} {} {} ", at[0], at[1], at[2]);
                faces += &format!("{} ", 3 * k + corner);
            }
        }
        let text = format!(
            r#"<mujoco><asset><mesh name="m" inertia="shell" vertex="{vertices}" face="{faces}"/></asset>
            <worldbody><geom type="mesh" mesh="m" contype="0" conaffinity="0"/></worldbody></mujoco>"#
        );
        let m = Model::from_xml(&text).unwrap();
        let all = &*m.meshes;
        let corner = |number: u32| all.mesh_vert[number as usize].map(f64::from);
        let (mut hits, mut compared) = (0, 0);
        for i in 0..2000 {
            let from: Vec3 = std::array::from_fn(|_| random.uniform(-2.0, 2.0));
            let mut along: Vec3 = std::array::from_fn(|_| random.uniform(-1.0, 1.0));
            match i % 4 {
                0 => along[i / 4 % 3] = 0.0,
                // to a corner
                1 => along = sub(corner(i as u32), from),
                _ => {}
            }
            let ray = Local::new(([0.0; 3], &IDENTITY), from, along);
            let mut expected = -1.0;
            for face in &all.mesh_face {
                keep(&mut expected, ray.triangle(face.map(corner)));
            }
            let mut found = -1.0;
            m.meshes.triangles(0).visit(
                |bounds| ray.meets(bounds),
                |number| {
                    compared += 1;
                    keep(&mut found, ray.triangle(all.mesh_face[number].map(corner)));
                },
            );
            assert_eq!(found.to_bits(), expected.to_bits(), "ray {i}");
            hits += usize::from(found >= 0.0);
        }
        assert!(hits > 500, "{hits}");
        let share = f64::from(compared) / (2000.0 * all.mesh_face.len() as f64);
        assert!(share < 0.3, "{share}");
    }

    /// The parts of a height field that are left out have no triangle that a ray meets.
    #[test]
    fn few_cells_are_compared_and_none_is_missed() {
        let mut random = RandomState::new(1);
        let heights: Vec<_> = (0..23 * 31)
            .map(|_| random.uniform(0.0, 1.0).to_string())
            .collect();
        let text = format!(
            r#"<mujoco><asset><hfield name="h" nrow="23" ncol="31" size="1 0.7 0.5 0.2" elevation="{}"/></asset>
            <worldbody><geom type="hfield" hfield="h"/></worldbody></mujoco>"#,
            heights.join(" ")
        );
        let m = Model::from_xml(&text).unwrap();
        let corner = |row: usize, column: usize| {
            let height = m.hfields.hfield_data[row * 31 + column];
            let (dx, dy) = (2.0 / 30.0, 2.0 * 0.7 / 22.0);
            [
                dx * column as f64 - 1.0,
                dy * row as f64 - 0.7,
                f64::from(height) * 0.5,
            ]
        };
        let mut hits = 0;
        for i in 0..5000 {
            let mut from: Vec3 = std::array::from_fn(|_| random.uniform(-1.0, 1.0));
            let mut along: Vec3 = std::array::from_fn(|_| random.uniform(-1.0, 1.0));
            match i % 4 {
                0 => along[i / 4 % 3] = 0.0,
                // to a corner, and along the grid
                1 => along = sub(corner(i % 23, i % 31), from),
                2 => (from[1], along) = (corner(i % 23, 0)[1], [1.0, 0.0, along[2] * 0.1]),
                _ => {}
            }
            let ray = Local::new(([0.0; 3], &IDENTITY), from, along);
            let mut expected = -1.0;
            for (row, column) in (0..22).flat_map(|row| (0..30).map(move |column| (row, column))) {
                let [near, far] = [corner(row, column), corner(row + 1, column + 1)];
                let (right, left) = (corner(row, column + 1), corner(row + 1, column));
                keep(&mut expected, ray.triangle([near, right, far]));
                keep(&mut expected, ray.triangle([near, far, left]));
            }
            let found = hfield(&m, 0, ([0.0; 3], &IDENTITY), from, along, &mut |_| {});
            // (the base and the sides are no triangles)
            let at = |axis: usize| ray.at(found, axis);
            let is_below = at(2) < 1e-9
                || (at(0).abs() - 1.0).abs() < 1e-9
                || (at(1).abs() - 0.7).abs() < 1e-9;
            if expected < 0.0 || found < expected && is_below {
                assert!(found < 0.0 || is_below, "ray {i}");
                continue;
            }
            assert!(
                (found - expected).abs() < 1e-12,
                "ray {i}: {found}, {expected}"
            );
            hits += 1;
        }
        assert!(hits > 1000, "{hits}");
    }
}
