//! Dog: stand, walk, trot, run, or fetch a ball, with a skeleton of 73 joints.
//!
//! | | |
//! |---|---|
//! | observation | `joint_angles`, `joint_velocites`, `torso_pelvis_height`, `z_projection`: the vertical in the frames of skull, torso and pelvis; `torso_com_velocity`, `inertial_sensors`, `foot_forces`, `touch_sensors`, `actuator_state`; with `fetch`, `ball_state` and `target_position`, as the head sees them |
//! | action | the muscles of back, neck and tail, the joints of head and legs, as a share of their strengths |
//! | reward | the product of the heights of torso and pelvis, upright head, torso and pelvis, weight on the feet, and a value of the speed; or of the distances from mouth to ball and from ball to target |
//! | start | standing, in any direction, moved and turned at random; with `fetch`, a ball is thrown to the middle |
//! | end | never |
//! | limit | 15 s: 1000 steps of 0.015 s |
//!
//! Differences from dm_control: none are known with `mujoco="3.12"`; dm_control 1.0.45 does not run
//! on 4.0, the default. The last bit of some numbers is numpy's with OpenBLAS's kernel for AVX2, for
//! which `OPENBLAS_CORETYPE=Zen` asks; on other CPUs dm_control's own differs. Masses and
//! inertias are those that libmujoco 3.12, or 4.0, computes from the bones' meshes, as numbers.
//! Pictures show the shapes that collide: bones and skin are left out.
//!
//! Source: dm_control 1.0.45, `suite/dog.py`.

use std::borrow::Cow;
use std::f64::consts::PI;

use gym_core::{Result, math};
use mujoco_engine::model::JointType;
use mujoco_engine::physics::forward;
use mujoco_engine::{Data, Model, Revision};

use super::avx2::{norm, times};
use super::axis::{ZX, ZZ};
use super::{check, config, minus};
use crate::domain::{SHAPELY, SHAPELY_STILL};
use crate::rewards::{Sigmoid, Tolerance};
use crate::{Domain, register};
use gym_sim::{Naming, Observation, SimTask, Simulation, Start};

/// The cosine of 30 degrees: skull, torso and pelvis may be as far from upright.
const UPRIGHT: f64 = 0.8660254037844387;
/// The half edge of the floor on which the ball lies.
const FLOOR: f64 = 10.0;
/// The radius of the target.
const TARGET: f64 = 0.1;

const LEVEL: Tolerance = Tolerance::above(UPRIGHT).margin(UPRIGHT + 1.0, Sigmoid::Linear(0.0));
const BITE: Tolerance = Tolerance::within(0.0, 0.005).margin(2.0, Sigmoid::Reciprocal);
const BRING: Tolerance = Tolerance::within(0.0, TARGET).margin(FLOOR, Sigmoid::Reciprocal);

config! { 15.0;
    /// The speed that is rewarded by 1; 0 for standing.
    #[unit = "m/s"]
    pub speed: f64 = 0.0,
    /// Whether the dog fetches a ball instead.
    pub fetch: bool = false,
}

/// The domain.
#[derive(Clone, Debug)]
pub struct Dog {
    torso: usize,
    pelvis: usize,
    skull: usize,
    head: usize,
    /// The hinges' positions in `qpos`, and in `qvel`.
    hinges: Vec<[usize; 2]>,
    heights: [Tolerance; 2],
    weight: Tolerance,
    goal: Goal,
}

#[derive(Clone, Debug)]
enum Goal {
    Stand,
    Move(Tolerance),
    Fetch(Ball),
}

/// The ball and the places that it is brought to.
#[derive(Clone, Debug)]
struct Ball {
    geom: usize,
    qpos: usize,
    dof: usize,
    target: usize,
    bites: [usize; 2],
}

impl Domain for Dog {
    type Config = Config;

    const NAME: &'static str = "Dog";

    const TIMESTEPS: usize = 3;

