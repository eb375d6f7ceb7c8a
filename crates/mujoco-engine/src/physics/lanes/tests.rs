use std::sync::Arc;

use super::*;
use crate::{Data, Result, Revision, forward, step};

/// Returns SIMD levels of this CPU with registers of several widths.
pub(crate) fn levels() -> Vec<Level> {
    let level = Level::new();
    let mut levels = vec![level, Level::baseline()];
    #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
    levels.extend(level.as_avx2().map(Level::Avx2));
    levels
}

/// Returns a step of two timesteps that computes all derived arrays.
fn stride() -> Stride {
    Stride {
        steps: 2,
        settles: false,
        contact_forces: true,
        reads: Derived::ALL.to_vec(),
    }
}

pub(crate) fn random(seed: u64) -> impl FnMut() -> f64 {
    let mut seed = seed;
    move || {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (seed >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }
}

impl Batch {
    /// Fills every buffer with NaN.
    fn poison(&mut self, m: &Model) {
        self.arrays.poison(m);
        self.rows.poison();
        match &mut self.method {
            Method::Newton(newton) => newton.poison(),
            Method::GaussSeidel(gauss_seidel) => gauss_seidel.poison(),
            Method::Gathered(alone, newton) => {
                alone.poison();
                newton.poison();
            }
            Method::Alone(alone) => alone.poison(),
        }
        crate::physics::work::Poison::poison(&mut self.cfrc_ext);
    }
}

fn act(d: &mut Data, random: &mut impl FnMut() -> f64) {
    d.ctrl.iter_mut().for_each(|ctrl| *ctrl = random());
}

macro_rules! models {
    ($($name:literal)+) => {
        [$(($name, include_str!(concat!("../../../../gym-mujoco/models/", $name)))),+]
    };
}

/// The names and the texts of models.
const MODELS: [(&str, &str); 13] = models!(
    "ant.xml" "half_cheetah.xml" "hopper.xml" "humanoid.xml" "humanoidstandup.xml"
    "inverted_double_pendulum.xml" "inverted_pendulum.xml" "pusher.xml" "pusher_v5.xml" "reacher.xml"
    "swimmer.xml" "walker2d.xml" "walker2d_v5.xml"
);

fn load_model(name: &str, revision: Revision) -> Result<Arc<Model>> {
    let (_, text) = MODELS.iter().find(|(known, _)| *known == name).unwrap();
    Model::from_xml_with(text, revision).map(Arc::new)
}

/// Iterates over all models in all revisions.
fn all() -> impl Iterator<Item = (String, Arc<Model>)> {
    MODELS.into_iter().flat_map(|(name, _)| {
        Revision::ALL.map(|revision| {
            (
                format!("{name} {revision}"),
                load_model(name, revision).unwrap(),
            )
        })
    })
}

/// Asserts that arrays of a world have the same bits as in `Data`.
macro_rules! same {
    ($worlds:ident, $world:ident, $data:ident, $what:expr, $($name:ident)+) => {$(
        for (rows, numbers) in $worlds.$name.iter().zip(&$data.$name) {
            let rows: &[PerWorld] = rows;
            for (row, x) in rows.iter().zip(numbers) {
                assert_eq!(row.0[$world].to_bits(), x.to_bits(), "{} {}", stringify!($name), $what);
            }
        }
    )+};
}

fn smooth<S: Simd>(a: &mut Arrays, m: &Model, simd: S) {
    for first in (0..WORLDS).step_by(<Lanes<S> as Real>::LANES) {
        let at = (simd, first);
        simd.vectorize(
            #[inline(always)]
            || {
                a.positions(m, at, true);
                a.matrix(m, at);
                a.velocities(m, at);
            },
        );
    }
}

#[test]
fn smooth_stages_have_the_bits_of_one_world() {
    for (name, m) in all() {
        let mut random = random(7);
        let mut alone: Vec<Data> = (0..WORLDS).map(|_| Data::new(&m)).collect();
        for (world, d) in alone.iter_mut().enumerate() {
            // some worlds stay where they begin, and some have a zero angle
            for _ in 0..world * 7 {
                act(d, &mut random);
                step(&m, d);
            }
            forward(&m, d);
        }
        for level in levels() {
            let mut worlds = Batch::new(&m, &stride());
            for (world, d) in alone.iter().enumerate() {
                worlds.gather(world, &[&d.qpos[..], &d.qvel].concat());
            }
            let a = &mut worlds.arrays;
            match width(level) {
                #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
                Some(8) => smooth(a, &m, level.as_avx512().unwrap()),
                #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
                Some(4) => smooth(a, &m, level.as_avx2().unwrap()),
                _ => continue,
            }
            for (world, d) in alone.iter().enumerate() {
                let what = format!("{name}, world {world}");
                same!(a, world, d, what,
                    xpos xquat xmat xipos ximat xanchor xaxis geom_xpos geom_xmat site_xpos site_xmat
                    subtree_com cinert cdof cdof_dot cvel);
                for (row, x) in a.qfrc_bias.iter().zip(&d.qfrc_bias) {
                    assert_eq!(row.0[world].to_bits(), x.to_bits(), "{what}");
                }
                for i in 0..m.nv() {
                    for k in m.plan().m_row(i) {
                        assert_eq!(a.qm[k].0[world].to_bits(), d.qm[k].to_bits(), "{what}");
                    }
                }
            }
        }
    }
}

/// From the same states, worlds take steps together and alone. Some worlds have no contacts, some
/// fall, and one diverges. Returns the number of steps that were taken together.
fn compare(name: &str, m: &Model, stride: &Stride, numbers: &[usize]) -> usize {
    let mut stepped = 0;
    for level in levels() {
        for &len in numbers {
            let mut random = random(3);
            let mut worlds = Batch::new(m, stride);
            let mut alone: Vec<Data> = (0..len).map(|_| Data::new(m)).collect();
            for (world, d) in alone.iter_mut().enumerate() {
                for _ in 0..5 * world {
                    act(d, &mut random);
                    step(m, d);
                }
                // the moment arms of the actuators
                forward(m, d);
            }
            let mut record = vec![0.0; record_len(m, &stride.reads)];
            for round in 0..60 {
                if round % 3 == 2 {
                    worlds.poison(m);
                }
                for (world, d) in alone.iter_mut().enumerate() {
                    act(d, &mut random);
                    if round == 40 && world == 1 {
                        d.qvel[0] = 1e11;
                    }
                    let state = [&d.qpos[..], &d.qvel, &d.qacc_warmstart].concat();
                    crate::physics::fwd_actuation(m, d);
                    worlds.gather(world, &[&state[..], &d.qfrc_actuator].concat());
                }
                if !worlds.step(m, level, len, 2) {
                    break;
                }
                for (world, d) in alone.iter_mut().enumerate() {
                    step(m, d);
                    let before = [&d.qpos[..], &d.qvel, &d.qacc_warmstart].concat();
                    step(m, d);
                    let state = [&d.qpos[..], &d.qvel, &d.qacc_warmstart].concat();
                    let fine = worlds.scatter(m, world, &stride.reads, &mut record);
                    if round == 40 && world == 1 {
                        assert!(!fine, "{name}");
                        continue;
                    }
                    let what = format!("{name} {level:?}, world {world} of {len}, round {round}");
                    assert!(fine, "{what}");
                    crate::physics::rne_post_constraint(m, d);
                    let mut expected = [state, before].concat();
                    for array in &stride.reads {
                        expected.extend_from_slice(array.of_data(d));
                    }
                    let bits = |x: &f64| x.to_bits();
                    assert!(
                        record.iter().map(bits).eq(expected.iter().map(bits)),
                        "{what}"
                    );
                    stepped += 1;
                }
            }
        }
    }
    stepped
}

#[test]
fn steps_have_the_bits_of_one_world() {
    let fitting = all().filter(|(_, m)| fits(m, &stride()));
    let stepped = fitting.map(|(name, m)| compare(&name, &m, &stride(), &[1, 5, WORLDS]));
    let stepped: usize = stepped.sum();
    assert!(stepped > 0 || width(Level::new()).is_none());
}

/// A model with all constraints of worlds that step together: several trees, limits and dry friction
/// of joints and tendons, equalities, boxes, contacts of all dimensions.
const CONSTRAINED: &str = r#"<mujoco><worldbody>
  <geom type="plane" size="5 5 1"/>
  <body pos="0 0 .1"><joint axis="0 1 0" damping=".1" frictionloss=".05"/>
    <geom type="capsule" fromto="0 0 0 .4 0 0" size=".05" condim="4"/><site name="a" pos=".1 0 .1"/>
    <body pos=".4 0 0"><joint name="j" axis="0 1 0" range="-60 60" limited="true" damping=".2"/>
      <geom type="capsule" fromto="0 0 0 .3 0 0" size=".04" condim="6"/><site name="s" pos=".3 0 0"/></body></body>
  <body pos="1 0 .15"><freejoint/><geom type="box" size=".1 .12 .14"/></body>
  <body pos="1.02 .01 .45"><freejoint/><geom type="box" size=".1 .1 .1" condim="1"/></body>
  <body pos=".6 .02 .5"><freejoint/><geom size=".1" friction=".4 .02 .003" condim="6"/></body>
  <body pos="-1 0 .12"><joint name="x" type="slide" axis="0 0 1" range="-.05 1" limited="true"/><geom type="cylinder" size=".1 .1"/></body>
  </worldbody>
  <tendon><fixed name="t" limited="true" range="-.4 .4" frictionloss=".02"><joint joint="j" coef="1"/></fixed>
    <fixed name="v"><joint joint="x" coef="1"/></fixed>
    {string}</tendon>
  <equality><joint joint1="x" joint2="j" polycoef="0 .1 0 0 0"/><tendon tendon1="v" tendon2="t" polycoef="0 .1 0 0 0"/></equality>
  <actuator><motor joint="j" gear=".5"/><motor tendon="t" gear=".3"/></actuator></mujoco>"#;

/// A tendon between sites.
const STRING: &str =
    r#"<spatial limited="true" range="0 .35"><site site="s"/><site site="a"/></spatial>"#;

/// How worlds of a model make their rows, and solve.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Way {
    Together,
    SolveTogether,
    Alone,
}

