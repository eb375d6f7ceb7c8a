//! Quadruped: walk, run, climb out of a bowl of bumps, or bring a ball to the middle, on four legs.
//!
//! | | |
//! |---|---|
//! | observation | `egocentric_state`: angles and speeds of the joints, and the states of the filters of the motors; `torso_velocity`; `torso_upright`; `imu`: accelerometer and gyroscope; `force_torque`: at the toes; with the goal `escape`, `origin` and `rangefinder`; with `fetch`, `ball_state` and `target_position` |
//! | action | for each leg, the targets of the servos that turn, lift and extend it |
//! | reward | upright, times a value of the speed, of the distance from the middle, or of the distances from robot to ball and from ball to target |
//! | start | any orientation, just above the ground; with `fetch`, upright at random, with a ball that falls at random; with `escape`, on other terrain each time |
//! | end | never |
//! | limit | 20 s: 1000 steps of 0.02 s |
//!
//! The forces at the toes are observed as their inverse hyperbolic sines, the ranges as hyperbolic
//! tangents; a ray that meets nothing has 1.
//!
//! Differences from dm_control: none are known with `mujoco="3.12"`; dm_control 1.0.45 does not run
//! on 4.0, the default. The last bit of some numbers is numpy's with OpenBLAS's kernel for AVX2, for which
//! `OPENBLAS_CORETYPE=Zen` asks; on other CPUs dm_control's own differs. Camera 0 is at the side
//! of the robot, instead of far away.
//!
//! Source: dm_control 1.0.45, `suite/quadruped.py`.

mod model;
mod terrain;

use std::borrow::Cow;
use std::f64::consts::{PI, SQRT_2};

use gym_core::{ArgumentType, Error, Result, math};
use gym_sim::numpy::{arcsinh, tanh};
use mujoco_engine::{CompiledModel, Data, Model};
use serde::{Deserialize, Serialize};

use super::avx2::{norm, times};
use super::axis::ZZ;
use super::{check, config, minus};
use crate::domain::SHAPELY_STILL;
use crate::rewards::{Sigmoid, Tolerance};
use crate::{Domain, register};
use gym_sim::{Naming, Observation, Rng, SimTask, Simulation, Start};

/// The half edge of the floor on which the ball lies.
const FLOOR: f64 = 15.0;
/// The half edge of the terrain.
const TERRAIN: f64 = 30.0;
/// How far from upright the torso may be on terrain: the cosine of 20 degrees.
const SLANTED: f64 = 0.9396926207859084;
/// The heights that are tried for a start: 1 cm apart.
const HEIGHTS: usize = 10_000;

const REACH: Tolerance = Tolerance::within(0.0, 0.3 + 0.15).margin(ARENA, Sigmoid::Linear(0.0));
const BRING: Tolerance = Tolerance::within(0.0, 0.4).margin(ARENA, Sigmoid::Linear(0.0));
const ESCAPE: Tolerance = Tolerance::above(TERRAIN).margin(TERRAIN, Sigmoid::Linear(0.0));
const ARENA: f64 = FLOOR * SQRT_2;

config! { 20.0;
    /// The speed that is rewarded by 1, without another goal.
    #[unit = "m/s"]
    pub speed: f64 = 0.5,
    /// What is rewarded: `"speed"`, to `"escape"` from a bowl of bumps, or to `"fetch"` a ball.
    pub goal: Kind = Kind::Speed,
}

/// What a task rewards.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Kind {
    /// The speed.
    Speed,
    /// The distance from the middle of a bowl of bumps.
    Escape,
    /// The nearness of robot and ball, and of ball and target.
    Fetch,
}

impl ArgumentType for Kind {
    fn kind() -> String {
        "\"speed\", \"escape\" or \"fetch\"".to_owned()
    }
}

/// The domain.
#[derive(Clone, Debug)]
pub struct Quadruped {
    goal: Goal,
    torso: usize,
    workspace: usize,
    upright: Tolerance,
}

#[derive(Clone, Debug)]
enum Goal {
    Move(Tolerance),
    Escape,
    /// The body, the first position and velocity of the ball, and the site of the target.
    Fetch {
        ball: usize,
        qpos: usize,
        dof: usize,
        target: usize,
    },
}

impl Domain for Quadruped {
    type Config = Config;

    const NAME: &'static str = "Quadruped";

