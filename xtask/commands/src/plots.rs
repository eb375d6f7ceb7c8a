//! Plots of episodes.

use std::path::Path;

use gym::rendering::Plot;
use gym::{Error, Result};

use crate::policy::Episode;

/// Writes returns and lengths of some runs, each under its name, to an SVG or PNG file.
pub(crate) fn write(path: &Path, title: &str, runs: &[(String, Vec<Episode>)]) -> Result<()> {
    let values = runs.iter().map(|(name, episodes)| {
        let returns: Vec<f64> = episodes.iter().map(|episode| episode.episode_return).collect();
        let lengths: Vec<f64> = episodes.iter().map(|episode| episode.length as f64).collect();
        (name.as_str(), returns, lengths)
    });
    let values: Vec<_> = values.collect();
    let longest = values.iter().map(|(_, returns, _)| returns.len()).max().unwrap_or(0);
    let runs = values.iter().map(|(name, returns, lengths)| (*name, &returns[..], &lengths[..]));
    let plot = Plot::episodes(title, (longest / 5).clamp(1, 100), runs);
    match path.extension().and_then(|extension| extension.to_str()) {
        Some("svg") => plot.write_svg(path),
        Some("png") => plot.write_png(path),
        _ => {
            let reason = format!("`{}` has no known extension: use .svg or .png", path.display());
            Err(Error::argument("--plot", reason))
        }
    }
}
