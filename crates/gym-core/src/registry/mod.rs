//! Environments by id: link-time and runtime registration, look-up, listing.
//!
//! The table contains the entries of [`register!`](crate::register!) in linked crates, and those
//! that [`register`] adds at run time, sorted by id.
//!
//! [`register!`](crate::register!) is one `inventory::submit!`, which puts the registration into
//! the program at link time. The table keeps duplicate ids and reports them. Cargo does not link a
//! crate that the code never names: the facade re-exports its families, and users name a plugin
//! with `use my_envs as _;`.

mod builder;
mod family;
mod native;
mod registration;
mod stack;
mod vector;

use std::collections::{BTreeMap, BTreeSet};
use std::sync::{LazyLock, PoisonError, RwLock};

pub use builder::{EnvBuilder, builder, make};
pub use family::{Family, by_family, by_page, shown};
pub use native::build;
pub use registration::{Clip, Exceptions, Need, Page, Registration, Source, VectorEntryPoint};
pub use vector::{VectorBuilder, make_vec};

pub use crate::env::{Build, Configure, NoArguments};
use crate::play::policy::LinkedPolicy;
use crate::spec::nearest;
pub use crate::spec::{
    Each, EnvId, EnvSpec, ResetOptions, VectorKind, VectorSpec, WrapperConfig, WrapperSpec,
};
pub use crate::wrappers::{WrapEnv, WrapVector, WrapperRegistration, wrappers};

use crate::value::{Error, Result};

type Table = BTreeMap<EnvId, Vec<Registration>>;

/// All registrations by id. If a crate registers a malformed id at link time, the table has the
/// registration under a name that `find` refuses, and the conformance check reports the id.
static TABLE: LazyLock<RwLock<Table>> = LazyLock::new(|| {
    let mut table = Table::new();
    for registration in inventory::iter::<Registration> {
        let id = registration.id().parse().unwrap_or_else(|_| EnvId {
            namespace: None,
            name: registration.id().to_owned(),
            version: None,
        });
        let mut registration = registration.clone();
        let mut linked = inventory::iter::<LinkedPolicy>.into_iter();
        let linked = linked.find(|linked| linked.id == registration.id());
        let page = &mut registration.page;
        page.policy = page.policy.or(linked.map(|linked| linked.policy));
        registration.needs = registration.needs.or(registration.family().needs);
        table.entry(id).or_default().push(registration);
    }
    for duplicates in table.values_mut() {
        duplicates.sort_by_key(|registration| registration.source.package);
    }
    RwLock::new(table)
});

fn with_table<R>(f: impl FnOnce(&Table) -> R) -> R {
    f(&TABLE.read().unwrap_or_else(PoisonError::into_inner))
}

/// Adds an environment at run time.
///
/// # Errors
/// [`Error::MalformedId`]; [`Error::Registration`] if the id exists, or if the same name exists
/// with a version and this id has none, or the reverse.
pub fn register(registration: Registration) -> Result<()> {
    let id: EnvId = registration.id().parse()?;
    let refuse = |reason: String| {
        Err(Error::Registration {
            id: id.to_string(),
            reason,
        })
    };
    let mut table = TABLE.write().unwrap_or_else(PoisonError::into_inner);
    if table.contains_key(&id) {
        return refuse("the id is taken: choose another, or a namespace of your own".into());
    }
    let other = table
        .keys()
        .find(|other| other.same_name(&id) && other.version.is_some() != id.version.is_some());
    if let Some(other) = other {
        return refuse(format!(
            "`{other}` exists: give all ids of a name a version, or none"
        ));
    }
    table.insert(id, vec![registration]);
    Ok(())
}

/// Every registration, ordered by id; an id that two crates register occurs twice.
pub fn all() -> Vec<Registration> {
    with_table(|table| table.values().flatten().cloned().collect())
}

/// As [`all`], without environments that have external requirements; see [`Registration::needs`].
pub fn self_contained() -> Vec<Registration> {
    all()
        .into_iter()
        .filter(|registration| registration.needs.is_none())
        .collect()
}

/// The registration of an id.
///
/// # Errors
/// [`Error::MalformedId`]; an error that names the unknown part of the id and a similar one;
/// [`Error::Duplicate`] if several crates register it.
pub fn find(id: &str) -> Result<Registration> {
    let id: EnvId = id.parse()?;
    with_table(|table| find_in(table, &id))
}

fn find_in(table: &Table, id: &EnvId) -> Result<Registration> {
    match table.get(id).map(Vec::as_slice) {
        Some([registration]) => Ok(registration.clone()),
        Some(duplicates) => {
            let crates: BTreeSet<_> = duplicates
                .iter()
                .map(|registration| registration.source.package)
                .collect();
            Err(Error::Duplicate {
                id: id.to_string(),
                crates: crates.into_iter().collect::<Vec<_>>().join(", "),
            })
        }
        None => Err(not_found(table, id)),
    }
}

