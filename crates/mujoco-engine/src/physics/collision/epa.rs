//! The depth of the overlap of two convex sets, by the expanding polytope algorithm. A polytope
//! inside the Minkowski difference is expanded at its face nearest to the origin, until that face
//! is on the surface of the difference.
//!
//! It repeats MuJoCo's `engine_collision_gjk` operation by operation, down to the order of the list
//! of faces, which decides between faces that are equally near.

use super::features::Features;
use super::gjk::{Found, LEAST, Rules, Vertex, project, weights_at};
use crate::Revision;
use crate::math::spatial::{MINVAL, Mat3, Vec3, add, cross, dot, norm, rotate, scale, sub};
use crate::model::Polygons;

/// MuJoCo's bound of the iterations, whatever `ccd_iterations` says.
const MOST: usize = 1000;

/// The iterations for which there is always room.
const ROOM: usize = 35;

/// The most faces, for each iteration.
const FACES: usize = 6;

/// A polytope that contains the origin.
#[derive(Clone, Debug, Default)]
pub(crate) struct Polytope {
    revision: Revision,
    tolerance: f64,
    iterations: usize,
    /// Whether both sets have finitely many support points.
    discrete: bool,
    vertices: Vec<Vertex>,
    faces: Vec<Face>,
    center: Vec3,
    /// Candidates for the nearest face.
    candidates: Vec<usize>,
    /// The horizon: faces that stay, each with the edge that it shares with a removed face.
    horizon: Vec<(usize, usize)>,
    pub(super) features: Features,
}

#[cfg(test)]
impl Polytope {
    pub(crate) fn poison(&mut self) {
        use crate::physics::work::Poison;
        self.center.poison();
        self.features.polygons.poison();
    }
}

#[derive(Clone, Debug)]
struct Face {
    corners: [usize; 3],
    /// For each edge, from a corner to the next: the face on the other side.
    beyond: [usize; 3],
    /// The projection of the origin on the face, and the square of its distance.
    nearest: Vec3,
    square: f64,
    place: Standing,
}

/// The overlap of two sets.
pub(super) struct Overlap {
    /// The deepest point of each set in the other.
    pub(super) nearest: [Vec3; 2],
    /// The penetration depth.
    pub(super) depth: f64,
    /// The corners of the face of the difference that is nearest to the origin.
    pub(super) corners: [Vertex; 3],
}

/// Whether a face is a candidate for the nearest face, with the index in the list of candidates.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Standing {
    Candidate(usize),
    Aside,
    Removed,
}

impl Polytope {
    /// Allocates a polytope that never needs to grow; an empty one if no pair uses it.
    pub(crate) fn new(sizes: Option<Polygons>) -> Self {
        let Some(sizes) = sizes else {
            return Self::default();
        };
        let iterations = sizes.iterations.clamp(ROOM, MOST);
        let faces = FACES * iterations;
        Self {
            vertices: Vec::with_capacity(iterations + 5),
            faces: Vec::with_capacity(faces),
            candidates: Vec::with_capacity(faces),
            horizon: Vec::with_capacity(faces),
            features: Features::new(sizes.corners, sizes.degree),
            ..Self::default()
        }
    }

    /// The overlap of two sets; `None` if they do not overlap, or the algorithm fails.
    pub(super) fn overlap(
        &mut self,
        found: &Found,
        (rules, discrete): (Rules, bool),
        support: &impl Fn(Vec3) -> Vertex,
    ) -> Option<Overlap> {
        let revision = rules.revision;
        (self.revision, self.discrete) = (revision, discrete);
        (self.tolerance, self.iterations) = (rules.tolerance, rules.iterations);
        self.vertices.clear();
        self.clear_faces();
        let s = &found.simplex;
        match found.number {
            2 => self.start_from_line([s[0], s[1]], support)?,
            3 => self.start_from_triangle([s[0], s[1], s[2]], support)?,
            4 => self.start_from_tetrahedron(s, support)?,
            _ => return None,
        }
        self.candidates.extend(0..self.faces.len());
        for (i, face) in self.faces.iter_mut().enumerate() {
            face.place = Standing::Candidate(i);
        }
        let nearest = self.expand(support)?;
        let face = &self.faces[nearest];
        let corners = face.corners.map(|v| self.vertices[v]);
        let (weights, _) = weights_at(corners.map(|v| v.x), face.nearest, revision);
        let point = |of: fn(&Vertex) -> Vec3| weighted(corners.map(|v| of(&v)), weights);
        Some(Overlap {
            nearest: [point(|v| v.w1), point(|v| v.w2)],
            depth: face.square.sqrt(),
            corners,
        })
    }

