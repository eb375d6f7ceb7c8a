//! Sensors: each match arm computes one type of sensor.

use super::contact_force::contact_force;
use super::energy::{computed, kinetic, potential};
use super::post_constraint::rne_post_constraint;
use super::ray::ray_shape;
use super::tendon::pulling;
use super::{contact_sensor, distance_sensor, range_sensor, sleep};
use crate::math::libm;
use crate::math::spatial::{
    InTurn, MINVAL, Mat3, Order, Pairwise, Quat, Vec3, Vec6, add, column, cross, dot, inverse,
    join, normalize, rotate, rotate_back, rotate_back6, rotation, scale, sub, transform_force,
    transform_motion, translation,
};
use crate::model::{About, Disable, Mount, ObjectType, SensorType, Stage, same_quat};
use crate::physics::constraint::Source;
use crate::physics::data::UNTURNED;
use crate::{Contact, Data, Model};

/// Computes `sensordata` of the sensors of `stages`: MuJoCo's `mj_sensorPos`, `mj_sensorVel` and
/// `mj_sensorAcc`.
#[inline(never)]
pub(super) fn sensors(m: &Model, d: &mut Data, stages: &[Stage]) {
    if m.opt.disables(Disable::Sensor) {
        return;
    }
    let uses = |kinds: &[SensorType]| {
        let mut all = m.sensor_type.iter();
        all.any(|kind| kinds.contains(kind) && stages.contains(&kind.stage()))
    };
    if uses(&[SensorType::SubtreeLinVel, SensorType::SubtreeAngMom]) {
        subtree_vel(m, d);
    }
    if uses(&[
        SensorType::Accelerometer,
        SensorType::Force,
        SensorType::Torque,
        SensorType::FrameLinAcc,
        SensorType::FrameAngAcc,
    ]) {
        rne_post_constraint(m, d);
        d.contact_forces = false;
    }
    let sleeps = m.plan().sleeps;
    for i in 0..m.nsensor() {
        let stage = m.sensor_type[i].stage();
        if !stages.contains(&stage) || (sleeps && sleep::sensor_rests(m, &d.work.tree_awake, i)) {
            continue;
        }
        let kind = m.sensor_type[i];
        let (first, dim, cutoff) = (m.sensor_adr[i], m.sensor_dim[i], m.sensor_cutoff[i]);
        if matches!(kind.about(), About::Contact | About::Pair | About::Ray) {
            let mut all = std::mem::take(&mut d.sensordata);
            let out = &mut all[first..first + dim];
            match kind.about() {
                About::Contact => contact_sensor::read(m, d, i, out),
                About::Pair => distance_sensor::read(m, d, i, out),
                _ => range_sensor::read(m, d, i, out),
            }
            if kind.has_cutoff() && cutoff > 0.0 {
                out.iter_mut().for_each(|x| *x = x.max(-cutoff).min(cutoff));
            }
            d.sensordata = all;
            continue;
        }
        let numbers = match stage {
            Stage::Position => {
                if m.revision.adds_in_pairs() {
                    of_position::<Pairwise>(m, d, i)
                } else {
                    of_position::<InTurn>(m, d, i)
                }
            }
            Stage::Velocity => of_velocity(m, d, i),
            Stage::Acceleration => of_acceleration(m, d, i),
        };
        for (out, number) in d.sensordata[first..first + dim].iter_mut().zip(numbers) {
            *out = if cutoff <= 0.0 || !kind.has_cutoff() {
                number
            } else if kind.is_positive() {
                cutoff.min(number)
            } else {
                number.max(-cutoff).min(cutoff)
            };
        }
    }
}

/// A sensor value of one number.
fn one(x: f64) -> Quat {
    [x, 0.0, 0.0, 0.0]
}

fn three([x, y, z]: Vec3) -> Quat {
    [x, y, z, 0.0]
}

