//! "Did you mean": the known name that is nearest to a misspelt one.

/// The most similar of some names, if any is similar. Case is ignored, so `cartpole` finds
/// `CartPole`.
pub(crate) fn nearest<'a>(name: &str, known: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    const CUTOFF: f64 = 0.6; // that of Gymnasium's suggestions
    let name = name.to_lowercase();
    let length = name.chars().count();
    known
        .map(|known| (known.to_lowercase(), known))
        .filter(|(other, _)| {
            // the ratio of the lengths is an upper bound of the similarity
            let other = other.chars().count();
            length.min(other) as f64 >= CUTOFF * length.max(other) as f64
        })
        .map(|(other, known)| (strsim::normalized_damerau_levenshtein(&name, &other), known))
        .filter(|(similarity, _)| *similarity >= CUTOFF)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, other)| other)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Compares names of all pairs of lengths: a pair that `suggest` skips because of its lengths
    /// is never near.
    #[test]
    fn names_of_another_length_are_not_near() {
        let known: Vec<String> = (0..12).map(|n| "ab".repeat(n)).collect();
        for n in 0..24 {
            let name = "ab".repeat(12)[..n].to_owned();
            let all = known
                .iter()
                .map(|other| strsim::normalized_damerau_levenshtein(&name, other));
            let best = all.fold(0.0, f64::max);
            let near = nearest(&name, known.iter().map(String::as_str));
            assert_eq!(near.is_some(), best >= 0.6, "{name}: {near:?}");
        }
        assert_eq!(
            nearest("cartpole", ["CartPole", "Taxi"].into_iter()),
            Some("CartPole")
        );
    }

    #[test]
    fn a_huge_name_is_compared_with_none() {
        let huge = "CartPole".repeat(1_000_000);
        assert_eq!(nearest(&huge, ["CartPole"; 1000].into_iter()), None);
    }
}