impl Way {
    fn of(m: &Model) -> Self {
        match (fits::makes_rows(m), fits::gathers(m)) {
            (true, _) => Self::Together,
            (_, true) => Self::SolveTogether,
            _ => Self::Alone,
        }
    }
}

/// Compares worlds of [`CONSTRAINED`] in two revisions, or in all if they solve together, with a
/// tendon between sites and without.
fn constrained(option: &str, change: impl Fn(String) -> String, way: Way) -> usize {
    let (mut stepped, skip) = (0, if way == Way::SolveTogether { 1 } else { 2 });
    let strings = [STRING, "", "", STRING];
    for (revision, string) in Revision::ALL.into_iter().zip(strings).step_by(skip) {
        let mut stride = stride();
        if !string.is_empty() {
            stride.reads.retain(|array| *array != Derived::CfrcExt);
        }
        let text = change(CONSTRAINED.replace("{string}", string));
        let text = text.replace("<mujoco>", &format!("<mujoco><option {option}/>"));
        let m = Model::from_xml_with(&text, revision).unwrap();
        assert!(fits(&m, &stride) && Way::of(&m) == way, "{option}");
        stepped += compare(&format!("{revision} {option}"), &m, &stride, &[WORLDS - 1]);
        if way == Way::SolveTogether {
            stepped += compare(&format!("{revision} {option}"), &m, &stride, &[1, WORLDS]);
        }
    }
    stepped
}