/// The orientation of an object: the product of the body's orientation and the object's orientation
/// in the body's frame.
fn quat_of<O: Order>(m: &Model, d: &Data, kind: ObjectType, id: usize) -> Quat {
    let within = |body: usize, quat: Quat| O::mul_quat(d.xquat[body], quat);
    // a product with an identity may lose the sign of a zero
    let inertial = |body: usize| match m.body_iquat[body] {
        quat if m.revision.reads_mounted_orientations() && same_quat(&quat, &UNTURNED) => {
            d.xquat[body]
        }
        quat => within(body, quat),
    };
    let mounted = |body: usize, quat: Quat, mount: &Mount| match mount {
        _ if !m.revision.reads_mounted_orientations() => within(body, quat),
        Mount::Inertial | Mount::Aligned(_) => inertial(body),
        Mount::Own(pose) if !pose.turned => d.xquat[body],
        Mount::Own(_) => within(body, quat),
    };
    let plan = m.plan();
    match kind {
        ObjectType::Body => inertial(id),
        ObjectType::Geom => mounted(m.geom_bodyid[id], m.geom_quat[id], &plan.geoms[id]),
        ObjectType::Site => mounted(m.site_bodyid[id], m.site_quat[id], &plan.sites[id]),
        ObjectType::Camera => within(m.cam_bodyid[id], m.cam_quat[id]),
        _ => d.xquat[id],
    }
}

/// The body, position and orientation of an object.
pub(super) fn frame_of(m: &Model, d: &Data, kind: ObjectType, id: usize) -> (usize, Vec3, Mat3) {
    match kind {
        ObjectType::Body => (id, d.xipos[id], d.ximat[id]),
        ObjectType::Geom => (m.geom_bodyid[id], d.geom_xpos[id], d.geom_xmat[id]),
        ObjectType::Site => (m.site_bodyid[id], d.site_xpos[id], d.site_xmat[id]),
        ObjectType::Camera => {
            let body = m.cam_bodyid[id];
            let pos = add(rotate(&d.xmat[body], m.cam_pos[id]), d.xpos[body]);
            let target = match (m.cam_mode[id], usize::try_from(m.cam_targetbodyid[id])) {
                (3, Ok(target)) => Some(d.xpos[target]),
                (4, Ok(target)) => Some(d.subtree_com[target]),
                _ => None,
            };
            let Some(target) = target else {
                let (outer, own) = (d.xquat[body], m.cam_quat[id]);
                let mat = if m.revision.adds_in_pairs() {
                    Pairwise::quat_to_mat(Pairwise::mul_quat(outer, own))
                } else {
                    InTurn::quat_to_mat(InTurn::mul_quat(outer, own))
                };
                return (body, pos, mat);
            };
            let z = normalize(sub(pos, target)).0;
            let x = normalize(cross([0.0, 0.0, 1.0], z)).0;
            let y = normalize(cross(z, x)).0;
            let mat = [0, 1, 2].map(|k| [x[k], y[k], z[k]]);
            (body, pos, std::array::from_fn(|i| mat[i / 3][i % 3]))
        }
        _ => (id, d.xpos[id], d.xmat[id]),
    }
}

/// The object and the reference object of sensor `i`.
fn objects(m: &Model, i: usize) -> ((ObjectType, usize), Option<(ObjectType, usize)>) {
    let id = |id: i32| usize::try_from(id).ok();
    let object = (m.sensor_objtype[i], id(m.sensor_objid[i]).unwrap_or(0));
    let reference = id(m.sensor_refid[i]).map(|id| (m.sensor_reftype[i], id));
    (object, reference)
}

/// The row of a joint's or tendon's limit.
fn limit_row(d: &Data, source: Source) -> Option<usize> {
    let blocks = d.efc.blocks.iter();
    let mut found = blocks.filter(|block| block.source == source);
    found.next().map(|block| block.row)
}