/// The registration that [`make`] uses for an id: without a version, the newest of that name. The
/// second part is a warning about the choice.
///
/// # Errors
/// The errors of [`find`].
pub fn resolve(id: &str) -> Result<(Registration, Option<String>)> {
    let asked: EnvId = id.parse()?;
    with_table(|table| {
        let newest = table.keys().filter(|other| other.same_name(&asked)).max();
        let Some(newest) = newest else {
            return Err(not_found(table, &asked));
        };
        if asked.version.is_none() && newest.version.is_some() {
            let note = format!("using the latest version `{newest}` of the unversioned `{asked}`");
            return Ok((find_in(table, newest)?, Some(note)));
        }
        let registration = find_in(table, &asked)?;
        let note = (asked.version < newest.version)
            .then(|| format!("`{asked}` is out of date: consider upgrading to `{newest}`"));
        Ok((registration, note))
    })
}

/// The error of an unknown id, which names its unknown part.
fn not_found(table: &Table, id: &EnvId) -> Error {
    let crates = || {
        let names: std::collections::BTreeSet<_> = table
            .values()
            .flatten()
            .map(|registration| registration.source.package)
            .filter(|name| !name.is_empty())
            .collect();
        if names.is_empty() {
            return "no crate with environments is linked: add `use gym_classic as _;`, or to the crate `gym` its feature `classic`".to_owned();
        }
        let names = Vec::from_iter(names).join(", ");
        format!(
            "linked crates: {names}; link another with `use its_name as _;`, or through the crate `gym` with its feature"
        )
    };
    if id.namespace.is_some() && !table.keys().any(|other| other.namespace == id.namespace) {
        let namespace = id.namespace.clone().unwrap_or_default();
        let known = table.keys().filter_map(|other| other.namespace.as_deref());
        let near = nearest(&namespace, known).map(|near| format!(": did you mean `{near}`?"));
        let hint = format!("{} ({})", near.unwrap_or_default(), crates());
        return Error::NamespaceNotFound { namespace, hint };
    }
    let versions: Vec<_> = table.keys().filter(|other| other.same_name(id)).collect();
    let Some(newest) = versions.last() else {
        let known: Vec<_> = table
            .keys()
            .filter(|other| other.namespace == id.namespace)
            .collect();
        let near = nearest(&id.name, known.iter().map(|other| other.name.as_str()));
        // the requested version, else the newest
        let best = |ids: Vec<&EnvId>| {
            let same = ids.iter().rev().find(|other| other.version == id.version);
            same.or(ids.last()).map(ToString::to_string)
        };
        let elsewhere = table
            .keys()
            .filter(|other| other.name.eq_ignore_ascii_case(&id.name));
        let similar = near.map(|name| known.iter().copied().filter(move |id| id.name == name));
        let near = best(elsewhere.collect())
            .or(similar.and_then(|similar| best(similar.collect())))
            .map(|near| format!(": did you mean `{near}`?"));
        let hint = format!("{} ({})", near.unwrap_or_default(), crates());
        return Error::NameNotFound {
            id: id.to_string(),
            hint,
        };
    };
    match id.version {
        Some(version) if newest.version.is_some_and(|newest| version < newest) => {
            Error::DeprecatedVersion {
                name: id.unversioned(),
                version,
                latest: newest.to_string(),
            }
        }
        version => {
            // suggest `ALE/Pong-v5` for `Pong-v5`
            let elsewhere = table
                .keys()
                .filter(|other| other.name == id.name && other.version == id.version);
            let available = versions
                .into_iter()
                .chain(elsewhere)
                .map(|id| format!("`{id}`"));
            let available = available.collect::<Vec<_>>().join(", ");
            Error::VersionNotFound {
                name: id.unversioned(),
                version,
                available,
            }
        }
    }
}

/// The registry as a table of text: ids in columns, grouped by family.
pub fn pretty(columns: usize) -> String {
    let mut text = String::new();
    for (family, registrations) in by_family(all()) {
        let package = match family.package {
            "" => String::new(),
            package if package == family.name => String::new(),
            package => format!(": {package}"),
        };
        let needs = registrations
            .iter()
            .find_map(|registration| registration.needs);
        let needs = needs.map_or_else(String::new, |need| format!(" (needs {})", need.what));
        text += &format!("===== {}{package}{needs} =====\n", family.name);
        let ids: Vec<_> = registrations.iter().map(Registration::id).collect();
        let width = ids.iter().map(|id| id.len()).max().unwrap_or(0);
        for row in ids.chunks(columns.max(1)) {
            let cells: Vec<_> = row.iter().map(|id| format!("{id:width$}")).collect();
            text += cells.join("  ").trim_end();
            text += "\n";
        }
    }
    text
}
