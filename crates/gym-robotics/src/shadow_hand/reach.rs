//! HandReach: move the fingertips of a Shadow hand to places.
//!
//! | | |
//! |---|---|
//! | observation | `observation`: angles of the joints in rad, their velocities in rad/s, and places of the fingertips in m (63 numbers); `achieved_goal`: the places of the fingertips, from the first finger to the little one and the thumb; `desired_goal`: the goal's places, in m (15 numbers each) |
//! | action | angles of the joints, as shares of their ranges; `Box(-1, 1, (20,), float32)` |
//! | reward | 0 if the distance of the 15 numbers is at most 0.01 m, else -1; ids with `Dense`: minus the distance in m |
//! | start | the hand half closed; the goal is the thumb at one of the fingers, at a place near (0, -0.09, 0.05) m from the palm, and in a tenth of the episodes the start |
//! | end | never |
//! | limit | 50 steps of 0.04 s |
//!
//! `info` has `is_success` after a step: 1 if the distance is less than 0.01 m, else 0.
//!
//! Differences from Gymnasium-Robotics: all numbers are Gymnasium-Robotics' with the version of
//! MuJoCo that `mujoco` names, for Linux on x86-64, and with numpy on a CPU without AVX-512 in OpenBLAS;
//! with it, goals differ in the last bit. The arguments `relative_control` and `n_substeps`, for
//! which the package fails, are left out.
//!
//! Source: Gymnasium-Robotics 1.4.2, `envs/shadow_dexterous_hand/reach.py`, `hand_env.py`, and
//! `envs/robot_env.py`.

use std::path::PathBuf;

use gym_core::registry::Build;
use gym_core::{Array, Error, Goals, Registration, Result};
use gym_sim::numpy::norm_avx2;
use gym_sim::{
    Common, Measured, Naming, Observation, Rng, SimEnv, SimTask, Simulation, Start, Visit,
};
use mujoco_engine::math::sub;
use mujoco_engine::{Data, Model, forward};
use serde_json::{Map, Value as Json};

use super::{ALLOCATES, Hand, camera, make, registered};
use crate::RewardType;
use crate::goals::Near;

/// The angles at the start, in rad.
const START: [(&str, f64); 24] = [
    ("WRJ1", -0.16514339750464327),
    ("WRJ0", -0.31973286565062153),
    ("FFJ3", 0.14340512546557435),
    ("FFJ2", 0.32028208333591573),
    ("FFJ1", 0.7126053607727917),
    ("FFJ0", 0.6705281001412586),
    ("MFJ3", 0.000246444303701037),
    ("MFJ2", 0.3152655251085491),
    ("MFJ1", 0.7659800313729842),
    ("MFJ0", 0.7323156897425923),
    ("RFJ3", 0.00038520700007378114),
    ("RFJ2", 0.36743546201985233),
    ("RFJ1", 0.7119514095008576),
    ("RFJ0", 0.6699446327514138),
    ("LFJ4", 0.0525442258033891),
    ("LFJ3", -0.13615534724474673),
    ("LFJ2", 0.39872030433433003),
    ("LFJ1", 0.7415570009679252),
    ("LFJ0", 0.704096378652974),
    ("THJ4", 0.003673823825070126),
    ("THJ3", 0.5506291436028695),
    ("THJ2", -0.014515151997119306),
    ("THJ1", -0.0015229223564485414),
    ("THJ0", -0.7894883021600622),
];

/// The fingers; the thumb is the last.
const FINGERS: [&str; 5] = ["ff", "mf", "rf", "lf", "th"];
const THUMB: usize = 4;

gym_core::arguments! {
    /// Arguments.
    pub struct Config {
        /// The distance within which a goal is reached.
        #[unit = "m"]
        pub distance_threshold: f64 = 0.01,
        /// The angles of joints at the start, in rad by name, such as `robot0:WRJ1`; others are 0.
        pub initial_qpos: Option<Map<String, Json>>,
        /// The reward: `"sparse"`, which is 0 at the goal and -1 elsewhere, or `"dense"`, minus the
        /// distance in m.
        pub reward_type: RewardType,
        /// The folder of models; `None` for `GYMNASIUM_ROBOTICS_ASSETS` or an installed
        /// gymnasium-robotics.
        pub assets: Option<PathBuf>,
        /// The arguments that all tasks share.
        #[flatten(
            xml_file = 0, keyframe = 0, frame_skip = 0, default_camera_config = 1.., width = 1.., height = 1.., camera_id = 0,
            camera_name = 0, max_geom = 0, visual_options = 0
        )]
        pub common: Common,
    }
}

/// The constructor of the environments.
#[derive(Clone, Copy, Debug)]
pub struct HandReach;

impl Build for HandReach {
    type Config = Config;
    type Env = SimEnv;

    fn defaults(_version: u32) -> Config {
        let mut config = Config::default();
        config.common.default_camera_config = camera();
        config
    }

    fn build(mut config: Config, version: u32) -> Result<SimEnv> {
        let folder = config.assets.take();
        make(
            ("MujocoHandReachEnv", version),
            ("hand/reach.xml", folder),
            &config,
            &config.common,
            |simulation| Task::new(&config, simulation),
        )
    }
}

/// The task. `userdata` has the goal.
#[derive(Debug)]
struct Task {
    hand: Hand,
    /// The sites of the fingertips, and those that show the goal and the fingertips.
    tips: [usize; 5],
    shown: [[usize; 5]; 2],
    /// The positions at the start, and the places of palm and fingertips.
    start: Vec<f64>,
    palm: [f64; 3],
    places: [[f64; 3]; 5],
    goals: Near,
}

