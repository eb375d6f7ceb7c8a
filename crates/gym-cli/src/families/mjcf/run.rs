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
    }
}