fn of_position<O: Order>(m: &Model, d: &mut Data, i: usize) -> Quat {
    let ((kind, id), reference) = objects(m, i);
    match m.sensor_type[i] {
        SensorType::Magnetometer => three(rotate_back(&d.site_xmat[id], m.opt.magnetic)),
        SensorType::JointPos => one(d.qpos[m.jnt_qposadr[id]]),
        SensorType::TendonPos => one(d.ten_length[id]),
        SensorType::ActuatorPos => one(d.actuator_length[id]),
        SensorType::BallQuat => {
            let p = m.jnt_qposadr[id];
            O::normalize_quat((), [0, 1, 2, 3].map(|k| d.qpos[p + k]))
        }
        SensorType::JointLimitPos => limit_distance(d, Source::Limit(id)),
        SensorType::TendonLimitPos => limit_distance(d, Source::TendonLimit(id)),
        SensorType::FramePos => {
            let (_, pos, _) = frame_of(m, d, kind, id);
            three(match reference {
                None => pos,
                Some((kind, id)) => {
                    let (_, origin, axes) = frame_of(m, d, kind, id);
                    rotate_back(&axes, sub(pos, origin))
                }
            })
        }
        axis @ (SensorType::FrameXAxis | SensorType::FrameYAxis | SensorType::FrameZAxis) => {
            let (_, _, mat) = frame_of(m, d, kind, id);
            let axis = column(&mat, axis as usize - SensorType::FrameXAxis as usize);
            three(match reference {
                None => axis,
                Some((kind, id)) => rotate_back(&frame_of(m, d, kind, id).2, axis),
            })
        }
        SensorType::FrameQuat => {
            let quat = quat_of::<O>(m, d, kind, id);
            match reference {
                None => quat,
                Some((kind, id)) => {
                    let reference = quat_of::<O>(m, d, kind, id);
                    O::mul_quat(inverse(reference), quat)
                }
            }
        }
        SensorType::InsideSite => {
            let site = reference.map_or(0, |(_, site)| site);
            let point = match kind {
                // of bodies without mass
                ObjectType::Body
                    if id > 0 && m.body_mass[id] < MINVAL && m.body_subtreemass[id] >= MINVAL =>
                {
                    d.subtree_com[id]
                }
                _ => frame_of(m, d, kind, id).1,
            };
            one(f64::from(inside(m, d, site, point)))
        }
        SensorType::CamProjection => {
            let camera = reference.map_or(0, |(_, camera)| camera);
            let [x, y] = projection(m, d, camera, d.site_xpos[id]);
            [x, y, 0.0, 0.0]
        }
        SensorType::SubtreeCom => three(d.subtree_com[id]),
        SensorType::EPotential => one(potential(m, d)),
        // if the model computes the energy, the sensor has the energy of the last evaluation, if there was one
        SensorType::EKinetic if computed(m) && d.knows_energy => one(d.energy[1]),
        SensorType::EKinetic => one(kinetic(m, d)),
        _ => one(d.time),
    }
}

fn limit_distance(d: &Data, source: Source) -> Quat {
    one(limit_row(d, source).map_or(0.0, |row| d.efc.pos[row] - d.efc.margin[row]))
}

fn of_velocity(m: &Model, d: &Data, i: usize) -> Quat {
    let ((kind, id), reference) = objects(m, i);
    let limit = |source| one(limit_row(d, source).map_or(0.0, |row| d.efc.vel[row]));
    match m.sensor_type[i] {
        SensorType::Velocimeter => three(translation(&object_velocity(m, d, kind, id, true))),
        SensorType::Gyro => three(rotation(&object_velocity(m, d, kind, id, true))),
        SensorType::JointVel => one(d.qvel[m.jnt_dofadr[id]]),
        SensorType::TendonVel => one(d.ten_velocity[id]),
        SensorType::ActuatorVel => one(d.actuator_velocity[id]),
        SensorType::BallAngVel => {
            let v = m.jnt_dofadr[id];
            three([d.qvel[v], d.qvel[v + 1], d.qvel[v + 2]])
        }
        SensorType::JointLimitVel => limit(Source::Limit(id)),
        SensorType::TendonLimitVel => limit(Source::TendonLimit(id)),
        linear @ (SensorType::FrameLinVel | SensorType::FrameAngVel) => {
            let mut velocity = object_velocity(m, d, kind, id, false);
            if let Some((ref_kind, ref_id)) = reference {
                let (_, pos, _) = frame_of(m, d, kind, id);
                let (_, origin, axes) = frame_of(m, d, ref_kind, ref_id);
                let other = object_velocity(m, d, ref_kind, ref_id, false);
                let apart: Vec6 = std::array::from_fn(|k| velocity[k] - other[k]);
                let turning = cross(sub(pos, origin), rotation(&other));
                let moving = add(translation(&apart), turning);
                velocity = rotate_back6(&axes, &join(rotation(&apart), moving));
            }
            three(if linear == SensorType::FrameLinVel {
                translation(&velocity)
            } else {
                rotation(&velocity)
            })
        }
        SensorType::SubtreeLinVel => three(d.subtree_linvel[id]),
        _ => three(d.subtree_angmom[id]),
    }
}

