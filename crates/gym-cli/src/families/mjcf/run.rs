//! Steps of a model with random controls.

use std::fmt;
use std::time::{Duration, Instant};

use super::refused;
use gym::Result;
use gym::rng::RandomState;
use gym::sim::engine::{Data, Model, forward, step};

/// The initial state, or that of a keyframe, which is given by its name or number.
pub(super) fn start(model: &Model, keyframe: Option<&str>) -> Result<Data> {
    let mut data = Data::new(model);
    if let Some(name) = keyframe {
        let key = gym::sim::keyframe(model, name)?;
        data.reset_keyframe(model, key).map_err(refused)?;
    }
    forward(model, &mut data);
    Ok(data)
}

/// The results of a run.
pub(super) struct Report {
    steps: u64,
    time: Duration,
    /// The largest number of contacts after a step.
    contacts: usize,
    /// The step after which a position is not finite or beyond 1e10.
    lost: Option<u64>,
}

/// Takes steps with random controls, uniform in their ranges, or in -1 to 1 without a range.
/// `watch` sees each state, and its time is not counted.
pub(super) fn run(
    model: &Model,
    data: &mut Data,
    (steps, seed): (u64, u32),
    mut watch: impl FnMut(&Data) -> Result<()>,
) -> Result<Report> {
    const FARTHEST: f64 = 1e10;
    let mut controls = RandomState::new(seed);
    let mut report = Report {
        steps,
        time: Duration::ZERO,
        contacts: data.contact.len(),
        lost: None,
    };
    watch(data)?;
    for taken in 1..=steps {
        let start = Instant::now();
        for (i, control) in data.ctrl.iter_mut().enumerate() {
            *control = controls.uniform(-1.0, 1.0);
            if model.actuator_ctrllimited[i] {
                let [low, high] = model.actuator_ctrlrange[i];
                *control = low + (*control + 1.0) / 2.0 * (high - low);
            }
        }
        step(model, data);
        report.time += start.elapsed();
        report.contacts = report.contacts.max(data.contact.len());
        // (NaN is not within either)
        let is_near = data.qpos.iter().all(|x| x.abs() <= FARTHEST);
        if !is_near {
            report.lost = report.lost.or(Some(taken));
        }
        watch(data)?;
    }
    Ok(report)
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let seconds = self.time.as_secs_f64();
        let rate = self.steps as f64 / seconds.max(1e-9);
        write!(
            f,
            "{} steps in {seconds:.3} s: {rate:.0} steps per second, at most {} contacts",
            self.steps, self.contacts
        )?;
        match self.lost {
            Some(step) => write!(f, "; the model flew apart at step {step}"),
            None => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn falling() -> Model {
        let text = r#"<mujoco><worldbody><geom type="plane" size="0 0 1"/><body pos="0 0 0.1"><freejoint/>
            <geom size="0.1"/></body></worldbody><keyframe><key name="up" qpos="0 0 2 1 0 0 0"/></keyframe></mujoco>"#;
        Model::from_xml(text).unwrap()
    }

    #[test]
    fn a_keyframe_has_a_name_and_a_number() {
        let model = falling();
        for key in ["up", "0"] {
            assert_eq!(start(&model, Some(key)).unwrap().qpos[2], 2.0);
        }
        let error = start(&model, Some("down")).unwrap_err().to_string();
        assert!(
            error.contains("\"down\"") && error.contains("up"),
            "{error}"
        );
    }

    #[test]
    fn each_state_is_seen_and_contacts_are_counted() {
        let model = falling();
        let mut seen = 0;
        let mut data = start(&model, None).unwrap();
        let report = run(&model, &mut data, (10, 0), |_| {
            seen += 1;
            Ok(())
        });
        let report = report.unwrap();
        assert_eq!((seen, report.contacts, report.lost), (11, 1, None));
        let said = report.to_string();
        assert!(
            said.starts_with("10 steps in ") && said.ends_with(" at most 1 contacts"),
            "{said}"
        );
    }

    #[test]
    fn the_first_step_of_a_model_that_flies_apart_is_told() {
        // 0.4e10 m after a step, 1.2e10 m after two; then the engine begins anew
        let text = r#"<mujoco><option timestep="1" gravity="0 0 -4e9"/><worldbody><body><freejoint/><geom size="0.1"/></body>
            </worldbody></mujoco>"#;
        let model = Model::from_xml(text).unwrap();
        let mut data = start(&model, None).unwrap();
        let report = run(&model, &mut data, (5, 0), |_| Ok(())).unwrap();
        assert_eq!(report.lost, Some(2));
        let said = report.to_string();
        assert!(said.ends_with("; the model flew apart at step 2"), "{said}");
    }

    #[test]
    fn controls_are_drawn_in_their_ranges_from_the_seed() {
        let text = r#"<mujoco><worldbody><body><joint name="a"/><geom size="0.1"/></body></worldbody><actuator>
            <motor joint="a" ctrlrange="5 7"/><motor joint="a"/><motor joint="a" ctrlrange="-0.5 -0.25"/></actuator></mujoco>"#;
        let model = Model::from_xml(text).unwrap();
        let controls = |seed| {
            let (mut drawn, mut data) = (Vec::new(), start(&model, None).unwrap());
            let watch = |data: &Data| {
                drawn.push([data.ctrl[0], data.ctrl[1], data.ctrl[2]]);
                Ok(())
            };
            run(&model, &mut data, (200, seed), watch).unwrap();
            drawn.split_off(1) // those before the first step are 0
        };
        let drawn = controls(3);
        for (i, [low, high]) in [[5.0, 7.0], [-1.0, 1.0], [-0.5, -0.25]]
            .into_iter()
            .enumerate()
        {
            let of = drawn
                .iter()
                .map(|controls| (controls[i] - low) / (high - low));
            let of: Vec<f64> = of.collect();
            assert!(of.iter().all(|x| (0.0..=1.0).contains(x)), "{i}: {of:?}");
            let mean = of.iter().sum::<f64>() / of.len() as f64;
            assert!((mean - 0.5).abs() < 0.1, "{i}: {mean}");
            let [least, most] = [f64::min, f64::max].map(|end| of.iter().copied().reduce(end));
            assert!(
                least < Some(0.1) && most > Some(0.9),
                "{i}: {least:?} to {most:?}"
            );
        }
        assert_eq!(drawn, controls(3));
        assert_ne!(drawn, controls(4));
    }
}
