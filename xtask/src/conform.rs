//! `cargo xtask conform [ID...]`

use gym::{EnvSpec, Error, Registration, Result, conform, registry};

#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The environments; all that are linked if none is named.
    ids: Vec<String>,
}

pub(crate) fn conform(arguments: &Arguments) -> Result<()> {
    let specs: Vec<EnvSpec> = match &arguments.ids[..] {
        [] => registry::all().iter().map(Registration::spec).collect::<Result<_>>()?,
        ids => ids.iter().map(|id| gym::builder(id).spec()).collect::<Result<_>>()?,
    };
    let mut broken = 0;
    for spec in &specs {
        let id = &spec.id;
        let registration = registry::find(id)?;
        let findings = conform::check(|| spec.make());
        let (known, findings): (Vec<_>, Vec<_>) =
            findings.iter().partition(|finding| registration.exception(finding.check).is_some());
        println!("{} {id}", if findings.is_empty() { "ok    " } else { "BROKEN" });
        for finding in &findings {
            println!("       {finding}");
        }
        for finding in known {
            println!(
                "       may fail {}: {}",
                finding.check,
                registration.exception(finding.check).unwrap_or_default()
            );
        }
        broken += usize::from(!findings.is_empty());
    }
    println!("{} environments, {} checks each, {broken} broken", specs.len(), conform::CHECKS.len());
    match broken {
        0 => Ok(()),
        _ => Err(Error::custom(format!("{broken} environments break the rules"))),
    }
}
