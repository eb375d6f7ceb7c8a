//! A compiled model as a table, for comparison with another compiler. It includes fields of
//! `mjModel` that this engine does not need.

use serde_json::{Map, Value, json};

use super::constants::body_sizes;
use crate::mjcf::orientation::IDENTITY;
use crate::model::bounds::bounding_box;
use crate::model::{JointType, Parameters, same, same_quat};
use crate::physics::{com_pos, kinematics};
use crate::{CompiledModel, Data, Model};

impl Model {
    /// The fields of [`CompiledModel`] under MuJoCo's names, and further fields of `mjModel` that
    /// are computed from them, for comparison with another compiler.
    #[must_use]
    pub fn figures(&self) -> Map<String, Value> {
        let mut figures = match serde_json::to_value(&**self) {
            Ok(Value::Object(figures)) => figures,
            _ => Map::new(),
        };
        add_all(&mut figures, sizes(self));
        add_all(&mut figures, derived(self));
        add_all(&mut figures, constant(self));
        let more = json!({"ccd_iterations": 35, "ccd_tolerance": 1e-6});
        if let Some(Value::Object(opt)) = figures.get_mut("opt") {
            add_all(opt, more);
        }
        // MuJoCo stores bit masks as signed numbers
        for (name, bits) in [
            ("geom_contype", &self.geom_contype),
            ("geom_conaffinity", &self.geom_conaffinity),
        ] {
            figures.insert(name.into(), bits.iter().map(|bits| *bits as i32).collect());
        }
        figures
    }
}

fn add_all(figures: &mut Map<String, Value>, more: Value) {
    if let Value::Object(more) = more {
        figures.extend(more);
    }
}

fn sizes(m: &CompiledModel) -> Value {
    // elements of the inertia matrix: each degree of freedom with its ancestors; simple ones have
    // none
    let (mut n_m, mut n_c) = (0, 0);
    for i in 0..m.nv() {
        let ancestors =
            std::iter::successors(Some(i), |i| usize::try_from(m.dof_parentid[*i]).ok()).count();
        n_m += ancestors;
        n_c += if m.dof_simplenum[i] > 0 { 1 } else { ancestors };
    }
    json!({"sizes": {
        "nq": m.nq(), "nv": m.nv(), "nu": m.nu(), "na": m.na(), "nbody": m.nbody(),
        "njnt": m.njnt(), "ngeom": m.ngeom(), "nsite": m.nsite(), "ncam": m.cam_mode.len(),
        "nlight": m.light_type.len(), "nmat": m.mat_rgba.len(), "ntendon": m.ntendon(),
        "nwrap": m.wrap_objid.len(), "neq": m.neq(), "nsensor": m.nsensor(),
        "nexclude": m.exclude_signature.len(), "npair": m.pair_dim.len(), "nkey": m.key_time.len(),
        "nM": n_m, "nC": n_c, "ntree": m.ntree(),
    }})
}

/// MuJoCo's `mjtSameFrame`: 1 if a geom's frame equals the body's, 2 its inertial frame; 3 and 4 if
/// only the orientations are equal.
fn same_frame(m: &CompiledModel, body: usize, pos: [f64; 3], quat: [f64; 4]) -> u8 {
    let (own_pos, own_quat) = (same(&pos, &[0.0; 3]), same_quat(&quat, &IDENTITY));
    let inertia_quat = same_quat(&quat, &m.body_iquat[body]);
    match (own_pos, own_quat) {
        (true, true) => 1,
        (_, true) => 3,
        _ if inertia_quat && same(&pos, &m.body_ipos[body]) => 2,
        _ if inertia_quat => 4,
        _ => 0,
    }
}

fn derived(m: &Model) -> Value {
    let bodies = 0..m.nbody();
    let any =
        |bits: &[u32], b: usize| bits[m.geoms_of(b)].iter().fold(0, |all, one| all | one) as i32;
    let body_frames: Vec<u8> = bodies
        .clone()
        .map(|b| match same_quat(&m.body_iquat[b], &IDENTITY) {
            false => 0,
            true if same(&m.body_ipos[b], &[0.0; 3]) => 1,
            true => 3,
        })
        .collect();

    let mut d = Data::new(m);
    kinematics(m, &mut d);
    com_pos(m, &mut d);
    let sizes = body_sizes(m, &d);
    let dof_length = |i: usize| {
        let joint = m.dof_jntid[i];
        let turns = match m.jnt_type[joint] {
            JointType::Free => i - m.jnt_dofadr[joint] >= 3,
            other => matches!(other, JointType::Hinge | JointType::Ball),
        };
        if turns { sizes[m.dof_bodyid[i]] } else { 1.0 }
    };
    json!({
        "body_sameframe": body_frames,
        "body_contype": bodies.clone().map(|b| any(&m.geom_contype, b)).collect::<Vec<_>>(),
        "body_conaffinity": bodies.clone().map(|b| any(&m.geom_conaffinity, b)).collect::<Vec<_>>(),
        "body_margin": bodies.map(|b| m.geoms_of(b).map(|g| m.geom_margin[g] + m.geom_gap[g]).fold(0.0, f64::max)).collect::<Vec<_>>(),
        "geom_sameframe": (0..m.ngeom()).map(|g| same_frame(m, m.geom_bodyid[g], m.geom_pos[g], m.geom_quat[g])).collect::<Vec<_>>(),
        "geom_aabb": (0..m.ngeom()).map(|g| bounding_box(m, g).concat()).collect::<Vec<_>>(),
        "dof_length": (0..m.nv()).map(dof_length).collect::<Vec<_>>(),
    })
}

/// The table in the form of the recordings.
fn constant(m: &CompiledModel) -> Value {
    let three = |numbers: &[Parameters]| -> Vec<Vec<f64>> {
        numbers.iter().map(|p| p.0[..3].to_vec()).collect()
    };
    json!({
        "geom_fluid": m.geom_fluid.iter().map(|fluid| fluid.0[0]).collect::<Vec<_>>(),
        "actuator_gainprm": three(&m.actuator_gainprm),
        "actuator_biasprm": three(&m.actuator_biasprm), "tendon_armature": vec![0.0; m.ntendon()],
    })
}
