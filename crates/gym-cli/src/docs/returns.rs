//! The returns of a random and of a good policy, which are measured once and stored beside the
//! pages.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use gym::{EnvSpec, Error, Result};
use serde::{Deserialize, Serialize};

use super::Document;
use crate::output::tell;
use crate::policy::Policy;
use crate::workspace::{self, Workspace};

/// The file of the measured returns, so that `docs` need not measure them each time.
const FILE: &str = "docs/environments/returns.json";

/// The number of episodes, with the seeds from 0 on.
pub(super) const EPISODES: u64 = 100;

/// The measured returns by id.
pub(super) type Returns = BTreeMap<String, Measured>;

#[derive(Debug, Serialize, Deserialize)]
pub(super) struct Measured {
    pub(super) random: Summary,
    /// The results of the good policy, if the environment has one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) good: Option<Summary>,
}

#[derive(Debug, Serialize, Deserialize)]
pub(super) struct Summary {
    pub(super) mean: f64,
    pub(super) deviation: f64,
    pub(super) mean_length: f64,
}

/// Reads the stored returns in `folder`; an empty map if the file does not exist.
pub(super) fn read(folder: &Path) -> Result<Returns> {
    let path = folder.join(FILE);
    if !path.exists() {
        return Ok(Returns::new());
    }
    let text = gym::file::read_text(&path, usize::MAX).map_err(|error| Error::io(&path, error))?;
    serde_json::from_str(&text).map_err(|error| {
        Error::custom(format!(
            "{FILE}: {error}: write it with `cargo xtask docs --measure`"
        ))
    })
}

/// Measures the returns of every environment.
pub(super) fn measure(workspace: &Workspace) -> Result<Returns> {
    workspace::without_needy(workspace.own()?)
        .iter()
        .map(|registration| {
            let spec = registration.spec()?;
            let measured = Measured {
                random: summary(&spec, Policy::Random)?,
                good: Policy::good(&spec.make()?)?
                    .map(|_| summary(&spec, Policy::Good))
                    .transpose()?,
            };
            let good = measured.good.as_ref().map_or(f64::NAN, |good| good.mean);
            tell(format_args!(
                "{:32} {:>12.2} {good:>12.2}",
                spec.id, measured.random.mean
            ));
            Ok((spec.id, measured))
        })
        .collect()
}

fn summary(spec: &EnvSpec, policy: Policy) -> Result<Summary> {
    let mut env = spec.make()?;
    let episodes = (0..EPISODES)
        .map(|seed| policy.play(&mut env, seed, |_| Ok(())))
        .collect::<Result<Vec<_>>>()?;
    let count = episodes.len() as f64;
    let mean = episodes
        .iter()
        .map(|episode| episode.episode_return)
        .sum::<f64>()
        / count;
    let variance = episodes
        .iter()
        .map(|episode| (episode.episode_return - mean).powi(2))
        .sum::<f64>()
        / count;
    let mean_length = episodes
        .iter()
        .map(|episode| episode.length as f64)
        .sum::<f64>()
        / count;
    let round = |x: f64| (x * 100.0).round() / 100.0;
    Ok(Summary {
        mean: round(mean),
        deviation: round(variance.sqrt()),
        mean_length: round(mean_length),
    })
}

pub(super) fn document(returns: &Returns) -> Result<Document> {
    let json =
        serde_json::to_string_pretty(returns).map_err(|error| Error::custom(error.to_string()))?;
    Ok((PathBuf::from(FILE), (json + "\n").into_bytes()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_summary_has_the_mean_and_deviation_of_a_hundred_episodes() {
        // each step is worth 1, so that returns are lengths
        let spec = gym::builder("CartPole-v1").spec().unwrap();
        let mut env = spec.make().unwrap();
        let mut play = |seed| {
            Policy::Random
                .play(&mut env, seed, |_| Ok(()))
                .unwrap()
                .length
        };
        let lengths: Vec<u64> = (0..100).map(&mut play).collect();
        let of = |power| lengths.iter().map(|n| (*n as f64).powi(power)).sum::<f64>() / 100.0;
        let found = summary(&spec, Policy::Random).unwrap();
        let near = |x: f64, y: f64| (x - y).abs() <= 0.005 + 1e-9;
        assert!(near(found.mean, of(1)), "{found:?}");
        assert!(near(found.mean_length, of(1)), "{found:?}");
        assert!(
            near(found.deviation, (of(2) - of(1) * of(1)).sqrt()),
            "{found:?}"
        );
        assert!(
            near(found.mean * 100.0, (found.mean * 100.0).round()),
            "{found:?}"
        );

        let pendulum = gym::builder("Pendulum-v1").spec().unwrap();
        let found = summary(&pendulum, Policy::Random).unwrap();
        assert_eq!(found.mean_length, 200.0);
        assert!(found.mean < -800.0, "{found:?}");
    }
}
