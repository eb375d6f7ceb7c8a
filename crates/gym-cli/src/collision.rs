//! Explains Cargo's error about one crate from two folders, and names the remedy.

/// Returns an explanation of `error`, if it is Cargo's error about two packages with the same name
/// and version from two folders.
pub(crate) fn explain(error: &str) -> Option<String> {
    let (_, packages) = error.split_once("package collision in the lockfile: packages ")?;
    let (first, rest) = packages.split_once(" and ")?;
    let (second, _) = rest.split_once(" are different")?;
    let folder = |package: &str| Some(package.split_once('(')?.1.trim_end_matches(')').to_owned());
    let name = first.split_whitespace().next()?;
    Some(format!(
        "the crate {name} comes from two folders, {} and {}: let all manifests of the workspace name one of the two",
        folder(first)?,
        folder(second)?
    ))
}

#[cfg(test)]
mod tests {
    use super::explain;

    #[test]
    fn two_folders_are_named() {
        let cargo = "    Updating index\nerror: package collision in the lockfile: packages rust-gym-core v0.1.0 (/a/crates/gym-core) \
                     and rust-gym-core v0.1.0 (/b c/crates/gym-core) are different, but only one can be written to lockfile \
                     unambiguously\n";
        assert_eq!(
            explain(cargo).unwrap(),
            "the crate rust-gym-core comes from two folders, /a/crates/gym-core and /b c/crates/gym-core: let all manifests of \
             the workspace name one of the two"
        );
        assert_eq!(
            explain("error: no matching package named `gym` found"),
            None
        );
    }
}