    fn clear_faces(&mut self) {
        self.faces.clear();
        self.candidates.clear();
        self.horizon.clear();
    }

    fn insert(&mut self, vertex: Vertex) -> usize {
        self.vertices.push(vertex);
        self.vertices.len() - 1
    }

    /// Inserts the vertex furthest in `direction`, which has the length `length`.
    fn insert_furthest(
        &mut self,
        direction: Vec3,
        length: f64,
        support: &impl Fn(Vec3) -> Vertex,
    ) -> usize {
        let direction = if length > MINVAL {
            direction.map(|x| x / length)
        } else {
            [1.0, 0.0, 0.0]
        };
        self.insert(support(direction))
    }

    /// Adds a face, and returns the square of its distance from the origin; 0 for a face of zero
    /// area.
    fn attach(&mut self, corners: [usize; 3], beyond: [usize; 3]) -> f64 {
        let [a, b, c] = corners.map(|v| self.vertices[v].x);
        let (nearest, square) = match project(c, b, a, self.revision) {
            None => ([0.0; 3], 0.0),
            Some(nearest) => {
                let inward = dot(nearest, sub(a, self.center)) < 0.0;
                let nearest = if inward {
                    scale(nearest, -1.0)
                } else {
                    nearest
                };
                (nearest, dot(nearest, nearest))
            }
        };
        self.faces.push(Face {
            corners,
            beyond,
            nearest,
            square,
            place: Standing::Aside,
        });
        square
    }

    /// Starts from a line, with two pyramids on a triangle around the line: MuJoCo's `polytope2`.
    fn start_from_line(
        &mut self,
        [a, b]: [Vertex; 2],
        support: &impl Fn(Vec3) -> Vertex,
    ) -> Option<()> {
        let along = sub(b.x, a.x);
        // perpendicular to the line and to the axis along which it is shortest
        let axis = (0..3).fold(0, |best, k| {
            if along[k].abs() < along[best].abs() {
                k
            } else {
                best
            }
        });
        let mut unit = [0.0; 3];
        unit[axis] = 1.0;
        let turn = third_of_a_turn(along);
        let across = cross(unit, along);
        let second = rotate(&turn, across);
        let third = rotate(&turn, second);
        let (v1, v2) = (self.insert(a), self.insert(b));
        let [v3, v4, v5] =
            [across, second, third].map(|d| self.insert_furthest(d, norm(d), support));
        let [x1, x2, x3, x4, x5] = [v1, v2, v3, v4, v5].map(|v| self.vertices[v].x);
        self.center = if self.revision.projects_origin() {
            mean([x1, x2, x3, x4, x5])
        } else {
            scale(add(x1, x2), 0.5)
        };
        for (corners, beyond) in [
            ([v1, v3, v4], [1, 3, 2]),
            ([v1, v5, v3], [2, 4, 0]),
            ([v1, v4, v5], [0, 5, 1]),
            ([v2, v4, v3], [5, 0, 4]),
            ([v2, v3, v5], [3, 1, 5]),
            ([v2, v5, v4], [4, 2, 3]),
        ] {
            if self.attach(corners, beyond) < LEAST {
                return self.restart_from_face(corners, support);
            }
        }
        crosses([x1, x2], [x3, x4, x5]).then_some(())
    }

    fn restart_from_face(
        &mut self,
        corners: [usize; 3],
        support: &impl Fn(Vec3) -> Vertex,
    ) -> Option<()> {
        let triangle = corners.map(|v| self.vertices[v]);
        self.clear_faces();
        self.vertices.clear();
        self.start_from_triangle(triangle, support)
    }