    fn text(config: &Config) -> Result<Cow<'static, str>> {
        check("speed", config.speed, 0.0, 1000.0)?;
        let (floor, props) = if config.fetch {
            (FLOOR, include_str!("../../models/dog_ball.xml"))
        } else {
            (15.0 * f64::max(1.0, config.speed), "")
        };
        let bones = if config.common.mujoco.0 == Revision::V3_12 {
            include_str!("../../models/dog_inertia_3_12.txt")
        } else {
            include_str!("../../models/dog_inertia_4_0.txt")
        };
        let mut text = include_str!("../../models/dog.xml").replace("{floor}", &floor.to_string());
        for (body, inertia) in bones.lines().filter_map(|line| line.split_once(' ')) {
            text = text.replace(&format!("{{{body}}}"), inertia);
        }
        Ok(text.replace("{props}", props.trim_end()).into())
    }

    fn new(config: &Config, s: &Simulation) -> Result<Self> {
        let (m, speed) = (&s.model, config.speed);
        let (torso, pelvis) = (s.body("torso")?, s.body("pelvis")?);
        let mut standing = Data::new(m);
        forward(m, &mut standing);
        let heights = [torso, pelvis].map(|body| {
            let height = standing.xpos[body][2] * 0.9;
            Tolerance::above(height).margin(height, Sigmoid::Gaussian)
        });
        let weight = -m.opt.gravity[2] * m.body_subtreemass[torso];
        let hinges = (0..m.njnt()).filter(|&j| m.jnt_type[j] == JointType::Hinge);
        let goal = if config.fetch {
            let joint = s.joint("ball_root")?;
            Goal::Fetch(Ball {
                geom: s.geom("ball")?,
                qpos: m.jnt_qposadr[joint],
                dof: m.jnt_dofadr[joint],
                target: s.geom("target")?,
                bites: [s.site("upper_bite")?, s.site("lower_bite")?],
            })
        } else if speed > 0.0 {
            let moving = Tolerance::within(speed, 2.0 * speed);
            Goal::Move(moving.margin(f64::max(1.0, speed), Sigmoid::Linear(0.0)))
        } else {
            Goal::Stand
        };
        Ok(Self {
            torso,
            pelvis,
            skull: s.body("skull")?,
            head: s.site("head")?,
            hinges: hinges
                .map(|j| [m.jnt_qposadr[j], m.jnt_dofadr[j]])
                .collect(),
            heights,
            weight: Tolerance::above(weight).margin(weight, Sigmoid::Linear(0.9)),
            goal,
        })
    }
}

impl Dog {
    /// The velocity of the centre of mass in the torso's frame.
    fn velocity(&self, d: &Data) -> [f64; 3] {
        let velocity = [0, 1, 2].map(|k| d.sensordata[9 + k]);
        times(velocity, &d.xmat[self.torso])
    }

    fn throw(&self, start: &mut Start<'_>, ball: &Ball) {
        let radius = 0.75 * FLOOR;
        let azimuth = start.uniform(0.0, 2.0 * PI);
        let (sin, cos) = (math::sin(azimuth), math::cos(azimuth));
        let place = [radius * sin, radius * cos, 0.05];
        start.data.qpos[ball.qpos..ball.qpos + 3].copy_from_slice(&place);
        let height = start.uniform(0.0, 3.0);
        let gravity = -start.model().opt.gravity[2];
        let up = (2.0 * gravity * height).sqrt();
        let speed = start.uniform(0.0, 5.0);
        let direction = [sin, cos].map(|x| -x + 0.05 * start.rng.standard_normal());
        let velocity = [speed * direction[0], speed * direction[1], up];
        start.data.qvel[ball.dof..ball.dof + 3].copy_from_slice(&velocity);
    }
}

/// The linear velocity of a point of a body, in the world's frame: MuJoCo's `mj_objectVelocity`.
fn velocity_at(m: &Model, d: &Data, body: usize, point: [f64; 3]) -> [f64; 3] {
    let [x, y, z] = minus(point, d.subtree_com[m.body_rootid[body]]);
    let [wx, wy, wz, vx, vy, vz] = d.cvel[body];
    let turned = [y * wz - z * wy, z * wx - x * wz, x * wy - y * wx];
    minus([vx, vy, vz], turned)
}

impl SimTask for Dog {
    fn start(&self, start: &mut Start<'_>) -> Result<()> {
        let azimuth = start.uniform(0.0, 2.0 * PI);
        let orientation = [math::cos(azimuth / 2.0), 0.0, 0.0, math::sin(azimuth / 2.0)];
        start.data.qpos[3..7].copy_from_slice(&orientation);
        for k in [0, 1, 5] {
            start.data.qvel[k] = 2.0 * start.rng.standard_normal();
        }
        for i in 0..start.model().nu() {
            let [low, high] = start.model().actuator_ctrlrange[i];
            start.data.act[i] = start.uniform(low, high);
        }
        if let Goal::Fetch(ball) = &self.goal {
            self.throw(start, ball);
        }
        Ok(())
    }

