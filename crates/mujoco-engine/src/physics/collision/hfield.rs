//! Contacts of height fields: MuJoCo's `mjc_ConvexHField`. Each cell of the grid is two prisms below
//! the surface. A shape touches each prism at one point at most.

use super::convex::{Solid, one};
use super::epa::Polytope;
use super::gjk::Rules;
use super::{Push, Shape};
use crate::math::spatial::{Mat3, Vec3, add, dot, rotate, rotate_back, sub};
use crate::model::{CompiledModel, GeomType};

/// The most contacts of two geoms: MuJoCo's `mjMAXCONPAIR`.
const MOST: usize = 50;

/// A height field: the elevations of a grid, as parts of the height `size[2]`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Field<'a> {
    /// The half sizes along x and y, the greatest height, and the depth of the base.
    size: &'a [f64; 4],
    rows: usize,
    columns: usize,
    elevations: &'a [f32],
}

impl<'a> Field<'a> {
    /// The height field of a geom; `None` for other shapes.
    pub(super) fn of(m: &'a CompiledModel, geom: usize) -> Option<Self> {
        if m.geom_type[geom] != GeomType::Hfield {
            return None;
        }
        let id = usize::try_from(m.geom_dataid[geom]).ok()?;
        let fields = &*m.hfields;
        let (rows, columns) = (fields.hfield_nrow[id], fields.hfield_ncol[id]);
        let start = fields.hfield_adr[id];
        Some(Self {
            size: &fields.hfield_size[id],
            rows,
            columns,
            elevations: &fields.hfield_data[start..start + rows * columns],
        })
    }
}

/// The corners of a prism: three below, three above.
type Prism = [Vec3; 6];

/// The contacts of a height field and a convex shape with the bounding radius `radius`.
pub(super) fn contacts(
    field: Field<'_>,
    frame: Shape<'_>,
    other: Solid<'_>,
    (radius, margin): (f64, f64),
    rules: Rules,
    polytope: &mut Polytope,
    push: Push<'_>,
) {
    let &[x, y, height, base] = field.size;
    let pos = rotate_back(frame.mat, sub(other.shape.pos, frame.pos));
    let reach = radius + margin;
    let beyond = |k: usize, low: f64, high: f64| high < pos[k] - reach || low > pos[k] + reach;
    if beyond(0, -x, x) || beyond(1, -y, y) || beyond(2, -base, height) {
        return;
    }
    let mat = transposed_product(frame.mat, other.shape.mat);
    let other = other.at(pos, &mat);
    // in this order, because the search for a mesh's vertex begins at the last one
    let ends: [[f64; 2]; 3] = std::array::from_fn(|axis| {
        [1.0, -1.0].map(|sign| {
            let mut direction = [0.0; 3];
            direction[axis] = sign;
            other.support(direction).0[axis]
        })
    });
    let apart = |axis: usize, low: f64, high: f64| {
        let [most, least] = ends[axis];
        least - margin > high || most + margin < low
    };
    if apart(0, -x, x) || apart(1, -y, y) || apart(2, -base, height) {
        return;
    }
    // before 4.0, the margin raises the surface, half of it grows the shape, and prisms beside the
    // shape are not within it
    let (raised, around, grown) = if rules.revision.treats_prisms_as_shapes() {
        (0.0, margin, [0.5 * margin; 2])
    } else {
        (margin, 0.0, [0.0, 0.5 * margin])
    };
    let cells = |[most, least]: [f64; 2], half: f64, number: usize| {
        let (most, least) = (most + around, least - around);
        let place = |end: f64| (end + half) / (2.0 * half) * (number as f64 - 1.0);
        let (first, last) = (place(least).floor(), place(most).ceil());
        (first as usize, (last as usize).min(number - 1))
    };
    let (left, right) = cells(ends[0], x, field.columns);
    let (front, back) = cells(ends[1], y, field.rows);
    let dx = 2.0 * x / (field.columns as f64 - 1.0);
    let dy = 2.0 * y / (field.rows as f64 - 1.0);
    let mut prism: Prism = [[0.0, 0.0, -base]; 6];
    let mut count = 0;
    for row in front..back {
        for column in left..=right {
            for ahead in [1, 0] {
                let elevation = field.elevations[(row + ahead) * field.columns + column];
                let top = f64::from(elevation) * height + raised;
                for [first, second, last] in [[0, 1, 2], [3, 4, 5]] {
                    (prism[first], prism[second]) = (prism[second], prism[last]);
                }
                let place = [dx * column as f64 - x, dy * (row + ahead) as f64 - y];
                prism[2] = [place[0], place[1], -base];
                prism[5] = [place[0], place[1], top];
                let low = prism[3..]
                    .iter()
                    .all(|corner| corner[2] < ends[2][1] - around);
                if column == left || low {
                    continue;
                }
                let solid = Solid {
                    kind: GeomType::Hfield,
                    shape: frame,
                    mesh: None,
                    prism: Some(&prism),
                };
                let touch = one(solid, other, grown, rules, polytope);
                if let Some(touch) = touch {
                    let mut hit = touch.hit(around);
                    hit.normal = rotate(frame.mat, hit.normal);
                    hit.pos = add(rotate(frame.mat, hit.pos), frame.pos);
                    push(hit);
                    count += 1;
                    if count == MOST {
                        return;
                    }
                }
            }
        }
    }
}

/// `a' b`.
fn transposed_product(a: &Mat3, b: &Mat3) -> Mat3 {
    std::array::from_fn(|k| {
        let (i, j) = (k / 3, k % 3);
        a[i] * b[j] + a[3 + i] * b[3 + j] + a[6 + i] * b[6 + j]
    })
}

/// The middle of a prism, where a search begins.
pub(super) fn centre(prism: &Prism) -> Vec3 {
    let sum = prism.iter().fold([0.0; 3], |sum, corner| add(sum, *corner));
    sum.map(|x| x * (1.0 / 6.0))
}

/// The corner of a prism that is furthest in a direction. It has no number.
pub(super) fn support(prism: &Prism, direction: Vec3) -> Vec3 {
    let start = if direction[2] < 0.0 { 0 } else { 3 };
    let along = |corner: &Vec3| dot(*corner, direction);
    let mut best = prism[start];
    for corner in &prism[start + 1..start + 3] {
        if along(corner) > along(&best) {
            best = *corner;
        }
    }
    best
}