fn of_acceleration(m: &Model, d: &Data, i: usize) -> Quat {
    let ((kind, id), _) = objects(m, i);
    let between = |site: usize| {
        let body = m.site_bodyid[site];
        let com = d.subtree_com[m.body_rootid[body]];
        let force = transform_force(&d.cfrc_int[body], d.site_xpos[site], com);
        rotate_back6(&d.site_xmat[site], &force)
    };
    let limit = |source| one(limit_row(d, source).map_or(0.0, |row| d.efc.force[row]));
    match m.sensor_type[i] {
        SensorType::Touch => one(touch(m, d, id)),
        SensorType::Accelerometer => three(translation(&object_acceleration(m, d, kind, id, true))),
        SensorType::Force => three(translation(&between(id))),
        SensorType::Torque => three(rotation(&between(id))),
        SensorType::ActuatorFrc => one(d.actuator_force[id]),
        SensorType::JointActFrc => one(d.qfrc_actuator[m.jnt_dofadr[id]]),
        SensorType::TendonActFrc => {
            one(pulling(m, id).fold(0.0, |sum, i| sum + d.actuator_force[i]))
        }
        SensorType::JointLimitFrc => limit(Source::Limit(id)),
        SensorType::TendonLimitFrc => limit(Source::TendonLimit(id)),
        SensorType::FrameLinAcc => three(translation(&object_acceleration(m, d, kind, id, false))),
        _ => three(rotation(&object_acceleration(m, d, kind, id, false))),
    }
}

/// The sum of the normal forces of contacts within a site.
fn touch(m: &Model, d: &Data, site: usize) -> f64 {
    let place = (site, d.site_xpos[site], &d.site_xmat[site]);
    touch_of(m, place, &d.contact, |contact| {
        contact_force(m, d, contact)[0]
    })
}

/// [`touch`] for a list of contacts. `normal_force` returns the normal force of a contact.
pub(super) fn touch_of(
    m: &Model,
    (site, pos, mat): (usize, Vec3, &Mat3),
    contacts: &[Contact],
    normal_force: impl Fn(&Contact) -> f64,
) -> f64 {
    let body = m.site_bodyid[site];
    let mut sum = 0.0;
    for contact in contacts.iter().filter(|contact| contact.efc_address >= 0) {
        let bodies = contact.geom.map(|g| m.geom_bodyid[g]);
        if !bodies.contains(&body) {
            continue;
        }
        let normal = normal_force(contact);
        if normal <= 0.0 {
            continue;
        }
        let frame = &contact.frame;
        let (mut along, _) = normalize(scale([frame[0], frame[1], frame[2]], normal));
        if body == bodies[1] {
            along = scale(along, -1.0);
        }
        let shape = m.site_type[site];
        if ray_shape(shape, (pos, mat), m.site_size[site], contact.pos, along) >= 0.0 {
            sum += normal;
        }
    }
    sum
}

/// Whether a point is within a site: MuJoCo's `mju_insideGeom`.
pub(super) fn inside(m: &Model, d: &Data, site: usize, point: Vec3) -> bool {
    let [r, half, _] = m.site_size[site];
    let size = m.site_size[site];
    let apart = sub(point, d.site_xpos[site]);
    let at = rotate_back(&d.site_xmat[site], apart);
    let across = at[0] * at[0] + at[1] * at[1];
    match m.site_type[site] {
        2 => dot(apart, apart) < r * r,
        3 => {
            let beyond = at[2] - at[2].clamp(-half, half);
            across + beyond * beyond < r * r
        }
        4 => {
            (0..3)
                .map(|k| at[k] * at[k] / (size[k] * size[k]))
                .sum::<f64>()
                < 1.0
        }
        5 => at[2].abs() < half && across < r * r,
        6 => (0..3).all(|k| at[k].abs() < size[k]),
        _ => false,
    }
}

/// The place of a point in a camera's picture, in pixels: MuJoCo's `cam_project`.
fn projection(m: &Model, d: &Data, camera: usize, point: Vec3) -> [f64; 2] {
    let [width, height] = m.cam_resolution[camera].map(f64::from);
    let [sensor, intrinsic] = [m.cam_sensorsize[camera], {
        let [x, y, ..] = m.cam_intrinsic[camera];
        [x, y]
    }];
    // in single precision, as MuJoCo
    let focal = |axis: usize, pixels: f64| {
        f64::from(intrinsic[axis] as f32 / sensor[axis] as f32 * pixels as f32)
    };
    let [fx, fy] = if sensor[0] != 0.0 && sensor[1] != 0.0 {
        [focal(0, width), focal(1, height)]
    } else {
        let (sin, cos) = libm::sin_cos(m.cam_fovy[camera] * std::f64::consts::PI / 360.0);
        [0.5 / (sin / cos) * height; 2]
    };
    let (_, pos, axes) = frame_of(m, d, ObjectType::Camera, camera);
    let [x, y, z] = rotate_back(&axes, sub(point, pos));
    let depth = if z.abs() >= MINVAL {
        z
    } else if z < 0.0 {
        -MINVAL
    } else {
        MINVAL
    };
    [
        -fx * (x / depth) + 0.5 * width,
        fy * (y / depth) + 0.5 * height,
    ]
}