    fn observe(&self, m: &Model, d: &Data, out: &mut Observation) {
        let hinges = self.hinges.iter();
        out.vector("joint_angles", hinges.clone().map(|hinge| d.qpos[hinge[0]]));
        out.vector("joint_velocites", hinges.map(|hinge| d.qvel[hinge[1]]));
        let heights = [self.torso, self.pelvis].map(|body| d.xpos[body][2]);
        out.vector("torso_pelvis_height", heights);
        let bodies = [self.skull, self.torso, self.pelvis].into_iter();
        out.vector(
            "z_projection",
            bodies.flat_map(|body| d.xmat[body][ZX..].iter().copied()),
        );
        out.vector("torso_com_velocity", self.velocity(d));
        out.vector("inertial_sensors", d.sensordata[..9].iter().copied());
        out.vector("foot_forces", d.sensordata[16..28].iter().copied());
        out.vector("touch_sensors", d.sensordata[12..16].iter().copied());
        out.vector("actuator_state", d.act.iter().copied());
        if let Goal::Fetch(ball) = &self.goal {
            let (pos, mat) = (d.site_xpos[self.head], &d.site_xmat[self.head]);
            let place = d.geom_xpos[ball.geom];
            let own = velocity_at(m, d, m.site_bodyid[self.head], pos);
            let moves = velocity_at(m, d, m.geom_bodyid[ball.geom], place);
            let state = [minus(place, pos), minus(moves, own)].map(|part| times(part, mat));
            out.vector("ball_state", state.into_iter().flatten());
            let target = times(minus(d.geom_xpos[ball.target], pos), mat);
            out.vector("target_position", target);
        }
    }

    fn names(&self, names: &mut Naming<'_>) {
        names.part("joint_angles");
        for [position, _] in &self.hinges {
            names.add(names.position(*position));
        }
        names.part("joint_velocites");
        for [_, dof] in &self.hinges {
            names.add(names.velocity(*dof));
        }
        let height = &["torso", "pelvis"];
        names
            .part("torso_pelvis_height")
            .each(height, "height of {} (m)");
        names.part("z_projection");
        for body in ["skull", "torso", "pelvis"] {
            names.xyz(&format!("{{}} of the vertical in the frame of {body}"));
        }
        let velocity = "velocity of the centre of mass along the torso's {} (m/s)";
        names.part("torso_com_velocity").xyz(velocity);
        names.part("inertial_sensors").sensors(..9);
        names.part("foot_forces").sensors(16..28);
        names.part("touch_sensors").sensors(12..16);
        names.part("actuator_state").activations();
        if let Goal::Fetch(_) = &self.goal {
            names.part("ball_state");
            names.xyz("{} from head to ball in the head's frame (m)");
            names.xyz("velocity of ball against head along the head's {} (m/s)");
            names.part("target_position");
            names.xyz("{} from head to target in the head's frame (m)");
        }
    }

    fn reward(&self, _: &Model, d: &Data) -> f64 {
        let mut reward = self.heights[0].of(d.xpos[self.torso][2]);
        reward *= self.heights[1].of(d.xpos[self.pelvis][2]);
        for body in [self.skull, self.torso, self.pelvis] {
            reward *= LEVEL.of(d.xmat[body][ZZ]);
        }
        reward *= self.weight.of(d.sensordata[12..16].iter().sum());
        match &self.goal {
            Goal::Stand => reward,
            Goal::Move(speed) => reward * ((4.0 * speed.of(self.velocity(d)[0]) + 1.0) / 5.0),
            Goal::Fetch(ball) => {
                let place = d.geom_xpos[ball.geom];
                let [upper, lower] = ball.bites.map(|site| norm(minus(place, d.site_xpos[site])));
                let left = norm(minus(place, d.geom_xpos[ball.target]));
                let reach = if left < 2.0 * TARGET {
                    1.0
                } else {
                    (6.0 * BITE.of(0.5 * (upper + lower)) + 1.0) / 7.0
                };
                reward * reach * ((BRING.of(left) + 1.0) / 2.0)
            }
        }
    }
}

gym_core::register!(
    register::<Dog>("dm_control/dog-stand-v0", "Stand on four feet.").exceptions(SHAPELY),
    register::<Dog>("dm_control/dog-walk-v0", "Walk on four feet.")
        .exceptions(SHAPELY)
        .kwargs(r#"{"speed": 1.0}"#),
    register::<Dog>("dm_control/dog-trot-v0", "Trot on four feet.")
        .exceptions(SHAPELY)
        .kwargs(r#"{"speed": 3.0}"#),
    register::<Dog>("dm_control/dog-run-v0", "Run on four feet.")
        .exceptions(SHAPELY)
        .kwargs(r#"{"speed": 9.0}"#),
    register::<Dog>("dm_control/dog-fetch-v0", "Fetch a thrown ball.")
        .exceptions(SHAPELY_STILL)
        .kwargs(r#"{"fetch": true}"#),
);