#[test]
fn worlds_that_solve_alone_have_the_bits_of_one_world() {
    let options = [
        r#"cone="elliptic" impratio="3""#,
        r#"integrator="RK4" noslip_iterations="2""#,
        r#"solver="CG""#,
        r#"solver="PGS" cone="elliptic""#,
    ];
    let stepped = options.map(|option| constrained(option, |text| text, Way::Alone));
    assert!(stepped.iter().sum::<usize>() > 0 || width(Level::new()).is_none());
}

#[test]
fn worlds_that_make_rows_alone_have_the_bits_of_one_world() {
    let dim = |dim: &'static str| {
        move |text: String| {
            let parts = text.split(" condim=\"");
            let text: String = parts
                .map(|part| {
                    part.strip_prefix(['1', '4', '6'])
                        .map_or(part, |rest| &rest[1..])
                })
                .collect();
            text.replace("<geom ", &format!("<geom condim=\"{dim}\" "))
        }
    };
    let way = Way::SolveTogether;
    let mut stepped = constrained("", |text| text, way);
    stepped += constrained(r#"impratio="3" integrator="RK4""#, dim("4"), way);
    for option in [
        r#"cone="elliptic""#,
        r#"cone="elliptic" impratio="3" integrator="RK4""#,
        r#"cone="elliptic"><flag island="disable" warmstart="disable"/></option><size memory="1M""#,
    ] {
        stepped += constrained(option, dim("3"), way);
    }
    for other in ["1", "4", "6"] {
        stepped += constrained(r#"cone="elliptic""#, dim(other), way);
    }
    assert!(stepped > 0 || width(Level::new()).is_none());
}

#[test]
fn islands_have_the_bits_of_one_world() {
    // without dry friction, equalities, and contacts that turn
    let plain = |text: String| {
        let (start, rest) = text.split_once("<equality>").unwrap();
        let (_, end) = rest.split_once("</equality>").unwrap();
        let text = format!("{start}{end}").replace("frictionloss", "margin");
        text.replace(r#"condim="4""#, "")
            .replace(r#"condim="6""#, "")
    };
    let options = ["", r#"integrator="RK4""#].map(|option| {
        let together = constrained(option, plain, Way::Together);
        let option = format!("{option}><flag island=\"disable\"/></option><size memory=\"1M\"");
        together + constrained(&option, plain, Way::Together)
    });
    assert!(options.iter().sum::<usize>() > 0 || width(Level::new()).is_none());
}

/// A model with every sensor and tendon that worlds can measure together. Its body falls and
/// touches the floor.
const MEASURED: &str = r#"<mujoco>
  <option timestep="0.005"/>
  <default><motor ctrllimited="true" ctrlrange="-1 1" gear="2"/></default>
  <worldbody>
    <geom type="plane" size="5 5 1"/>
    <body name="mark" mocap="true" pos="0 0.5 0.2"><geom size="0.05" contype="0" conaffinity="0"/></body>
    <body name="torso" pos="0 0 0.35">
      <freejoint/>
      <geom type="capsule" size="0.05 0.2" euler="0 80 0"/>
      <site name="back" pos="-0.1 0 0.02" euler="10 20 30"/>
      <body name="leg" pos="0.2 0 0">
        <joint name="hip" axis="0 1 0" range="-60 60" limited="true" damping="0.2"/>
        <geom type="capsule" size="0.03" fromto="0 0 0 0.05 0.02 -0.2"/>
        <site name="foot" pos="0.05 0.02 -0.2" size="0.05"/>
        <site name="knee" pos="0.02 0 -0.1" type="box" size="0.1 0.1 0.2"/>
      </body>
    </body>
  </worldbody>
  <tendon><fixed name="pull" stiffness="{stiffness}" springlength="0.1 0.2"><joint joint="hip" coef="0.7"/></fixed></tendon>
  <actuator>{actuators}</actuator>
  <sensor>
    <touch site="foot"/><subtreelinvel body="torso"/><velocimeter site="back"/><gyro site="foot"/>
    <touch site="knee"/><subtreelinvel body="leg"/><accelerometer site="back"/>
  </sensor>
</mujoco>"#;

/// With `settles`, a step ends with `step1` of the next step: frames and sensors belong to the new
/// state.
#[test]
fn settled_steps_have_the_bits_of_one_world() {
    let mut touched = 0;
    let motors = r#"<motor joint="hip"/><motor tendon="pull"/>"#;
    let servos = r#"<position joint="hip" kp="3"/><position tendon="pull" kp="2" gear="0.5"/>"#;
    let all = Revision::ALL
        .into_iter()
        .flat_map(|revision| [(revision, motors, "0"), (revision, servos, "2.5")]);
    for (revision, actuators, stiffness) in all {
        let text = MEASURED
            .replace("{actuators}", actuators)
            .replace("{stiffness}", stiffness);
        let m = Model::from_xml_with(&text, revision).unwrap();
        let stride = Stride {
            steps: 3,
            settles: true,
            contact_forces: false,
            reads: vec![
                Derived::Xpos,
                Derived::Xmat,
                Derived::GeomXpos,
                Derived::Sensors(14),
            ],
        };
        assert!(fits(&m, &stride));
        for level in levels() {
            let mut random = random(5);
            let mut worlds = Batch::new(&m, &stride);
            let mut alone: Vec<Data> = (0..WORLDS).map(|_| Data::new(&m)).collect();
            let mut record = vec![0.0; record_len(&m, &stride.reads)];
            for round in 0..80 {
                if round % 3 == 2 {
                    worlds.poison(&m);
                }
                for (world, d) in alone.iter_mut().enumerate() {
                    d.mocap_pos[0] = [random(), random(), random()];
                    act(d, &mut random);
                    if round % 30 == 0 {
                        d.qpos[2] = 0.3 + 0.05 * world as f64;
                    }
                    forward(&m, d);
                    let mut inputs = d.ctrl.clone();
                    for (i, input) in inputs.iter_mut().enumerate() {
                        if m.actuator_ctrllimited[i] {
                            *input = input.clamp(-1.0, 1.0);
                        }
                        *input *= m.actuator_gainprm[i].0[0];
                    }
                    let mocap = [d.mocap_pos.as_flattened(), d.mocap_quat.as_flattened()];
                    let parts = [
                        &d.qpos[..],
                        &d.qvel,
                        &d.qacc_warmstart,
                        &d.qfrc_actuator,
                        mocap[0],
                        mocap[1],
                        &inputs,
                    ];
                    worlds.gather(world, &parts.concat());
                }
                if !worlds.step(&m, level, WORLDS, 3) {
                    break;
                }
                for (world, d) in alone.iter_mut().enumerate() {
                    for _ in 0..3 {
                        step(&m, d);
                    }
                    crate::step1(&m, d);
                    let what = format!("{revision} {level:?}, world {world}, round {round}");
                    if !worlds.scatter(&m, world, &stride.reads, &mut record) {
                        // a world that diverges takes this step alone, and restarts
                        assert!(d.time < 4.0 * m.opt.timestep, "{what}");
                        continue;
                    }
                    let state = [&d.qpos[..], &d.qvel, &d.qacc_warmstart].concat();
                    let mut derived = Vec::new();
                    for array in &stride.reads {
                        derived.extend_from_slice(array.of_data(d));
                    }
                    let bits = |numbers: &[f64]| -> Vec<u64> {
                        numbers.iter().map(|x| x.to_bits()).collect()
                    };
                    let (own, rest) = record.split_at(state.len());
                    assert_eq!(bits(own), bits(&state), "{what}");
                    let rest = &rest[state.len()..][..derived.len()];
                    assert_eq!(bits(rest), bits(&derived), "{what}");
                    touched += usize::from(d.sensordata[0] > 0.0 && d.sensordata[10] > 0.0);
                }
            }
        }
    }
    assert!(touched > 0 || width(Level::new()).is_none());
}
