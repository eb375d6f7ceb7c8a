//! `cargo xtask conform [ID...]`

use gym::{Error, Result, conform, registry};

#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The environments; all that are linked if none is named.
    ids: Vec<String>,
}

pub(crate) fn conform(arguments: &Arguments) -> Result<()> {
    let ids = match arguments.ids.is_empty() {
        true => registry::all().iter().map(|registration| registration.id().to_owned()).collect(),
        false => arguments.ids.clone(),
    };
    let mut broken = 0;
    for id in &ids {
        let findings = conform::check(|| gym::make(id));
        println!("{} {id}", if findings.is_empty() { "ok    " } else { "BROKEN" });
        for finding in &findings {
            println!("       {finding}");
        }
        broken += usize::from(!findings.is_empty());
    }
    println!("{} environments, {} checks each, {broken} broken", ids.len(), conform::CHECKS.len());
    match broken {
        0 => Ok(()),
        _ => Err(Error::custom(format!("{broken} environments break the rules"))),
    }
}