    const TIMESTEPS: usize = 4;

    fn text(config: &Config) -> Result<Cow<'static, str>> {
        check("speed", config.speed, 0.01, 1000.0)?;
        Ok(model::text(config).into())
    }

    fn new(config: &Config, s: &Simulation) -> Result<Self> {
        let speed = config.speed;
        let (goal, upright) = match config.goal {
            Kind::Speed => {
                let moving = Tolerance::above(speed).margin(speed, Sigmoid::Linear(0.5));
                (Goal::Move(moving), 1.0)
            }
            Kind::Escape => (Goal::Escape, SLANTED),
            Kind::Fetch => {
                let joint = s.joint("ball_root")?;
                let ball = Goal::Fetch {
                    ball: s.body("ball")?,
                    qpos: s.model.jnt_qposadr[joint],
                    dof: s.model.jnt_dofadr[joint],
                    target: s.site("target")?,
                };
                (ball, 1.0)
            }
        };
        Ok(Self {
            goal,
            torso: s.body("torso")?,
            workspace: s.site("workspace")?,
            upright: Tolerance::above(upright).margin(1.0 + upright, Sigmoid::Linear(0.0)),
        })
    }
}

/// Puts the robot into the lowest place without contacts, in steps of 1 cm: dm_control's
/// `_find_non_contacting_height`.
fn lift(start: &mut Start<'_>, orientation: [f64; 4], [x, y]: [f64; 2]) -> Result<()> {
    let mut z = 0.0;
    for _ in 0..HEIGHTS {
        let (m, d, _) = start.parts();
        d.reset(m);
        d.qpos[..3].copy_from_slice(&[x, y, z]);
        d.qpos[3..7].copy_from_slice(&orientation);
        start.settle();
        if start.data.contact.is_empty() {
            return Ok(());
        }
        z += 0.01;
    }
    let reason = "no height up to 100 m is free of contacts: change the model so that its bodies can be apart";
    Err(Error::argument("model", reason))
}

impl Quadruped {
    /// Draws the places of the robot and of the ball.
    fn start_fetch(start: &mut Start<'_>, qpos: usize, dof: usize) -> Result<()> {
        let spread = 0.9 * FLOOR;
        let azimuth = start.uniform(0.0, 2.0 * PI);
        let orientation = [math::cos(azimuth / 2.0), 0.0, 0.0, math::sin(azimuth / 2.0)];
        let place = [(); 2].map(|()| start.uniform(-spread, spread));
        lift(start, orientation, place)?;
        for k in 0..2 {
            start.data.qpos[qpos + k] = start.uniform(-spread, spread);
        }
        start.data.qpos[qpos + 2] = 2.0;
        for k in 0..2 {
            start.data.qvel[dof + k] = 5.0 * start.rng.standard_normal();
        }
        Ok(())
    }

    /// The ball's place and velocities relative to the torso, in its frame.
    fn ball_state(&self, d: &Data, ball: usize, dof: usize) -> [[f64; 3]; 3] {
        let (pos, mat) = (d.xpos[self.torso], &d.xmat[self.torso]);
        let three = |first: usize| [0, 1, 2].map(|k| d.qvel[first + k]);
        let parts = [
            minus(d.xpos[ball], pos),
            minus(three(dof), three(0)),
            three(dof + 3),
        ];
        // a product of two matrices, which has another kernel
        parts.map(|part| super::times(part, mat))
    }
}

/// Returns the horizontal part of `a - b`.
fn across(a: [f64; 3], b: [f64; 3]) -> f64 {
    let [x, y, _] = minus(a, b);
    norm([x, y])
}

impl SimTask for Quadruped {
    fn start(&self, start: &mut Start<'_>) -> Result<()> {
        if let Goal::Fetch { qpos, dof, .. } = self.goal {
            return Self::start_fetch(start, qpos, dof);
        }
        if matches!(self.goal, Goal::Escape) {
            *start.constants = terrain::draw_bumps(start.rng);
            start.change(|constants, model| self.apply(constants, model))?;
        }
        let orientation = start.quaternion(Rng::standard_normal, norm);
        lift(start, orientation, [0.0; 2])
    }

    fn apply(&self, constants: &[f64], model: &mut CompiledModel) {
        terrain::shape(constants, &mut model.hfields.hfield_data);
    }