/// Whether no degree of freedom moves a body.
pub(super) fn fixed(m: &Model, body: usize) -> bool {
    m.plan().chain(body).is_empty()
}

/// The velocity of an object at the object's position, in the axes of the world or of the object:
/// MuJoCo's `mj_objectVelocity`.
pub(super) fn object_velocity(
    m: &Model,
    d: &Data,
    kind: ObjectType,
    id: usize,
    own_axes: bool,
) -> Vec6 {
    if fixed(m, frame_of(m, d, kind, id).0) {
        return [0.0; 6];
    }
    of_object(m, d, &d.cvel, (kind, id), own_axes)
}

fn of_object(
    m: &Model,
    d: &Data,
    motions: &[Vec6],
    (kind, id): (ObjectType, usize),
    own_axes: bool,
) -> Vec6 {
    let (body, pos, mat) = frame_of(m, d, kind, id);
    let com = d.subtree_com[m.body_rootid[body]];
    let motion = transform_motion(&motions[body], pos, com);
    if own_axes {
        rotate_back6(&mat, &motion)
    } else {
        motion
    }
}

/// The acceleration of an object: MuJoCo's `mj_objectAcceleration`. From 4.0 on, the acceleration
/// includes gravity for static bodies too.
fn object_acceleration(m: &Model, d: &Data, kind: ObjectType, id: usize, own_axes: bool) -> Vec6 {
    if !m.revision.accelerates_fixed_bodies() && fixed(m, frame_of(m, d, kind, id).0) {
        return [0.0; 6];
    }
    let acceleration = of_object(m, d, &d.cacc, (kind, id), own_axes);
    let velocity = of_object(m, d, &d.cvel, (kind, id), own_axes);
    let turning = cross(rotation(&velocity), translation(&velocity));
    let moving = add(translation(&acceleration), turning);
    join(rotation(&acceleration), moving)
}

/// Computes `subtree_linvel` and `subtree_angmom`: MuJoCo's `mj_subtreeVel`. Bodies that sleep keep theirs, and are not
/// counted.
fn subtree_vel(m: &Model, d: &mut Data) {
    let mut velocities = std::mem::take(&mut d.work.body_velocity);
    velocities.clear();
    velocities.resize(m.nbody(), [0.0; 6]);
    let awake = std::mem::take(&mut d.work.tree_awake);
    let counts = |b: &usize| !m.plan().sleeps || !sleep::body_sleeps(m, &awake, *b);
    for b in (0..m.nbody()).filter(counts) {
        let velocity = object_velocity(m, d, ObjectType::Body, b, false);
        d.subtree_linvel[b] = scale(translation(&velocity), m.body_mass[b]);
        let local = rotate_back(&d.ximat[b], rotation(&velocity));
        let local = std::array::from_fn(|k| local[k] * m.body_inertia[b][k]);
        d.subtree_angmom[b] = rotate(&d.ximat[b], local);
        velocities[b] = velocity;
    }
    for b in (0..m.nbody()).rev().filter(counts) {
        if b > 0 {
            let parent = m.body_parentid[b];
            d.subtree_linvel[parent] = add(d.subtree_linvel[parent], d.subtree_linvel[b]);
        }
        let mass = f64::max(MINVAL, m.body_subtreemass[b]);
        d.subtree_linvel[b] = scale(d.subtree_linvel[b], 1.0 / mass);
    }
    for b in (1..m.nbody()).rev().filter(counts) {
        let parent = m.body_parentid[b];
        // first about the body's own centre of mass, then about the parent's
        let dx = sub(d.xipos[b], d.subtree_com[b]);
        let dv = sub(translation(&velocities[b]), d.subtree_linvel[b]);
        let own = cross(dx, scale(dv, m.body_mass[b]));
        d.subtree_angmom[b] = add(d.subtree_angmom[b], own);
        d.subtree_angmom[parent] = add(d.subtree_angmom[parent], d.subtree_angmom[b]);
        let dx = sub(d.subtree_com[b], d.subtree_com[parent]);
        let dv = sub(d.subtree_linvel[b], d.subtree_linvel[parent]);
        let moved = cross(dx, scale(dv, m.body_subtreemass[b]));
        d.subtree_angmom[parent] = add(d.subtree_angmom[parent], moved);
    }
    d.work.tree_awake = awake;
    d.work.body_velocity = velocities;
}
