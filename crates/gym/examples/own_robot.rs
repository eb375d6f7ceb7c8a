//! An environment on a robot of your own: its model in MJCF, and a task on it.
//! Run it with `cargo run --release --example own_robot`.

use gym::prelude::*;
use gym::sim::engine::lanes::Derived;
use gym::sim::engine::{Data, Model};
use gym::sim::{Common, Entry, FromArguments, Observation, SimTask, Simulation, Start};
use gym::sim::{TaskArguments, register};

const PENDULUM: &str = r#"<mujoco>
  <worldbody>
    <body pos="0 0 1">
      <joint name="hinge" axis="0 1 0" damping="0.1"/>
      <geom type="capsule" fromto="0 0 0  0 0 -0.6" size="0.05"/>
      <site name="tip" pos="0 0 -0.6"/>
    </body>
  </worldbody>
  <actuator><motor joint="hinge" gear="2" ctrllimited="true" ctrlrange="-1 1"/></actuator>
</mujoco>"#;

gym::arguments! {
    /// The arguments: the model, the camera and the like.
    pub struct Config {
        /// The arguments that all tasks share.
        #[flatten]
        pub common: Common = Common { xml_file: PENDULUM.to_owned(), frame_skip: 4, ..Common::default() },
    }
}

impl TaskArguments for Config {}

/// Swing up a pendulum: the reward is the height of its tip.
#[derive(Debug)]
struct SwingUp {
    tip: usize,
}

impl FromArguments for SwingUp {
    type Config = Config;

    fn new(_: &Config, _version: u32, simulation: &Simulation) -> Result<Self> {
        let tip = simulation.site("tip")?;
        Ok(Self { tip })
    }
}

impl SimTask for SwingUp {
    fn start(&self, start: &mut Start<'_>) -> Result<()> {
        start.data.qpos[0] = start.uniform(-0.1, 0.1);
        Ok(())
    }

    fn observe(&self, _: &Model, data: &Data, out: &mut Observation) {
        out.extend(data.qpos.iter().chain(&data.qvel).copied());
    }

    fn reward(&self, _: &Model, data: &Data) -> f64 {
        data.site_xpos[self.tip][2]
    }

    // what it reads beside the state: the worlds of a vector then step together
    fn reads(&self, _: &Model) -> Option<Vec<Derived>> {
        Some(vec![Derived::SiteXpos])
    }
}

gym::register!(register::<Entry<SwingUp>>("my_envs/SwingUp-v0").max_episode_steps(200));

fn main() -> Result<()> {
    let mut envs = gym::builder("my_envs/SwingUp-v0").vector(64).build()?;
    let mut actions = envs.action_sampler(0)?;
    let mut columns = envs.reset(0)?;
    let mut best = f64::NEG_INFINITY;
    for _ in 0..200 {
        envs.step_into(&actions.sample(), &mut columns)?;
        best = columns.rewards.iter().copied().fold(best, f64::max);
    }
    println!("the highest of 64 tips reached {best:.2} m");
    assert!(best > 0.4);
    Ok(())
}

#[cfg(test)]
mod tests {
    #[test]
    fn it_runs() {
        super::main().unwrap();
    }
}
