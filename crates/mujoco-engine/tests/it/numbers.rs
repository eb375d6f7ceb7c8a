//! Numbers that no model can have: `Model::new` and `Model::change` refuse what MJCF refuses.

use mujoco_engine::model::{Cone, Solver};
use mujoco_engine::{CompiledModel, Data, Model, step};
use serde_json::{Value, json};

/// A model that has every kind of object.
pub(super) const TEXT: &str = r#"<mujoco>
  <option timestep=".002" density="1.2" viscosity=".01"/>
  <asset><material name="red" rgba="1 0 0 1"/></asset>
  <worldbody>
    <camera name="eye" pos="0 -2 1"/>
    <geom name="floor" type="plane" size="5 5 .1" material="red"/>
    <body name="hand" mocap="true" pos="1 1 1"/>
    <body name="upper" pos="0 0 .6">
      <joint name="j0" axis="0 1 0" damping=".1" frictionloss=".1" actuatorfrcrange="-9 9"/>
      <geom name="g0" type="capsule" fromto="0 0 0 .4 0 0" size=".04"/><site name="s0" pos=".1 0 .05"/>
      <body name="lower" pos=".4 0 0"><joint name="j1" axis="0 1 0" range="-120 60" stiffness=".5"/>
        <geom name="g1" type="capsule" fromto="0 0 0 .35 0 0" size=".03" fluidshape="ellipsoid"/><site name="s1" pos=".35 0 0"/></body></body>
    <body name="ball" pos="-.5 .1 .3"><joint name="b" type="ball" range="0 90"/><geom name="g2" size=".1" pos="0 0 -.15"/></body>
    <body name="box" pos=".5 .5 .1"><freejoint/><geom name="g3" type="box" size=".1 .08 .12"/></body>
  </worldbody>
  <contact><pair geom1="g2" geom2="g3"/></contact>
  <tendon><fixed name="t" range="-1 1" limited="true" frictionloss=".1" actuatorfrcrange="-5 5" actuatorfrclimited="true">
      <joint joint="j0" coef="1"/><joint joint="j1" coef="-.5"/></fixed>
    <spatial name="u" stiffness="3" damping=".2" springlength=".2"><site site="s0"/><geom geom="g2" sidesite="s1"/><site site="s1"/>
      <pulley divisor="2"/><site site="s0"/><site site="s1"/></spatial></tendon>
  <equality><joint joint1="j1" joint2="j0" polycoef="0 .5 0 0 0"/></equality>
  <actuator><motor joint="j0" ctrlrange="-1 1" forcerange="-2 2"/><position tendon="t" kp="5"/>
    <muscle joint="j1" lengthrange=".1 1"/><intvelocity joint="j0" actrange="-1 1" kp="2"/></actuator>
  <sensor><accelerometer site="s1" cutoff="100"/><touch site="s1"/></sensor>
  <keyframe><key time="1" qpos=".1"/></keyframe>
</mujoco>"#;

/// Numbers of the model that may not be negative, not 0, and not 200.
const NEGATIVE: &str = "body_mass/3 body_inertia/3/1 jnt_margin/0 jnt_stiffness/1 dof_armature/0 dof_damping/1 dof_frictionloss/0 \
                    geom_rbound/1 geom_solmix/0 geom_friction/2/2 tendon_stiffness/1 tendon_damping/1 tendon_frictionloss/0 \
                    sensor_cutoff/0 sensor_noise/0 opt/tolerance opt/ls_tolerance opt/noslip_tolerance opt/ccd_tolerance opt/density opt/viscosity \
                    opt/impratio opt/timestep stat/extent wrap_prm/5 cam_fovy/0 \
                    jnt_solref/0/1 \
                    dof_solref/0/0 geom_solref/3/1 eq_solref/0/0 pair_solref/0/0 tendon_solref_lim/0/0 tendon_solref_fri/0/1";
const ZERO: &str = "body_mass/3 body_inertia/2/0 opt/impratio opt/timestep geom_size/1/0 jnt_solref/0/0 cam_fovy/0";
const LARGE: &str = "body_inertia/3/0 jnt_range/1/0 tendon_range/0/0 jnt_actfrcrange/0/0 \
                 tendon_actfrcrange/0/0 actuator_ctrlrange/0/0 actuator_forcerange/0/0 actuator_actrange/3/0 actuator_lengthrange/2/0 \
                 tendon_lengthspring/1/0 geom_quat/1/2 body_quat/2/0 body_iquat/3/1 site_quat/0/3 cam_quat/0/0 jnt_axis/0/0 \
                 geom_matid/0 cam_targetbodyid/0 wrap_prm/3 pair_dim/0 body_mocapid/1 cam_fovy/0 cam_mode/0";

/// The quaternions of the objects of a kind.
type Quats = fn(&mut CompiledModel) -> &mut Vec<[f64; 4]>;

fn model() -> Model {
    Model::from_xml(TEXT).unwrap()
}

