//! Plots of episodes.

use std::path::Path;

use gym::render::Plot;
use gym::{Error, Result};

use crate::policy::Episode;

/// Returns an error, before the work starts, if the extension of `path` is neither `svg` nor `png`.
pub(crate) fn check_name(path: &Path) -> Result<()> {
    match extension(path).as_deref() {
        Some("svg" | "png") => Ok(()),
        _ => {
            let reason = format!(
                "`{}` names no known format: the extensions are .svg and .png",
                path.display()
            );
            Err(Error::argument("--plot", reason))
        }
    }
}

/// Returns the extension of a file name, in lower case.
fn extension(path: &Path) -> Option<String> {
    Some(path.extension()?.to_str()?.to_ascii_lowercase())
}

/// Plots the returns and lengths of `runs`, each with its name, to an SVG or PNG file.
pub(crate) fn write(path: &Path, title: &str, runs: &[(String, Vec<Episode>)]) -> Result<()> {
    let plot = plot(title, runs);
    if extension(path).as_deref() == Some("png") {
        plot.write_png(path)
    } else {
        plot.write_svg(path)
    }
}

fn plot(title: &str, runs: &[(String, Vec<Episode>)]) -> Plot {
    let values = runs.iter().map(|(name, episodes)| {
        let returns: Vec<f64> = episodes
            .iter()
            .map(|episode| episode.episode_return)
            .collect();
        let lengths: Vec<f64> = episodes
            .iter()
            .map(|episode| episode.length as f64)
            .collect();
        (name.as_str(), returns, lengths)
    });
    let values: Vec<_> = values.collect();
    let longest = values
        .iter()
        .map(|(_, returns, _)| returns.len())
        .max()
        .unwrap_or(0);
    let runs = values
        .iter()
        .map(|(name, returns, lengths)| (*name, &returns[..], &lengths[..]));
    Plot::episodes(title, (longest / 5).clamp(1, 100), runs)
}

#[cfg(test)]
mod tests {
    use super::*;
    use gym::Value;

    #[test]
    fn returns_stand_above_lengths() {
        let episode = |seed, length| Episode {
            seed,
            episode_return: -(length as f64),
            length,
            terminated: true,
            truncated: false,
            last_reward: -1.0,
            last_observation: Value::Null,
        };
        let runs = [
            ("a".to_owned(), vec![episode(0, 3), episode(1, 5)]),
            ("b".to_owned(), vec![episode(0, 4)]),
        ];
        let series = [
            ("a", &[-3.0, -5.0][..], &[3.0, 5.0][..]),
            ("b", &[-4.0], &[4.0]),
        ];
        let known = Plot::episodes("t", 1, series);
        assert_eq!(format!("{:?}", plot("t", &runs)), format!("{known:?}"));
    }
}
