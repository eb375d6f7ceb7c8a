//! "Did you mean": the known name that is nearest to a misspelt one.

/// The most similar of some names, if any is similar. Case is ignored, so `cartpole` finds
/// `CartPole`.
pub(crate) fn nearest<'a>(name: &str, known: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    const CUTOFF: f64 = 0.6; // that of Gymnasium's suggestions
    let name = name.to_lowercase();
    known
        .map(|other| {
            (
                strsim::normalized_damerau_levenshtein(&name, &other.to_lowercase()),
                other,
            )
        })
        .filter(|(similarity, _)| *similarity >= CUTOFF)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, other)| other)
}
