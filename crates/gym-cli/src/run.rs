//! `cargo xtask run ID`

use std::ops::Range;
use std::path::PathBuf;

use gym::render::file;
use gym::{EnvSpec, Error, Kwargs, Result};

use crate::inputs;
use crate::output::say;
use crate::plots;
use crate::policy::{Episode, Policy};

#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The environment.
    id: String,
    /// The policy; several, as in random,good, play one after the other.
    #[arg(long, value_enum, value_delimiter = ',', default_value = "random")]
    policy: Vec<Policy>,
    /// Seeds, as in 0..10 (10 excluded): each seeds a fresh environment and its action space.
    #[arg(long, value_parser = parse_range, default_value = "0..10", allow_hyphen_values = true)]
    seeds: Range<u64>,
    /// Arguments of the environment, as a JSON object.
    #[arg(long, value_parser = inputs::parse_kwargs, default_value = "{}")]
    kwargs: Kwargs,
    /// Also writes the episodes to this file, as a JSON list.
    #[arg(long)]
    json: Option<PathBuf>,
    /// Also draws returns and lengths, a line for each policy, to this file: .svg or .png.
    #[arg(long)]
    plot: Option<PathBuf>,
}

fn parse_range(text: &str) -> Result<Range<u64>, String> {
    let (start, end) = text.split_once("..").ok_or("write A..B, as in 0..10")?;
    let number = |text: &str| {
        let wrong = |_| format!("`{text}` is not a whole number from 0 to {}", u64::MAX);
        text.parse().map_err(wrong)
    };
    let range = number(start)?..number(end)?;
    if range.is_empty() {
        Err("the range is empty: write A..B with A < B".into())
    } else {
        Ok(range)
    }
}

pub(crate) fn run(arguments: &Arguments) -> Result<()> {
    let spec = gym::builder(&arguments.id)
        .args(arguments.kwargs.clone())
        .spec()?;
    if let Some(path) = &arguments.plot {
        plots::check_name(path)?;
    }
    inputs::check_distinct([("--json", &arguments.json), ("--plot", &arguments.plot)])?;
    for path in arguments.json.iter().chain(&arguments.plot) {
        inputs::check_writable(path)?;
    }
    let mut runs = Vec::new();
    for policy in &arguments.policy {
        if arguments.policy.len() > 1 {
            say(format_args!("{}", policy.name()))?;
        }
        let episodes = play(&spec, *policy, arguments.seeds.clone())?;
        say(format_args!("{}", summary(&episodes)))?;
        runs.push((policy.name(), episodes));
    }
    if let Some(path) = &arguments.json {
        let episodes: Vec<&Episode> = runs.iter().flat_map(|(_, episodes)| episodes).collect();
        let json =
            serde_json::to_vec(&episodes).map_err(|error| Error::custom(error.to_string()))?;
        file::write(path, &json)?;
    }
    match &arguments.plot {
        Some(path) => plots::write(path, &spec.id, &runs),
        None => Ok(()),
    }
}

fn play(spec: &EnvSpec, policy: Policy, seeds: Range<u64>) -> Result<Vec<Episode>> {
    say(format_args!(
        "{:>8} {:>14} {:>8}  ended",
        "seed", "return", "length"
    ))?;
    let mut episodes = Vec::new();
    for seed in seeds {
        let mut env = spec.make()?;
        let episode = policy.play(&mut env, seed, |_| Ok(()))?;
        let ended = ending(episode.terminated, episode.truncated);
        say(format_args!(
            "{seed:>8} {:>14.4} {:>8}  {ended}",
            episode.episode_return, episode.length
        ))?;
        episodes.push(episode);
    }
    Ok(episodes)
}

/// Returns the end of an episode in words.
fn ending(terminated: bool, truncated: bool) -> &'static str {
    match (terminated, truncated) {
        (true, true) => "terminated and truncated",
        (true, false) => "terminated",
        _ => "truncated",
    }
}

/// Returns the means and ranges of returns and lengths, in one line.
pub(crate) fn summary(episodes: &[Episode]) -> String {
    let statistics = |value: fn(&Episode) -> f64| {
        let values = episodes.iter().map(value);
        let mean = values.clone().sum::<f64>() / episodes.len() as f64;
        let min = values.clone().fold(f64::INFINITY, f64::min);
        let max = values.fold(f64::NEG_INFINITY, f64::max);
        format!("{mean:>10.2} {:22}", format!("[{min:.1}, {max:.1}]"))
    };
    let returns = statistics(|episode| episode.episode_return);
    let lengths = statistics(|episode| episode.length as f64);
    format!("return {returns} length {lengths}")
        .trim_end()
        .to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_range_of_seeds_is_two_whole_numbers() {
        assert_eq!(parse_range("0..10").unwrap(), 0..10);
        let last = u64::MAX - 1..u64::MAX;
        assert_eq!(
            parse_range(&format!("{}..{}", last.start, last.end)).unwrap(),
            last
        );
        for (text, words) in [
            ("5", "write A..B"),
            ("5..5", "A < B"),
            (
                "-1..5",
                "`-1` is not a whole number from 0 to 18446744073709551615",
            ),
            ("..5", "`` is not a whole number"),
            ("0..=5", "`=5` is not a whole number"),
            ("0..18446744073709551616", "from 0 to 18446744073709551615"),
            ("1e3..2e3", "`1e3` is not a whole number"),
        ] {
            let error = parse_range(text).unwrap_err();
            assert!(error.contains(words), "{text}: {error}");
        }
    }

    #[test]
    fn endings_are_told_apart() {
        assert_eq!(ending(true, false), "terminated");
        assert_eq!(ending(false, true), "truncated");
        assert_eq!(ending(true, true), "terminated and truncated");
    }
}
