//! Meshes that need no file. Formulas, orders and roundings are those of MuJoCo 3.12 (`user_mesh.cc`,
//! Apache-2.0).

use std::collections::BTreeMap;
use std::f64::consts::PI;

use super::Source;
use crate::math::libm::{pow, sin_cos};

/// A shape that `builtin` names, with its `params`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Builtin {
    /// An icosahedron, each of whose triangles is cut into four so many times: 0 to 4.
    Sphere(u32),
    /// Half an octahedron with so many more rows, 0 to 10, on the sphere, and its base.
    Hemisphere(u32),
    /// Rings and vertices of each, at least 3; the exponents around z and along it.
    Supersphere(u32, [f64; 2]),
    /// Circles and vertices of each, at least 3; the tube's radius; the exponents around the tube and
    /// around z.
    Supertorus(u32, f64, [f64; 2]),
    /// The edges of the base, and the top's radius, which may be 0.
    Cone(u32, f64),
}

impl Builtin {
    /// The largest number of rings, circles or edges.
    pub(crate) const MOST: u32 = 1000;

    /// The shape of a name and its parameters.
    ///
    /// # Errors
    ///
    /// What the parameters must be.
    pub(crate) fn of(name: &str, params: &[f64]) -> Result<Self, &'static str> {
        let count = |x: f64, least: u32, most: u32| {
            let whole = x.trunc();
            let fits = whole >= f64::from(least) && whole <= f64::from(most);
            fits.then_some(whole as u32)
        };
        let round = |x: f64| count(x, 3, Self::MOST);
        let shape = match (name, params) {
            ("sphere", &[cuts]) => count(cuts, 0, 4).map(Self::Sphere),
            ("hemisphere", &[rows]) => count(rows, 0, 10).map(Self::Hemisphere),
            ("supersphere", &[rings, e, n]) if e >= 0.0 && n >= 0.0 => {
                round(rings).map(|rings| Self::Supersphere(rings, [e, n]))
            }
            ("supertorus", &[circles, radius, s, t])
                if radius > 0.0 && radius <= 1.0 && s > 0.0 && t > 0.0 =>
            {
                round(circles).map(|circles| Self::Supertorus(circles, radius, [s, t]))
            }
            ("cone", &[edges, radius]) => round(edges).map(|edges| Self::Cone(edges, radius)),
            _ => None,
        };
        shape.ok_or(match name {
            "sphere" => "must be one number: 0 to 4 subdivisions",
            "hemisphere" => "must be one number: 0 to 10 rows",
            "supersphere" => "must be a resolution of 3 to 1000 and two exponents, at least 0",
            "supertorus" => {
                "must be a resolution of 3 to 1000, a radius from 0 to 1, and two exponents above 0"
            }
            _ => "must be 3 to 1000 edges and a radius",
        })
    }

    /// How many vertices it has at most.
    pub(crate) fn vertices(self) -> u64 {
        match self {
            Self::Sphere(cuts) => 12 << (2 * cuts),
            Self::Hemisphere(rows) => 2 + 2 * u64::from(rows + 1) * u64::from(rows + 2),
            Self::Supersphere(n, _) | Self::Supertorus(n, ..) => u64::from(n) * u64::from(n) + 2,
            Self::Cone(edges, _) => 2 * u64::from(edges),
        }
    }

    /// The vertices and faces.
    #[must_use]
    pub fn source(self) -> Source {
        let (vertices, faces) = match self {
            Self::Sphere(cuts) => sphere(cuts),
            Self::Hemisphere(rows) => hemisphere(rows),
            Self::Supersphere(rings, exponents) => supersphere(rings, exponents),
            Self::Supertorus(circles, radius, exponents) => supertorus(circles, radius, exponents),
            Self::Cone(edges, radius) => (cone(edges, radius), Vec::new()),
        };
        Source {
            vertices,
            faces: faces.as_flattened().to_vec(),
            ..Source::default()
        }
    }
}

type Lists = (Vec<f32>, Vec<[i32; 3]>);

/// Sine and cosine, each with the exponent of its magnitude.
fn power(angle: f64, exponent: f64) -> [f64; 2] {
    let (sin, cos) = sin_cos(angle);
    [sin, cos].map(|x| pow(x.abs(), exponent).copysign(x))
}

fn sphere(cuts: u32) -> Lists {
    const FACES: [[i32; 3]; 20] = [
        [0, 11, 5],
        [0, 5, 1],
        [0, 1, 7],
        [0, 7, 10],
        [0, 10, 11],
        [1, 5, 9],
        [5, 11, 4],
        [11, 10, 2],
        [10, 7, 6],
        [7, 1, 8],
        [3, 9, 4],
        [3, 4, 2],
        [3, 2, 6],
        [3, 6, 8],
        [3, 8, 9],
        [4, 9, 5],
        [2, 4, 11],
        [6, 2, 10],
        [8, 6, 7],
        [9, 8, 1],
    ];
    let phi = f64::midpoint(1.0, 5f64.sqrt()) as f32;
    let norm = (1.0 + f64::from(phi * phi)).sqrt();
    let [one, phi] = [1.0, phi].map(|x| (f64::from(x) / norm) as f32);
    let mut vertices = Vec::new();
    // golden rectangles in the planes xy, yz and zx
    for plane in 0..3 {
        for (short, long) in [(-one, phi), (one, phi), (-one, -phi), (one, -phi)] {
            let mut vertex = [0.0; 3];
            (vertex[plane], vertex[(plane + 1) % 3]) = (short, long);
            vertices.extend(vertex);
        }
    }
    let mut faces = FACES.to_vec();
    for _ in 0..cuts {
        let mut middles = BTreeMap::new();
        let mut middle = |a: i32, b: i32| {
            *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                let at = |v: i32, k: usize| vertices[3 * v as usize + k];
                let [x, y, z] = [0, 1, 2].map(|k| (at(a, k) + at(b, k)) / 2.0f32);
                let length = (x * x + y * y + z * z).sqrt();
                vertices.extend([x, y, z].map(|x| x / length));
                (vertices.len() / 3 - 1) as i32
            })
        };
        let cut = |[a, b, c]: [i32; 3]| {
            let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
            [[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]
        };
        faces = faces.into_iter().flat_map(cut).collect();
    }
    (vertices, faces)
}