    fn has(&self, constants: &[f64]) -> bool {
        let number = match self.goal {
            Goal::Escape => terrain::BUMPS * terrain::BUMPS,
            _ => 0,
        };
        constants.len() == number && constants.iter().all(|x| x.is_finite())
    }

    fn observe(&self, _: &Model, d: &Data, out: &mut Observation) {
        let (hinges, sensors) = (model::HINGES, &d.sensordata);
        let state = d.qpos[7..7 + hinges]
            .iter()
            .chain(&d.qvel[6..6 + hinges])
            .chain(&d.act);
        out.vector("egocentric_state", state.copied());
        out.vector("torso_velocity", sensors[6..9].iter().copied());
        out.scalar("torso_upright", d.xmat[self.torso][ZZ]);
        out.vector("imu", sensors[..6].iter().copied());
        out.vector("force_torque", sensors[9..33].iter().map(|x| arcsinh(*x)));
        let (pos, mat) = (d.xpos[self.torso], &d.xmat[self.torso]);
        match self.goal {
            Goal::Move(_) => {}
            Goal::Escape => {
                out.vector("origin", times(pos, mat).map(|x| -x));
                let range = |range: &f64| if *range == -1.0 { 1.0 } else { tanh(*range) };
                out.vector("rangefinder", sensors[33..].iter().map(range));
            }
            Goal::Fetch {
                ball, dof, target, ..
            } => {
                let state = self.ball_state(d, ball, dof);
                out.vector("ball_state", state.into_iter().flatten());
                let place = times(minus(d.site_xpos[target], pos), mat);
                out.vector("target_position", place);
            }
        }
    }

    fn names(&self, names: &mut Naming<'_>) {
        let hinges = model::HINGES;
        names.part("egocentric_state");
        names.positions(7..7 + hinges).velocities(6..6 + hinges);
        names.activations();
        names.part("torso_velocity").sensors(6..9);
        names.part("torso_upright");
        names.add("cosine of the inclination of torso");
        names.part("imu").sensors(..6);
        names.part("force_torque");
        for sensor in 9..33 {
            names.of("arcsinh of", &names.sensor(sensor));
        }
        match self.goal {
            Goal::Move(_) => {}
            Goal::Escape => {
                names.part("origin");
                names.xyz("{} from torso to the middle in the torso's frame (m)");
                names.part("rangefinder");
                for sensor in 33..names.model().nsensordata() {
                    names.of("tanh of", &names.sensor(sensor));
                }
            }
            Goal::Fetch { .. } => {
                names.part("ball_state");
                names.xyz("{} from torso to ball in the torso's frame (m)");
                names.xyz("velocity of ball against torso along the torso's {} (m/s)");
                names.xyz("angular velocity of ball about the torso's {} (rad/s)");
                names.part("target_position");
                names.xyz("{} from torso to target in the torso's frame (m)");
            }
        }
    }

    fn reward(&self, _: &Model, d: &Data) -> f64 {
        let upright = self.upright.of(d.xmat[self.torso][ZZ]);
        upright
            * match &self.goal {
                Goal::Move(speed) => speed.of(d.sensordata[6]),
                Goal::Escape => ESCAPE.of(norm(d.site_xpos[self.workspace])),
                Goal::Fetch { ball, target, .. } => {
                    let ball = d.xpos[*ball];
                    let reach = REACH.of(across(d.site_xpos[self.workspace], ball));
                    let bring = BRING.of(across(d.site_xpos[*target], ball));
                    reach * (0.5 + 0.5 * bring)
                }
            }
    }
}

gym_core::register!(
    register::<Quadruped>("dm_control/quadruped-walk-v0", "Walk on four legs."),
    register::<Quadruped>("dm_control/quadruped-run-v0", "Run on four legs.")
        .kwargs(r#"{"speed": 5.0}"#),
    register::<Quadruped>(
        "dm_control/quadruped-escape-v0",
        "Climb out of a bowl of bumps on four legs."
    )
    .exceptions(SHAPELY_STILL)
    .kwargs(r#"{"goal": "escape"}"#),
    register::<Quadruped>(
        "dm_control/quadruped-fetch-v0",
        "Bring a ball to the middle, on four legs."
    )
    .exceptions(SHAPELY_STILL)
    .kwargs(r#"{"goal": "fetch"}"#),
);