    /// Starts from a triangle, with a pyramid on each side of the triangle: MuJoCo's `polytope3`.
    fn start_from_triangle(
        &mut self,
        t: [Vertex; 3],
        support: &impl Fn(Vec3) -> Vertex,
    ) -> Option<()> {
        let [a, b, c] = t.map(|v| v.x);
        let normal = cross(sub(b, a), sub(c, a));
        let length = norm(normal);
        if length < MINVAL {
            return None;
        }
        let [v1, v2, v3] = t.map(|v| self.insert(v));
        // `v5` is inserted before `v4`
        let v5 = self.insert_furthest(scale(normal, -1.0), length, support);
        let v4 = self.insert_furthest(normal, length, support);
        if [v4, v5]
            .into_iter()
            .any(|v| is_in_triangle([a, b, c], self.vertices[v].x, self.revision))
        {
            return None;
        }
        if self.revision.projects_origin() {
            let height = |v: usize| dot(normal, sub(self.vertices[v].x, a));
            let flat = [height(v4), -height(v5)];
            if flat.iter().any(|height| *height < length * MINVAL) {
                return None;
            }
            self.start_around([v1, v2, v3], [v4, v5])
        } else {
            self.center = scale(add(add(a, b), c), 1.0 / 3.0);
            self.attach_pyramids([v1, v2, v3, v4, v5])
        }
    }

    /// Adds the faces of two pyramids on a triangle, with the apexes `v4` and `v5`.
    fn attach_pyramids(&mut self, [v1, v2, v3, v4, v5]: [usize; 5]) -> Option<()> {
        for (corners, beyond) in [
            ([v4, v1, v2], [1, 3, 2]),
            ([v4, v3, v1], [2, 4, 0]),
            ([v4, v2, v3], [0, 5, 1]),
            ([v5, v2, v1], [5, 0, 4]),
            ([v5, v1, v3], [3, 1, 5]),
            ([v5, v3, v2], [4, 2, 3]),
        ] {
            if self.attach(corners, beyond) < LEAST {
                return None;
            }
        }
        Some(())
    }

    /// Starts from the convex hull of a triangle and a point on each side of the triangle, from 4.0
    /// on. If the line through the points crosses the triangle, the hull is two pyramids on the
    /// triangle. If the line passes beside an edge, the hull is two pyramids on another triangle;
    /// if beside a corner, a tetrahedron.
    fn start_around(&mut self, [v1, v2, v3]: [usize; 3], [v4, v5]: [usize; 2]) -> Option<()> {
        let at = |v: usize| self.vertices[v].x;
        let volumes = volumes_about([at(v4), at(v5)], [v1, v2, v3].map(at));
        let beside = |edge: usize| {
            (0..3).all(|k| match k == edge {
                true => volumes[k] > 0.0,
                false => volumes[k] < -MINVAL,
            })
        };
        let [x, y, z] = volumes;
        let corners = if has_one_sign(&volumes) {
            [v1, v2, v3, v4, v5]
        } else if beside(0) {
            [v3, v5, v4, v1, v2]
        } else if beside(1) {
            [v1, v5, v4, v2, v3]
        } else if beside(2) {
            [v2, v5, v4, v3, v1]
        } else {
            let edge = match () {
                () if y >= x && z >= x => [v1, v2],
                () if x >= y && z >= y => [v2, v3],
                () => [v3, v1],
            };
            let [a, b, c, d] = [edge[0], edge[1], v4, v5];
            if self.attach_tetrahedron([a, b, c, d]).is_some() {
                return None;
            }
            return self.holds_origin(&[d, c, b, a]);
        };
        self.center = mean(corners.map(at));
        self.attach_pyramids(corners)?;
        let [a, b, c, ..] = corners;
        self.holds_origin(&[c, b, a, c, b, a])
    }

    /// Whether the origin is on the inner side of each face. `inner` has, for each face, a vertex
    /// on its inner side.
    fn holds_origin(&self, inner: &[usize]) -> Option<()> {
        let holds = |(face, inner): (&Face, &usize)| {
            let [p, q, r] = face.corners.map(|v| self.vertices[v].x);
            is_on_side_of_fourth([p, q, r, self.vertices[*inner].x])
                || face.square < self.tolerance * self.tolerance
        };
        self.faces.iter().zip(inner).all(holds).then_some(())
    }

    /// Starts from a tetrahedron: MuJoCo's `polytope4`.
    fn start_from_tetrahedron(
        &mut self,
        t: &[Vertex; 4],
        support: &impl Fn(Vec3) -> Vertex,
    ) -> Option<()> {
        let corners = t.map(|v| self.insert(v));
        if let Some(flat) = self.attach_tetrahedron(corners) {
            return self.restart_from_face(flat, support);
        }
        let [a, b, c, d] = t.map(|v| v.x);
        let sides = [[a, b, c, d], [b, c, d, a], [c, d, a, b], [d, a, b, c]];
        sides.into_iter().all(is_on_side_of_fourth).then_some(())
    }

