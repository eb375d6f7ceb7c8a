//! A model's figures as a table, with those that MuJoCo has and this engine does not need.

use serde_json::{Map, Value, json};

use super::constants::body_sizes;
use super::orientation::{EPS, norm};
use crate::model::{GeomType, JointType};
use crate::physics::dense::dot_slices;
use crate::physics::{com_pos, crb, factor_m, kinematics, solve_m};
use crate::{CompiledModel, Data, Model};

impl Model {
    /// The figures of the model under MuJoCo's names, to be compared with those of another
    /// compiler: those of [`CompiledModel`], and some more that follow from them.
    #[must_use]
    pub fn figures(&self) -> Map<String, Value> {
        let mut figures = match serde_json::to_value(&**self) {
            Ok(Value::Object(figures)) => figures,
            _ => Map::new(),
        };
        add_all(&mut figures, sizes(self));
        add_all(&mut figures, derived(self));
        add_all(&mut figures, constant(self));
        let more = json!({
            "ccd_iterations": 35, "ccd_tolerance": 1e-6,
        });
        if let Some(Value::Object(opt)) = figures.get_mut("opt") {
            add_all(opt, more);
        }
        // bits have a sign in MuJoCo
        for name in ["geom_contype", "geom_conaffinity"] {
            let bits = if name == "geom_contype" {
                &self.geom_contype
            } else {
                &self.geom_conaffinity
            };
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
        "nq": m.nq(), "nv": m.nv(), "nu": m.nu(), "na": 0, "nbody": m.nbody(), "njnt": m.njnt(), "ngeom": m.ngeom(),
        "nsite": m.nsite(), "ncam": m.cam_mode.len(), "nlight": m.light_type.len(), "nmat": m.mat_rgba.len(),
        "ntendon": m.ntendon(), "nwrap": m.wrap_objid.len(), "neq": 0, "nsensor": 0, "nexclude": m.exclude_signature.len(),
        "npair": 0, "nkey": m.key_time.len(), "nM": n_m, "nC": n_c, "ntree": m.ntree(),
    }})
}

/// The frames that coincide: 1 the body's, 2 its inertia's, 3 and 4 their orientations.
fn same_frame(m: &CompiledModel, body: usize, pos: [f64; 3], quat: [f64; 4]) -> u8 {
    let same = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < EPS);
    let (own_pos, own_quat) = (norm(&pos) < EPS, norm(&quat[1..]) < EPS);
    let inertia_quat = same(&quat, &m.body_iquat[body]);
    match (own_pos, own_quat) {
        (true, true) => 1,
        (_, true) => 3,
        _ if inertia_quat && same(&pos, &m.body_ipos[body]) => 2,
        _ if inertia_quat => 4,
        _ => 0,
    }
}

fn bounding_box(shape: GeomType, [r, half, _]: [f64; 3]) -> [f64; 6] {
    match shape {
        GeomType::Plane => [0.0, 0.0, -5e9, 1e10, 1e10, 5e9],
        GeomType::Sphere => [0.0, 0.0, 0.0, r, r, r],
        GeomType::Capsule => [0.0, 0.0, 0.0, r, r, r + half],
        GeomType::Cylinder => [0.0, 0.0, 0.0, r, r, half],
    }
}

