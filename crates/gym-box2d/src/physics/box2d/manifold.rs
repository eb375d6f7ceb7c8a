//! The contact manifold of two shapes: up to two points and a normal.

use serde::{Deserialize, Serialize};

use super::math::{Pose, Vec2, dot, normalize, rotate, transform, vec2};

/// The shape that defines the normal.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) enum Kind {
    /// Two circles: the normal points from centre to centre.
    Circles,
    /// A face of the first shape.
    FaceA,
    /// A face of the second shape.
    FaceB,
}

/// A vertex (or a face) of a shape.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Feature {
    pub(crate) index: u8,
    pub(crate) is_face: bool,
}

impl Feature {
    pub(crate) fn vertex(index: usize) -> Self {
        Self {
            index: index as u8,
            is_face: false,
        }
    }

    pub(crate) fn face(index: usize) -> Self {
        Self {
            index: index as u8,
            is_face: true,
        }
    }
}

/// The features that meet at a point. The features identify the point from step to step.
pub(crate) type ContactId = [Feature; 2];

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct ManifoldPoint {
    /// The point in the coordinates of the shape that does not define the normal.
    pub(crate) local_point: Vec2,
    pub(crate) normal_impulse: f32,
    pub(crate) tangent_impulse: f32,
    pub(crate) id: ContactId,
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Manifold {
    pub(crate) kind: Kind,
    pub(crate) local_normal: Vec2,
    /// A point of the face that defines the normal, or the centre of circle A.
    pub(crate) local_point: Vec2,
    points: [ManifoldPoint; 2],
    count: u8,
}

impl Manifold {
    /// A manifold without points.
    pub(crate) const EMPTY: Self = {
        let point = ManifoldPoint {
            local_point: Vec2::new(0.0, 0.0),
            normal_impulse: 0.0,
            tangent_impulse: 0.0,
            id: [Feature {
                index: 0,
                is_face: false,
            }; 2],
        };
        Self {
            kind: Kind::FaceA,
            local_normal: Vec2::new(0.0, 0.0),
            local_point: Vec2::new(0.0, 0.0),
            points: [point; 2],
            count: 0,
        }
    };

    pub(crate) fn new(kind: Kind, local_normal: Vec2, local_point: Vec2) -> Self {
        Self {
            kind,
            local_normal,
            local_point,
            ..Self::EMPTY
        }
    }

    pub(crate) fn push(&mut self, local_point: Vec2, id: ContactId) {
        let point = ManifoldPoint {
            local_point,
            id,
            ..Self::EMPTY.points[0]
        };
        self.points[usize::from(self.count)] = point;
        self.count += 1;
    }

    pub(crate) fn with_point(mut self, local_point: Vec2, id: ContactId) -> Self {
        self.push(local_point, id);
        self
    }

    #[inline]
    pub(crate) fn points(&self) -> &[ManifoldPoint] {
        &self.points[..usize::from(self.count).min(2)]
    }

    #[inline]
    pub(crate) fn points_mut(&mut self) -> &mut [ManifoldPoint] {
        &mut self.points[..usize::from(self.count).min(2)]
    }

    /// Copies the impulses from the points of `old` with the same ids.
    pub(crate) fn inherit(&mut self, old: &Self) {
        for point in self.points_mut() {
            if let Some(before) = old.points().iter().find(|before| before.id == point.id) {
                point.normal_impulse = before.normal_impulse;
                point.tangent_impulse = before.tangent_impulse;
            }
        }
    }

    /// Returns the normal from A to B and the points in world coordinates, halfway between the
    /// surfaces.
    pub(crate) fn world(
        &self,
        xf_a: &Pose,
        radius_a: f32,
        xf_b: &Pose,
        radius_b: f32,
    ) -> (Vec2, [Vec2; 2]) {
        let mut points = [Vec2::zeros(); 2];
        match self.kind {
            Kind::Circles => {
                let a = transform(xf_a, self.local_point);
                let b = transform(xf_b, self.points[0].local_point);
                let d = b - a;
                let mut normal = vec2(1.0, 0.0);
                if dot(d, d) > f32::EPSILON * f32::EPSILON {
                    normal = normalize(d).0;
                }
                points[0] = 0.5 * ((a + radius_a * normal) + (b - radius_b * normal));
                (normal, points)
            }
            Kind::FaceA => {
                let normal = rotate(xf_a.rotation, self.local_normal);
                let plane = transform(xf_a, self.local_point);
                for (point, world) in self.points().iter().zip(&mut points) {
                    let clip = transform(xf_b, point.local_point);
                    let on_a = clip + (radius_a - dot(clip - plane, normal)) * normal;
                    let on_b = clip - radius_b * normal;
                    *world = 0.5 * (on_a + on_b);
                }
                (normal, points)
            }
            Kind::FaceB => {
                let normal = rotate(xf_b.rotation, self.local_normal);
                let plane = transform(xf_b, self.local_point);
                for (point, world) in self.points().iter().zip(&mut points) {
                    let clip = transform(xf_a, point.local_point);
                    let on_b = clip + (radius_b - dot(clip - plane, normal)) * normal;
                    let on_a = clip - radius_a * normal;
                    *world = 0.5 * (on_a + on_b);
                }
                (-normal, points)
            }
        }
    }
}

/// A vertex of the incident edge while it is clipped.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ClipVertex {
    pub(crate) v: Vec2,
    pub(crate) id: ContactId,
}

/// Clips a segment to the inner side of a line (Sutherland and Hodgman). Returns `None` unless two
/// points remain. `vertex` is the vertex of the reference face that lies on the line.
pub(crate) fn clip(
    segment: [ClipVertex; 2],
    normal: Vec2,
    offset: f32,
    vertex: usize,
) -> Option<[ClipVertex; 2]> {
    let [first, second] = segment;
    let d0 = dot(normal, first.v) - offset;
    let d1 = dot(normal, second.v) - offset;
    // if the product of the distances rounds to zero, too few points remain: no contact
    let cut = || {
        let v = first.v + d0 / (d0 - d1) * (second.v - first.v);
        ClipVertex {
            v,
            id: [
                Feature::vertex(vertex),
                Feature::face(usize::from(first.id[1].index)),
            ],
        }
    };
    match (d0 <= 0.0, d1 <= 0.0) {
        (true, true) => Some(segment),
        (true, false) if d0 * d1 < 0.0 => Some([first, cut()]),
        (false, true) if d0 * d1 < 0.0 => Some([second, cut()]),
        _ => None,
    }
}