fn hemisphere(rows: u32) -> Lists {
    const EQUATOR: [[f64; 2]; 4] = [[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]];
    let rows = rows as i32;
    let mut vertices: Vec<f32> = vec![0.0, 0.0, 1.0];
    for row in 0..=rows {
        let factor = f64::from(row + 1) / f64::from(rows + 1);
        for side in 0..4 {
            // from the pole towards two points of the equator
            let towards = |[x, y]: [f64; 2]| {
                let pole = [0.0, 0.0, 1.0];
                let end = [x, y, 0.0];
                [0, 1, 2].map(|k| pole[k] + factor * (end[k] - pole[k]))
            };
            let (start, end) = (towards(EQUATOR[side]), towards(EQUATOR[(side + 1) % 4]));
            for i in 0..=row {
                let [x, y, z] = [0, 1, 2].map(|k| {
                    let step = (end[k] - start[k]) / f64::from(row + 1);
                    start[k] + f64::from(i) * step
                });
                let norm = (x * x + y * y + z * z).sqrt();
                vertices.extend([x, y, z].map(|x| (x / norm) as f32));
            }
        }
    }
    // the centre of the base
    let centre = (vertices.len() / 3) as i32;
    vertices.extend([0.0; 3]);
    let mut faces = vec![[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 1]];
    for row in 0..rows {
        let (here, count) = (2 * row * (row + 1) + 1, 4 * (row + 1));
        let (next, next_count) = (here + count, 4 * (row + 2));
        for side in 0..4 {
            for i in 0..row + 2 {
                let (v, w) = (i + (row + 1) * side, i + (row + 2) * side);
                let below = next + (w + 1) % next_count;
                faces.push([here + v % count, next + w % next_count, below]);
                if i < row + 1 {
                    faces.push([here + v % count, below, here + (v + 1) % count]);
                }
            }
        }
    }
    let (start, count) = (2 * rows * (rows + 1) + 1, 4 * (rows + 1));
    faces.extend((0..count).map(|i| [start + i, centre, start + (i + 1) % count]));
    (vertices, faces)
}

fn supersphere(rings: u32, [e, n]: [f64; 2]) -> Lists {
    let (size, count) = (f64::from(rings), rings as i32);
    let mut vertices: Vec<f32> = vec![0.0, 0.0, -1.0];
    for i in 1..count {
        let [z, along] = power(-PI / 2.0 + f64::from(i) * PI / size, n);
        for j in 0..count {
            let [y, x] = power(-PI + f64::from(j * 2) * PI / size, e);
            vertices.extend([along * x, along * y, z].map(|x| x as f32));
        }
    }
    vertices.extend([0.0, 0.0, 1.0]);
    let next = |j: i32| (j + 1) % count;
    let mut faces: Vec<_> = (0..count).map(|j| [0, 1 + next(j), 1 + j]).collect();
    for i in 0..count - 2 {
        let (here, above) = (1 + i * count, 1 + (i + 1) * count);
        for j in 0..count {
            faces.push([here + j, here + next(j), above + j]);
            faces.push([here + next(j), above + next(j), above + j]);
        }
    }
    let (last, pole) = (1 + (count - 2) * count, (count - 1) * count + 1);
    faces.extend((0..count).map(|j| [last + j, last + next(j), pole]));
    (vertices, faces)
}

fn supertorus(circles: u32, radius: f64, [s, t]: [f64; 2]) -> Lists {
    let (size, count) = (f64::from(circles), circles as i32);
    let (mut vertices, mut faces) = (Vec::new(), Vec::new());
    let angle = |i: i32| 2.0 * PI * f64::from(i) / size;
    for i in 0..count {
        let [y, x] = power(angle(i), t);
        for j in 0..count {
            let [z, out] = power(angle(j), s);
            let out = 1.0 + radius * out;
            vertices.extend([out * x, out * y, radius * z].map(|x| x as f32));
        }
    }
    for i in 0..count {
        let (here, next) = (i * count, (i + 1) % count * count);
        for j in 0..count {
            let after = (j + 1) % count;
            faces.push([here + j, next + j, here + after]);
            faces.push([next + j, next + after, here + after]);
        }
    }
    (vertices, faces)
}

fn cone(edges: u32, radius: f64) -> Vec<f32> {
    let (size, count) = (f64::from(edges), edges as i32);
    let point = |i: i32| sin_cos(f64::from(2 * i) * PI / size);
    let mut vertices = Vec::new();
    for i in 0..count {
        let (sin, cos) = point(i);
        vertices.extend([cos as f32, sin as f32, -1.0]);
    }
    if radius > 0.0 {
        for i in count..2 * count {
            let (sin, cos) = point(i);
            vertices.extend([(radius * cos) as f32, (radius * sin) as f32, 1.0]);
        }
    } else {
        vertices.extend([0.0, 0.0, 1.0]);
    }
    vertices
}
