//! Keyframes.

use crate::Result;
use crate::math::spatial::{InTurn, Order};
use crate::mjcf::orientation::unit;
use crate::mjcf::spec::{Key, Spec};
use crate::model::{CompiledModel, JointType};

pub(super) fn add_keys(m: &mut CompiledModel, spec: &Spec) -> Result<()> {
    let mocap: Vec<usize> = (0..m.nbody()).filter(|b| m.body_mocapid[*b] >= 0).collect();
    let mpos: Vec<f64> = mocap.iter().flat_map(|b| m.body_pos[*b]).collect();
    let mquat: Vec<f64> = mocap.iter().flat_map(|b| m.body_quat[*b]).collect();
    let nothing = Key::default();
    let more = spec.nkey.saturating_sub(spec.keys.len());
    let own = spec.keys.iter().chain(std::iter::repeat_n(&nothing, more));
    let attached: Vec<Key> = spec
        .attached_keys
        .iter()
        .map(|key| own_key(m, spec, key, [&mpos, &mquat]))
        .collect();
    for key in own.chain(&attached) {
        let fitting = |name: &str, given: &Option<Vec<f64>>, default: &[f64], least: usize| {
            let Some(numbers) = given else {
                return Ok(default.to_vec());
            };
            let (have, need) = (numbers.len(), default.len());
            if (least..=need).contains(&have) {
                // the missing numbers are those of the initial state
                return Ok([&numbers[..], &default[have..]].concat());
            }
            Err(key
                .place
                .attribute(name, format!("{have} numbers, and the model needs {need}")))
        };
        // lists for joints and actuators may be shorter than in the model; lists for mocap bodies
        // may not
        let mut qpos = fitting("qpos", &key.qpos, &m.qpos0, 0)?;
        normalize_quaternions(m, &mut qpos);
        let qvel = fitting("qvel", &key.qvel, &vec![0.0; m.nv()], 0)?;
        let act = fitting("act", &key.act, &vec![0.0; m.na()], 0)?;
        let ctrl = fitting("ctrl", &key.ctrl, &vec![0.0; m.nu()], 0)?;
        let mpos = fitting("mpos", &key.mpos, &mpos, mpos.len())?;
        let mut mquat = fitting("mquat", &key.mquat, &mquat, mquat.len())?;
        for quat in mquat.chunks_mut(4) {
            normalize(quat);
        }
        m.names.key.push(key.name.clone());
        m.key_time.push(key.time);
        m.key_qpos.push(qpos);
        m.key_qvel.push(qvel);
        m.key_act.push(act);
        m.key_ctrl.push(ctrl);
        m.key_mpos.push(mpos);
        m.key_mquat.push(mquat);
    }
    Ok(())
}

/// A key of an attached model as one of this model.
fn own_key(m: &CompiledModel, spec: &Spec, key: &Key, [mpos, mquat]: [&[f64]; 2]) -> Key {
    let Some(stored) = &key.stored else {
        return key.clone();
    };
    let mut own = Key {
        stored: None,
        ..key.clone()
    };
    own.qpos = key.qpos.as_ref().map(|given| {
        let mut all = m.qpos0.clone();
        for &(joint, from, _) in &stored.joints {
            let count = m.jnt_type[joint].nq();
            all[m.jnt_qposadr[joint]..][..count].copy_from_slice(&given[from..][..count]);
        }
        all
    });
    own.qvel = key.qvel.as_ref().map(|given| {
        let mut all = vec![0.0; m.nv()];
        for &(joint, _, from) in &stored.joints {
            let count = m.jnt_type[joint].nv();
            all[m.jnt_dofadr[joint]..][..count].copy_from_slice(&given[from..][..count]);
        }
        all
    });
    let places = |all: &[f64], given: &[f64], size: usize| {
        let mut all = all.to_vec();
        for &(to, from) in &stored.mocap {
            all[size * to..][..size].copy_from_slice(&given[size * from..][..size]);
        }
        all
    };
    own.mpos = key.mpos.as_ref().map(|given| places(mpos, given, 3));
    own.mquat = key.mquat.as_ref().map(|given| places(mquat, given, 4));
    let actuators = || {
        let all = spec.actuators.iter().enumerate();
        all.filter_map(|(i, actuator)| match actuator.stored {
            Some((number, from)) if number == stored.number => Some((i, from)),
            _ => None,
        })
    };
    own.act = key.act.as_ref().map(|given| {
        let mut all = vec![0.0; m.na()];
        for (to, from) in actuators() {
            let to = usize::try_from(m.actuator_actadr[to]);
            if let (Ok(to), Some(from)) = (to, stored.activations[from]) {
                all[to] = given[from];
            }
        }
        all
    });
    own.ctrl = key.ctrl.as_ref().map(|given| {
        let mut all = vec![0.0; m.nu()];
        for (to, from) in actuators() {
            all[to] = given[from];
        }
        all
    });
    own
}

fn normalize_quaternions(m: &CompiledModel, qpos: &mut [f64]) {
    for j in 0..m.njnt() {
        let start = match m.jnt_type[j] {
            JointType::Free => m.jnt_qposadr[j] + 3,
            JointType::Ball => m.jnt_qposadr[j],
            _ => continue,
        };
        normalize(&mut qpos[start..start + 4]);
    }
}

fn normalize(quat: &mut [f64]) {
    let long = unit([quat[0], quat[1], quat[2], quat[3]]).0;
    quat.copy_from_slice(&InTurn::normalize_quat((), long));
}