    /// Adds the faces of a tetrahedron. Returns the corners of the first face that contains the
    /// origin.
    fn attach_tetrahedron(&mut self, corners: [usize; 4]) -> Option<[usize; 3]> {
        let [a, b, c, d] = corners.map(|v| self.vertices[v].x);
        self.center = scale(add(add(add(a, b), c), d), 0.25);
        let [v1, v2, v3, v4] = corners;
        let faces = [
            ([v1, v2, v3], [1, 3, 2]),
            ([v1, v4, v2], [2, 3, 0]),
            ([v1, v3, v4], [0, 3, 1]),
            ([v4, v3, v2], [2, 0, 1]),
        ];
        let mut flat = faces
            .into_iter()
            .filter(|(corners, beyond)| self.attach(*corners, *beyond) < LEAST);
        flat.next().map(|(corners, _)| corners)
    }

    /// Expands the polytope until its nearest face is on the surface of the difference: MuJoCo's
    /// `epa`.
    fn expand(&mut self, support: &impl Fn(Vec3) -> Vertex) -> Option<usize> {
        let (mut upper, mut upper_square) = (f64::MAX, f64::MAX);
        let tolerance = if self.discrete {
            MINVAL
        } else {
            self.tolerance
        };
        let mut face = None;
        for iteration in 0..self.iterations.min(MOST) {
            let before = face;
            let mut lower_square = f64::MAX;
            for &candidate in &self.candidates {
                if self.faces[candidate].square < lower_square {
                    (face, lower_square) = (Some(candidate), self.faces[candidate].square);
                }
            }
            let Some(nearest) = face.filter(|_| lower_square <= upper_square) else {
                return before;
            };
            if lower_square <= 0.0 {
                return face;
            }
            let lower = lower_square.sqrt();
            let direction = self.faces[nearest].nearest;
            let vertex = self.insert_furthest(direction, lower, support);
            let w = self.vertices[vertex].x;
            let bound = dot(direction, w) / lower;
            // from 4.0 on, the search ends by the last bound, before 4.0 by the smallest bound
            let (last, slack) = if self.revision.projects_origin() {
                (bound, tolerance)
            } else {
                (f64::min(bound, upper), 1e-10)
            };
            if last - lower < tolerance {
                return face.filter(|_| iteration > 0 || last >= lower - slack);
            }
            // no point of the surface is further
            let corners = self.vertices[vertex].corners;
            let mut before = self.vertices[..vertex].iter();
            if self.discrete && before.any(|known| known.corners == corners) {
                return face;
            }
            if bound < upper {
                (upper, upper_square) = (bound, bound * bound);
            }
            self.find_horizon(nearest, w);
            let edges = self.horizon.len();
            if edges < 3 {
                return None;
            }
            let first = self.faces.len();
            if first + edges > FACES * self.iterations {
                return face;
            }
            for i in 0..edges {
                let (beyond, edge) = self.horizon[i];
                let (v1, v2) = {
                    let face = &mut self.faces[beyond];
                    face.beyond[edge] = first + i;
                    (face.corners[edge], face.corners[(edge + 1) % 3])
                };
                let (last, next) = (first + (i + edges - 1) % edges, first + (i + 1) % edges);
                let square = self.attach([vertex, v2, v1], [last, beyond, next]);
                if square == 0.0 {
                    // from 4.0 on, a failed expansion returns the face that was found before
                    return face.filter(|_| self.revision.projects_origin());
                }
                if square >= lower_square && square <= upper_square {
                    self.faces[first + i].place = Standing::Candidate(self.candidates.len());
                    self.candidates.push(first + i);
                }
            }
            self.horizon.clear();
            if self.candidates.is_empty() {
                return face;
            }
        }
        face
    }

    /// Removes a face; the last candidate takes its place in the list.
    fn remove(&mut self, face: usize) {
        if let Standing::Candidate(place) = self.faces[face].place {
            self.candidates.swap_remove(place);
            if let Some(&moved) = self.candidates.get(place) {
                self.faces[moved].place = Standing::Candidate(place);
            }
        }
        self.faces[face].place = Standing::Removed;
    }