impl Task {
    fn new(config: &Config, simulation: &Simulation) -> Result<Self> {
        let m = &*simulation.model;
        let mut d = Data::new(m);
        for (name, x) in angles(config)? {
            let Some(joint) = m.joint_id(&name) else {
                let reason = format!("the hand has no joint `{}`", gym_core::printable(&name));
                return Err(Error::argument("initial_qpos", reason));
            };
            d.qpos[m.jnt_qposadr[joint]] = x;
        }
        forward(m, &mut d);
        let sites = |name: &dyn Fn(usize) -> String| -> Result<[usize; 5]> {
            let mut sites = [0; 5];
            for (k, site) in sites.iter_mut().enumerate() {
                *site = simulation.site(&name(k))?;
            }
            Ok(sites)
        };
        let tips = sites(&|k| format!("robot0:S_{}tip", FINGERS[k]))?;
        Ok(Self {
            hand: Hand::new(m),
            tips,
            shown: [
                sites(&|k| format!("target{k}"))?,
                sites(&|k| format!("finger{k}"))?,
            ],
            palm: d.xpos[simulation.body("robot0:palm")?],
            places: tips.map(|site| d.site_xpos[site]),
            start: d.qpos,
            goals: Near {
                length: 15,
                threshold: config.distance_threshold,
                reward_type: config.reward_type,
            },
        })
    }

    fn achieved(&self, d: &Data) -> [f64; 15] {
        let mut goal = [0.0; 15];
        for (to, site) in goal.chunks_exact_mut(3).zip(self.tips) {
            to.copy_from_slice(&d.site_xpos[site]);
        }
        goal
    }

    fn draw_goal(&self, rng: &mut Rng) -> [[f64; 3]; 5] {
        let finger = rng.integer(THUMB as u32) as usize;
        let [x, y, z] = self.palm;
        let meeting = [x + 0.0, y - 0.09, z + 0.05].map(|x| x + 0.005 * rng.standard_normal());
        let mut goal = self.places;
        for k in [THUMB, finger] {
            let way = sub(meeting, goal[k]);
            let length = norm_avx2(&way);
            goal[k] = std::array::from_fn(|i| meeting[i] - 0.005 * (way[i] / length));
        }
        if rng.random() < 0.1 {
            return self.places;
        }
        goal
    }
}

/// The angles at the start, by the names of joints.
fn angles(config: &Config) -> Result<Vec<(String, f64)>> {
    let Some(given) = &config.initial_qpos else {
        let named = START.iter().map(|(name, x)| (format!("robot0:{name}"), *x));
        return Ok(named.collect());
    };
    let number = |(name, x): (&String, &Json)| match x.as_f64() {
        Some(x) if x.abs() <= 1e3 => Ok((name.clone(), x)),
        _ => {
            let reason = format!(
                "`{}` is {x}: give an angle in rad, within ±1000",
                gym_core::printable(name)
            );
            Err(Error::argument("initial_qpos", reason))
        }
    };
    given.iter().map(number).collect()
}

impl SimTask for Task {
    fn remembers(&self) -> usize {
        15
    }

    fn start(&self, start: &mut Start<'_>) -> Result<()> {
        let (_, d, rng) = start.parts();
        d.qpos.copy_from_slice(&self.start);
        d.userdata
            .copy_from_slice(self.draw_goal(rng).as_flattened());
        Ok(())
    }

    fn step(&self, simulation: &Simulation, d: &mut Data, action: &Array) -> Measured {
        self.hand.step(simulation, d, action);
        let reward = self.goals.compute_reward(&self.achieved(d), &d.userdata);
        Measured::new(reward, false)
    }

    fn observe(&self, _: &Model, d: &Data, out: &mut Observation) {
        let achieved = self.achieved(d);
        out.vector("achieved_goal", achieved);
        out.vector("desired_goal", d.userdata.iter().copied());
        out.extend(self.hand.state(d).chain(achieved));
    }

    fn names(&self, names: &mut Naming<'_>) {
        for (part, of) in [
            ("achieved_goal", ""),
            ("desired_goal", "the goal of "),
            ("observation", ""),
        ] {
            names.part(part);
            if part == "observation" {
                self.hand.names(names);
            }
            for tip in self.tips {
                let tip = names.site(tip);
                names.xyz(&format!("{{}} of {of}{tip} (m)"));
            }
        }
    }

    fn show(&self, d: &mut Data) {
        for k in 0..5 {
            let [target, finger] = self.shown.map(|sites| sites[k]);
            d.site_xpos[target].copy_from_slice(&d.userdata[3 * k..3 * k + 3]);
            d.site_xpos[finger] = d.site_xpos[self.tips[k]];
        }
    }

    fn info(&self, _: &Simulation, d: &Data, measured: Option<&Measured>, visit: Visit<'_>) {
        if measured.is_some() {
            let is_success = self.goals.is_success(&self.achieved(d), &d.userdata);
            visit("is_success", f64::from(is_success));
        }
    }

    fn goals(&self) -> Option<&dyn Goals> {
        Some(&self.goals)
    }
}

/// The registration that both ids share.
const fn reach(id: &'static str, kwargs: &'static str) -> Registration {
    let registration = Registration::new::<HandReach>(id)
        .description("Move the fingertips of a hand to places.")
        .kwargs(kwargs)
        .exceptions(&[ALLOCATES]);
    registered(registration, 50)
}

gym_core::register!(
    reach("HandReach-v3", "{\"reward_type\":\"sparse\"}"),
    reach("HandReachDense-v3", "{\"reward_type\":\"dense\"}"),
);
