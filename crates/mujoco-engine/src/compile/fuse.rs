//! The bodies of the compiled model. With `fusestatic`, bodies without joints become parts of their
//! parents: MuJoCo's `FuseStatic`.

use std::collections::HashSet;

use crate::mjcf::orientation::within;
use crate::mjcf::spec::{Body, Frame, Spec, Target};
use crate::model::{ObjectType, SensorType};

/// A body of the compiled model.
pub(super) struct Kept<'s> {
    pub(super) body: &'s Body,
    /// The compiled id of the parent.
    pub(super) parent: usize,
    /// The pose in the parent.
    pub(super) pose: Frame,
    /// The bodies that became parts of it, and their poses in it.
    pub(super) fused: Vec<(&'s Body, Frame)>,
}

/// The bodies of the compiled model, each after its parent.
pub(super) fn kept(spec: &Spec) -> Vec<Kept<'_>> {
    let named = Named::of(spec);
    let mut kept: Vec<Kept<'_>> = Vec::with_capacity(spec.bodies.len());
    // the compiled id of each body, and the pose of a fused one
    let mut places: Vec<(usize, Option<Frame>)> = Vec::with_capacity(spec.bodies.len());
    for (id, body) in spec.bodies.iter().enumerate() {
        let own = (body.pos, body.orientation.resolve(&body.compiler));
        let own = within(body.frame, own);
        if id == 0 {
            kept.push(Kept {
                body,
                parent: 0,
                pose: own,
                fused: Vec::new(),
            });
            places.push((0, None));
            continue;
        }
        let (parent, around) = places[body.parent];
        let pose = within(around, own);
        let fixed = body.joints.is_empty() && !body.mocap;
        if spec.compiler.fuse_static && fixed && !named.needs(body) {
            kept[parent].fused.push((body, pose));
            places.push((parent, Some(pose)));
        } else {
            places.push((kept.len(), None));
            kept.push(Kept {
                body,
                parent,
                pose,
                fused: Vec::new(),
            });
        }
    }
    kept
}

/// The names of bodies, and of sites that measure forces on their bodies.
#[derive(Default)]
struct Named<'s> {
    bodies: HashSet<&'s str>,
    sites: HashSet<&'s str>,
}

impl<'s> Named<'s> {
    fn of(spec: &'s Spec) -> Self {
        let mut named = Self::default();
        if !spec.compiler.fuse_static {
            return named;
        }
        let cameras = spec.bodies.iter().flat_map(|body| &body.cameras);
        let lights = spec.bodies.iter().flat_map(|body| &body.lights);
        let targets = cameras.map(|camera| &camera.target);
        let targets = targets.chain(lights.map(|light| &light.target));
        named.bodies.extend(targets.flatten().map(String::as_str));
        let excluded = spec.excludes.iter().flat_map(|exclude| &exclude.bodies);
        named.bodies.extend(excluded.map(String::as_str));
        for equality in &spec.equalities {
            if equality.relates_bodies() {
                let names = equality.names.iter().flatten();
                named.bodies.extend(names.map(String::as_str));
            }
        }
        for actuator in &spec.actuators {
            if let Some(("body", name)) = &actuator.target {
                named.bodies.insert(name);
            }
        }
        for sensor in &spec.sensors {
            let forces = matches!(sensor.kind, SensorType::Force | SensorType::Torque);
            for Target { kind, name, .. } in sensor.object.iter().chain(&sensor.reference) {
                match kind {
                    ObjectType::Body | ObjectType::XBody => named.bodies.insert(name),
                    ObjectType::Site if forces => named.sites.insert(name),
                    _ => false,
                };
            }
        }
        named
    }

    /// Whether another element refers to a body by its name. A body without a name is fused even if
    /// a sensor measures the force on it.
    fn needs(&self, body: &Body) -> bool {
        let Some(name) = &body.name else { return false };
        let mut sites = body.sites.iter().filter_map(|site| site.name.as_deref());
        self.bodies.contains(&**name) || sites.any(|site| self.sites.contains(site))
    }
}