    /// Starting at `face`, removes all faces visible from `w`, and lists the edges to faces that
    /// stay.
    fn find_horizon(&mut self, face: usize, w: Vec3) {
        self.remove(face);
        let (corners, beyond) = (self.faces[face].corners, self.faces[face].beyond);
        for edge in 0..3 {
            let neighbour = beyond[edge];
            if edge == 0 || self.faces[neighbour].place != Standing::Removed {
                self.look_beyond(neighbour, corners[(edge + 1) % 3], w);
            }
        }
    }

    /// Continues [`find_horizon`](Self::find_horizon) at `face`, from the other side of its edge
    /// that starts at `corner`.
    fn look_beyond(&mut self, face: usize, corner: usize, w: Vec3) {
        let (corners, beyond) = (self.faces[face].corners, self.faces[face].beyond);
        let (nearest, square) = (self.faces[face].nearest, self.faces[face].square);
        let entry = corners[..2].iter().position(|c| *c == corner).unwrap_or(2);
        // from 4.0 on, the tolerance is relative to distances above 1
        let least = if self.revision.projects_origin() {
            f64::max(MINVAL * square.sqrt(), MINVAL)
        } else {
            MINVAL
        };
        if dot(nearest, w) - square > least {
            self.remove(face);
            for edge in [(entry + 1) % 3, (entry + 2) % 3] {
                let neighbour = beyond[edge];
                if self.faces[neighbour].place != Standing::Removed {
                    self.look_beyond(neighbour, corners[(edge + 1) % 3], w);
                }
            }
        } else {
            self.horizon.push((face, entry));
        }
    }
}

/// The rotation by 120 degrees about an axis.
fn third_of_a_turn(axis: Vec3) -> Mat3 {
    // libmujoco has this number of digits
    const SIN: f64 = 0.866_025_403_78;
    const COS: f64 = -0.5;
    let length = norm(axis);
    let [x, y, z] = axis.map(|a| a / length);
    [
        COS + x * x * (1.0 - COS),
        x * y * (1.0 - COS) - z * SIN,
        x * z * (1.0 - COS) + y * SIN,
        y * x * (1.0 - COS) + z * SIN,
        COS + y * y * (1.0 - COS),
        y * z * (1.0 - COS) - x * SIN,
        x * z * (1.0 - COS) - y * SIN,
        y * z * (1.0 - COS) + x * SIN,
        COS + z * z * (1.0 - COS),
    ]
}

/// Whether the line through two points crosses a triangle.
fn crosses(line: [Vec3; 2], triangle: [Vec3; 3]) -> bool {
    has_one_sign(&volumes_about(line, triangle))
}

/// The signed volumes that a line spans with each edge of a triangle.
fn volumes_about([a, b]: [Vec3; 2], triangle: [Vec3; 3]) -> [f64; 3] {
    let along = sub(b, a);
    let [p, q, r] = triangle.map(|corner| sub(corner, a));
    [(p, q), (q, r), (r, p)].map(|(p, q)| dot(p, cross(q, along)))
}

fn has_one_sign(numbers: &[f64; 3]) -> bool {
    numbers.iter().all(|x| *x >= 0.0) || numbers.iter().all(|x| *x <= 0.0)
}

/// The mean of five points.
fn weighted([a, b, c]: [Vec3; 3], [wa, wb, wc]: [f64; 3]) -> Vec3 {
    add(add(scale(a, wa), scale(b, wb)), scale(c, wc))
}

fn mean([a, b, c, d, e]: [Vec3; 5]) -> Vec3 {
    scale(add(add(add(add(a, b), c), d), e), 0.2)
}

/// Whether `p` is a point of the triangle, up to rounding.
fn is_in_triangle(corners: [Vec3; 3], p: Vec3, revision: Revision) -> bool {
    let (weights, _) = weights_at(corners, p, revision);
    let nearest = weighted(corners, weights);
    !weights.iter().any(|w| *w < 0.0) && norm(sub(nearest, p)) < MINVAL
}

/// Whether the origin and the fourth point are on the same side of the plane of the first three.
fn is_on_side_of_fourth([a, b, c, d]: [Vec3; 4]) -> bool {
    let normal = cross(sub(b, a), sub(c, a));
    let (fourth, origin) = (dot(normal, sub(d, a)), dot(normal, scale(a, -1.0)));
    (fourth > 0.0 && origin > 0.0) || (fourth < 0.0 && origin < 0.0)
}