/// Returns the model with a number at `pointer` replaced.
fn changed(m: &CompiledModel, pointer: &str, number: &Value) -> CompiledModel {
    let mut figures = serde_json::to_value(m).unwrap();
    *figures
        .pointer_mut(pointer)
        .unwrap_or_else(|| panic!("{pointer}")) = number.clone();
    serde_json::from_value(figures).unwrap()
}

/// Requires `Model::new` and `change` to refuse a change, with an error that has `message`.
fn refuses(change: impl Fn(&mut CompiledModel), message: &str) {
    let m = model();
    let mut figures = CompiledModel::clone(&m);
    change(&mut figures);
    let error = Model::new(figures).err().map(|error| error.to_string());
    assert!(
        error.as_ref().is_some_and(|error| error.contains(message)),
        "new, {message}: {error:?}"
    );
    let mut changed = m.clone();
    let error = changed.change(change).err().map(|error| error.to_string());
    assert!(
        error.as_ref().is_some_and(|error| error.contains(message)),
        "change, {message}: {error:?}"
    );
    assert_eq!(*changed, *m);
}

/// What is refused of one object is refused of each of its kind, from the first to the last.
#[test]
fn what_is_refused_of_one_object_is_refused_of_all() {
    let m = model();
    let figures = serde_json::to_value(&*m).unwrap();
    let mut accepted = Vec::new();
    for (fields, number) in [
        (NEGATIVE, json!(-1.0)),
        (ZERO, json!(0.0)),
        (LARGE, json!(200)),
    ] {
        for field in fields.split_whitespace() {
            let parts: Vec<&str> = field.split('/').collect();
            let Some(all) = figures[parts[0]].as_array() else {
                continue;
            };
            for i in 0..all.len() {
                let rest: String = parts[2..].iter().map(|part| format!("/{part}")).collect();
                let field = format!("{}/{i}{rest}", parts[0]);
                if Model::new(changed(&m, &format!("/{field}"), &number)).is_ok() {
                    accepted.push(format!("{field}={number}"));
                }
            }
        }
    }
    // what has no range, weightless bodies that stand still, planes, and wrapped objects of other kinds
    accepted.retain(|field| !field.starts_with("wrap_prm"));
    let without = "body_mass/0=0.0 body_mass/1=0.0 body_inertia/0/0=0.0 body_inertia/1/0=0.0 geom_size/0/0=0.0 tendon_range/1/0=200 \
                   jnt_actfrcrange/1/0=200 jnt_actfrcrange/2/0=200 jnt_actfrcrange/3/0=200 tendon_actfrcrange/1/0=200 \
                   actuator_forcerange/1/0=200 actuator_forcerange/2/0=200 actuator_forcerange/3/0=200 \
                   actuator_actrange/0/0=200 actuator_actrange/1/0=200 actuator_actrange/2/0=200 \
                   actuator_lengthrange/0/0=200 actuator_lengthrange/1/0=200 actuator_lengthrange/3/0=200 \
                   jnt_axis/2/0=200 jnt_axis/3/0=200";
    let without: Vec<_> = without.split_whitespace().collect();
    assert_eq!(accepted, without);
}

#[test]
fn what_mjcf_refuses_is_refused_everywhere() {
    for (fields, number) in [
        (NEGATIVE, json!(-1.0)),
        (ZERO, json!(0.0)),
        (LARGE, json!(200)),
    ] {
        for field in fields.split_whitespace() {
            let name = field.replacen("opt/", "opt.", 1);
            let name = name.replacen("stat/", "stat.", 1);
            let name = name.split('/').next().unwrap();
            // of weightless bodies, the message names the body
            let name = if number == json!(0.0) && name.starts_with("body_") {
                "needs positive body_mass and body_inertia"
            } else {
                name
            };
            let pointer = format!("/{field}");
            refuses(|m| *m = changed(m, &pointer, &number), name);
        }
    }
    refuses(|m| m.opt.impratio = f64::NAN, "opt.impratio");
    refuses(|m| m.opt.density = f64::INFINITY, "opt");
    refuses(|m| m.opt.magnetic[1] = f64::NAN, "opt.magnetic");
    refuses(|m| m.dof_frictionloss[0] = f64::NAN, "dof_frictionloss");
    refuses(
        |m| m.actuator_gainprm[1].0[0] = f64::NAN,
        "actuator_gainprm[1]",
    );
    refuses(|m| m.geom_fluid[2].0[3] = f64::NAN, "geom_fluid[2]");
    refuses(|m| m.key_qpos[0][1] = f64::INFINITY, "key_qpos[0]");
    let quats: [Quats; 5] = [
        |m| &mut m.body_quat,
        |m| &mut m.body_iquat,
        |m| &mut m.geom_quat,
        |m| &mut m.site_quat,
        |m| &mut m.cam_quat,
    ];
    for quats in quats {
        refuses(|m| quats(m)[0] = [0.0; 4], "quat[0] is not of length 1");
    }
    refuses(|m| m.jnt_axis[1] = [0.0; 3], "jnt_axis[1]");
    let states: [fn(&mut CompiledModel) -> &mut Vec<f64>; 3] = [
        |m| &mut m.qpos0,
        |m| &mut m.qpos_spring,
        |m| &mut m.key_qpos[0],
    ];
    for joint in [2, 3] {
        for qpos in states {
            let message = format!("a quaternion of length 0, for joint {joint}");
            let zero = |m: &mut CompiledModel| {
                let end = m.jnt_qposadr[joint] + m.jnt_type[joint].nq();
                qpos(m)[end - 4..end].fill(0.0);
            };
            refuses(zero, &message);
        }
    }
}