fn derived(m: &Model) -> Value {
    let geoms = |b: usize| {
        let first = usize::try_from(m.body_geomadr[b]).unwrap_or(0);
        first..first + m.body_geomnum[b]
    };
    let bodies = 0..m.nbody();
    let any = |bits: &[u32], b: usize| bits[geoms(b)].iter().fold(0, |all, one| all | one) as i32;
    let body_frames: Vec<u8> = bodies
        .clone()
        .map(|b| {
            let turned = norm(&m.body_iquat[b][1..]) >= EPS;
            if turned {
                0
            } else if norm(&m.body_ipos[b]) < EPS {
                1
            } else {
                3
            }
        })
        .collect();

    let mut d = Data::new(m);
    kinematics(m, &mut d);
    com_pos(m, &mut d);
    crb(m, &mut d);
    factor_m(m, &mut d);
    let solved = |row: &[f64]| {
        let mut x = row.to_vec();
        solve_m(m, &d, &mut x);
        x
    };
    let along = |joint: usize, scale: f64| {
        let mut row = vec![0.0; m.nv()];
        row[m.jnt_dofadr[joint]] = scale;
        row
    };
    let joint_of = |a: usize| usize::try_from(m.actuator_trnid[a][0]).unwrap_or(0);
    let actuators = 0..m.nu();
    let tendon_rows: Vec<Vec<f64>> = (0..m.ntendon())
        .map(|t| {
            let mut row = vec![0.0; m.nv()];
            for w in m.tendon_adr[t]..m.tendon_adr[t] + m.tendon_num[t] {
                row[m.jnt_dofadr[m.wrap_objid[w] as usize]] += m.wrap_prm[w];
            }
            row
        })
        .collect();
    let tendon_length = |t: usize, qpos: &[f64]| {
        let terms = m.tendon_adr[t]..m.tendon_adr[t] + m.tendon_num[t];
        terms
            .map(|w| m.wrap_prm[w] * qpos[m.jnt_qposadr[m.wrap_objid[w] as usize]])
            .sum::<f64>()
    };
    let length = |row: &[f64]| dot_slices(row, row).sqrt();
    let sizes = body_sizes(m, &d);
    let dof_length = |i: usize| {
        let joint = m.dof_jntid[i];
        let turns = match m.jnt_type[joint] {
            JointType::Free => i - m.jnt_dofadr[joint] >= 3,
            other => other == JointType::Hinge,
        };
        if turns { sizes[m.dof_bodyid[i]] } else { 1.0 }
    };
    json!({
        "body_sameframe": body_frames,
        "body_contype": bodies.clone().map(|b| any(&m.geom_contype, b)).collect::<Vec<_>>(),
        "body_conaffinity": bodies.clone().map(|b| any(&m.geom_conaffinity, b)).collect::<Vec<_>>(),
        "body_margin": bodies.map(|b| geoms(b).map(|g| m.geom_margin[g] + m.geom_gap[g]).fold(0.0, f64::max)).collect::<Vec<_>>(),
        "geom_sameframe": (0..m.ngeom()).map(|g| same_frame(m, m.geom_bodyid[g], m.geom_pos[g], m.geom_quat[g])).collect::<Vec<_>>(),
        "geom_aabb": (0..m.ngeom()).map(|g| bounding_box(m.geom_type[g], m.geom_size[g])).collect::<Vec<_>>(),
        "actuator_length0": actuators.clone().map(|a| m.actuator_gear[a][0] * m.qpos0[m.jnt_qposadr[joint_of(a)]]).collect::<Vec<_>>(),
        "actuator_acc0": actuators.map(|a| length(&solved(&along(joint_of(a), m.actuator_gear[a][0])))).collect::<Vec<_>>(),
        "dof_length": (0..m.nv()).map(dof_length).collect::<Vec<_>>(),
        "tendon_length0": (0..m.ntendon()).map(|t| tendon_length(t, &m.qpos0)).collect::<Vec<_>>(),
        "tendon_lengthspring": (0..m.ntendon()).map(|t| [tendon_length(t, &m.qpos_spring); 2]).collect::<Vec<_>>(),
        "tendon_invweight0": tendon_rows.iter().map(|row| dot_slices(row, &solved(row))).collect::<Vec<_>>(),
    })
}

/// The facts that hold for every model of the supported kind.
fn constant(m: &CompiledModel) -> Value {
    let (nu, nt) = (m.nu(), m.ntendon());
    json!({
        "body_gravcomp": vec![0.0; m.nbody()], "jnt_actfrclimited": vec![false; m.njnt()],
        "dof_frictionloss": vec![0.0; m.nv()], "geom_fluid": vec![0.0; m.ngeom()],
        "actuator_trntype": vec![0; nu], "actuator_dyntype": vec![0; nu], "actuator_gaintype": vec![0; nu],
        "actuator_biastype": vec![0; nu], "actuator_gainprm": vec![[1.0, 0.0, 0.0]; nu],
        "actuator_biasprm": vec![[0.0; 3]; nu], "actuator_forcelimited": vec![false; nu],
        "tendon_limited": vec![false; nt], "tendon_stiffness": vec![0.0; nt], "tendon_damping": vec![0.0; nt],
        "tendon_frictionloss": vec![0.0; nt], "tendon_armature": vec![0.0; nt], "tendon_range": vec![[0.0; 2]; nt],
        "tendon_margin": vec![0.0; nt],
        "wrap_type": vec![1; m.wrap_objid.len()],
    })
}
