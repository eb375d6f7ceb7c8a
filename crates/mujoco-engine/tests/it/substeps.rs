//! The calls that leave out what nobody reads give what those that leave nothing out give.

use mujoco_engine::model::Disable;
use mujoco_engine::physics::{forward_without_actuators, substep, substep2};
use mujoco_engine::{CompiledModel, Data, Model, forward, step, step1, step2};

/// A hopper that falls to the floor, with sensors of each stage.
fn hopper(option: &str, actuators: &str) -> Model {
    let text = format!(
        r#"<mujoco><option timestep=".005" {option}><flag energy="enable"/></option>
  <worldbody><geom type="plane" size="3 3 .1"/>
    <body pos="0 0 .5"><joint name="x" type="slide" axis="1 0 0"/><joint name="z" type="slide" axis="0 0 1"/>
      <geom type="box" size=".1 .1 .05"/><site name="top" pos=".02 0 .05"/>
      <body pos="0 0 -.05"><joint name="hip" axis="0 1 0"/><geom type="capsule" fromto="0 0 0 .05 0 -.2" size=".03"/>
        <body pos=".05 0 -.2"><joint name="knee" axis="0 1 0" stiffness="2" damping=".1"/>
          <geom type="sphere" size=".05" pos="-.05 0 -.2"/><site name="foot" pos="-.05 0 -.2" size=".06"/></body></body></body>
  </worldbody>
  <actuator>{actuators}</actuator>
  <sensor><touch site="foot"/><gyro site="top"/><accelerometer site="foot"/><rangefinder site="foot"/><framepos objtype="site" objname="foot"/>
    <jointactuatorfrc joint="hip"/></sensor></mujoco>"#
    );
    Model::from_xml(&text).unwrap()
}

const MOTORS: &str = r#"<motor joint="hip" gear="5"/><motor joint="knee" gear="3"/>"#;
const SERVOS: &str = r#"<position joint="hip" kp="20" dampratio="1"/><intvelocity joint="knee" kp="9" actrange="-1 1"/>"#;

fn models() -> impl Iterator<Item = (&'static str, Model)> {
    let integrators = ["Euler", "RK4", "implicitfast"].into_iter();
    integrators.flat_map(|name| {
        let option = format!("integrator={name:?}");
        [MOTORS, SERVOS].map(|actuators| (name, hopper(&option, actuators)))
    })
}

/// The state, and all that a step computes.
fn seen(d: &Data) -> impl PartialEq + std::fmt::Debug {
    let state = [&d.qpos, &d.qvel, &d.act, &d.qacc, &d.qacc_warmstart].map(Clone::clone);
    let frames = [d.site_xpos.clone(), d.geom_xpos.clone(), d.xpos.clone()];
    (
        state,
        frames,
        d.sensordata.clone(),
        d.energy,
        d.contact.len(),
    )
}

fn control(d: &mut Data, step: usize) {
    for (i, ctrl) in d.ctrl.iter_mut().enumerate() {
        *ctrl = (0.7 * (step + 3 * i) as f64).sin();
    }
}

#[test]
fn the_last_step_of_several_computes_everything() {
    for (name, m) in models() {
        let (mut one, mut other) = (Data::new(&m), Data::new(&m));
        let mut touched = false;
        for i in 0..200 {
            control(&mut one, i);
            control(&mut other, i);
            step(&m, &mut one);
            if i % 4 < 3 {
                substep(&m, &mut other);
                assert_eq!((&one.qpos, &one.qvel), (&other.qpos, &other.qvel), "{name}");
            } else {
                step(&m, &mut other);
                assert_eq!(seen(&one), seen(&other), "{name} {i}");
                touched |= one.sensordata[0] > 0.0;
            }
        }
        assert!(touched);
    }
}

#[test]
fn a_second_half_without_sensors_leads_to_the_same_state() {
    for (name, m) in models() {
        let (mut one, mut other) = (Data::new(&m), Data::new(&m));
        for i in 0..100 {
            for d in [&mut one, &mut other] {
                step1(&m, d);
                control(d, i);
            }
            let before = other.sensordata.clone();
            step2(&m, &mut one);
            substep2(&m, &mut other);
            assert_eq!(other.sensordata, before, "{name}");
            assert_eq!((&one.qpos, &one.qvel), (&other.qpos, &other.qvel), "{name}");
        }
    }
}

#[test]
fn actuators_are_left_out_as_by_their_flag() {
    for (name, m) in models() {
        let mut compiled = CompiledModel::clone(&m);
        compiled.opt.disableflags |= Disable::Actuation as u32;
        let without = Model::new(compiled).unwrap();
        let (mut d, mut flagged) = (Data::new(&m), Data::new(&without));
        for i in 0..50 {
            control(&mut d, i);
            step(&m, &mut d);
        }
        for (to, from) in [
            (&mut flagged.qpos, &d.qpos),
            (&mut flagged.qvel, &d.qvel),
            (&mut flagged.act, &d.act),
            (&mut flagged.ctrl, &d.ctrl),
            (&mut flagged.qacc_warmstart, &d.qacc_warmstart),
        ] {
            to.clone_from(from);
        }
        forward(&without, &mut flagged);
        let mut actuated = d.clone();
        forward(&m, &mut actuated);
        forward_without_actuators(&m, &mut d);
        assert_eq!(seen(&d), seen(&flagged), "{name}");
        assert_eq!(d.qfrc_actuator, flagged.qfrc_actuator, "{name}");
        assert_ne!(d.qacc, actuated.qacc, "{name}");
        // the next call has them again
        d.qacc_warmstart.clone_from(&actuated.qacc_warmstart);
        forward(&m, &mut d);
        assert_eq!(d.qfrc_actuator, actuated.qfrc_actuator, "{name}");
    }
}

#[test]
fn bodies_fall_asleep_in_the_middle_of_a_step() {
    let text = r#"<mujoco><option timestep=".01" sleep_tolerance=".05"><flag sleep="enable"/></option>
  <worldbody><geom type="plane" size="3 3 .1"/>
    <body pos="0 0 .15" euler="10 0 0"><freejoint/><geom type="box" size=".1 .1 .1"/><site name="top" pos="0 0 .1"/></body></worldbody>
  <sensor><gyro site="top"/><accelerometer site="top"/><framepos objtype="site" objname="top"/></sensor></mujoco>"#;
    let m = Model::from_xml(text).unwrap();
    let (mut one, mut other) = (Data::new(&m), Data::new(&m));
    let mut slept = 0;
    for i in 0..600 {
        step(&m, &mut one);
        let part = if i % 7 < 6 { substep } else { step };
        part(&m, &mut other);
        assert_eq!(one.sensordata, other.sensordata, "{i}");
        assert_eq!(
            (&one.qpos, &one.tree_asleep),
            (&other.qpos, &other.tree_asleep),
            "{i}"
        );
        slept += usize::from(one.tree_asleep[0] >= 0);
    }
    assert!(slept > 100, "{slept}");
}