#[test]
fn more_objects_than_the_engine_supports_are_refused_before_it_allocates() {
    refuses(
        |m| m.exclude_signature = vec![0; 4001],
        "4001 excludes: more than 4000",
    );
    refuses(
        |m| m.dof_bodyid = vec![0; 100_000],
        "100000 degrees of freedom: more than 4000",
    );
    refuses(
        |m| m.body_mocapid[1] = 2_000_000_000,
        "body_mocapid[1] is 2000000000, expected 0",
    );
}

/// What a change accepts can be simulated by every solver.
#[test]
fn a_number_is_refused_or_works() {
    let m = model();
    let figures = serde_json::to_value(&m).unwrap();
    let mut pointers = Vec::new();
    for (field, value) in figures.as_object().unwrap() {
        match value {
            Value::Object(parts) if field == "opt" => {
                pointers.extend(parts.keys().map(|part| format!("/opt/{part}")));
            }
            Value::Array(rows) => {
                for row in [0, rows.len() / 2, rows.len().saturating_sub(1)] {
                    match rows.get(row) {
                        Some(Value::Array(numbers)) => pointers
                            .extend((0..numbers.len()).map(|k| format!("/{field}/{row}/{k}"))),
                        Some(_) => pointers.push(format!("/{field}/{row}")),
                        None => {}
                    }
                }
            }
            _ => {}
        }
    }
    pointers.retain(|pointer| figures.pointer(pointer).is_some_and(Value::is_f64));
    assert!(pointers.len() > 300, "{}", pointers.len());
    let mut refused = 0;
    for (i, pointer) in pointers.iter().enumerate() {
        for number in [-1.0, 0.0, 1e3] {
            let mut m = m.clone();
            let change = |figures: &mut CompiledModel| {
                *figures = changed(figures, pointer, &json!(number));
                let solvers = [Solver::PGS, Solver::CG, Solver::Newton];
                let cones = [Cone::Pyramidal, Cone::Elliptic];
                (figures.opt.solver, figures.opt.cone) = (solvers[i % 3], cones[i % 2]);
                figures.opt.noslip_iterations = 3;
            };
            if m.change(change).is_err() {
                refused += 1;
                continue;
            }
            let mut d = Data::new(&m);
            d.ctrl.fill(0.5);
            (0..3).for_each(|_| step(&m, &mut d));
        }
    }
    assert!(refused > 50, "{refused}");
}

/// A number of an object, a kind or a place that a change accepts can be simulated.
#[test]
fn an_index_is_refused_or_works() {
    let m = model();
    let figures = serde_json::to_value(&m).unwrap();
    let mut pointers = Vec::new();
    for (field, value) in figures.as_object().unwrap() {
        let Value::Array(rows) = value else { continue };
        for row in [0, rows.len().saturating_sub(1)] {
            match rows.get(row) {
                Some(Value::Array(numbers)) => {
                    pointers.extend((0..numbers.len()).map(|k| format!("/{field}/{row}/{k}")));
                }
                Some(_) => pointers.push(format!("/{field}/{row}")),
                None => {}
            }
        }
    }
    pointers.retain(|pointer| {
        figures
            .pointer(pointer)
            .is_some_and(serde_json::Value::is_i64)
    });
    pointers.dedup();
    assert!(pointers.len() > 60, "{}", pointers.len());
    let mut refused = Vec::new();
    for pointer in &pointers {
        for number in [99_999, 1] {
            let mut other = figures.clone();
            *other.pointer_mut(pointer).unwrap() = json!(number);
            let Ok(other) = serde_json::from_value::<CompiledModel>(other) else {
                continue;
            };
            let mut m = m.clone();
            if m.change(|figures| *figures = other).is_err() {
                refused.push(pointer.as_str());
                continue;
            }
            let mut d = Data::new(&m);
            (0..3).for_each(|_| step(&m, &mut d));
        }
    }
    for reference in [
        "/pair_geom1/0",
        "/pair_geom2/0",
        "/geom_bodyid/4",
        "/jnt_bodyid/0",
    ] {
        assert!(refused.contains(&reference), "{reference}: {refused:?}");
    }
}
