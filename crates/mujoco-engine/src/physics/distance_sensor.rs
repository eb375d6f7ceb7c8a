//! Sensors of the distance of geoms.

use super::collision::nearest;
use crate::math::spatial::{Vec3, normalize, sub};
use crate::model::{ObjectType, SensorType};
use crate::{Data, Model};

/// Writes the values of a sensor of the distance of two geoms, or of the geoms of two bodies.
pub(super) fn read(m: &Model, d: &mut Data, i: usize, out: &mut [f64]) {
    let geoms = |kind: ObjectType, id: i32| {
        let id = usize::try_from(id).unwrap_or(0);
        match kind {
            ObjectType::Body => m.geoms_of(id),
            _ => id..id + 1,
        }
    };
    let mut least = m.sensor_cutoff[i];
    let most = least;
    let mut ends: [Vec3; 2] = [[0.0; 3]; 2];
    for first in geoms(m.sensor_objtype[i], m.sensor_objid[i]) {
        for second in geoms(m.sensor_reftype[i], m.sensor_refid[i]) {
            if let Some((dist, found)) = nearest(m, d, [first, second], most)
                && dist < least
            {
                (least, ends) = (dist, found);
            }
        }
    }
    match m.sensor_type[i] {
        SensorType::GeomDist => out[0] = least,
        SensorType::GeomNormal => {
            let along = sub(ends[1], ends[0]);
            out.copy_from_slice(&if along == [0.0; 3] {
                along
            } else {
                normalize(along).0
            });
        }
        _ => out.copy_from_slice(ends.as_flattened()),
    }
}
