//! All checks as a test of a plugin.

use gym_core::{Error, registry};

use crate::report::{Format, Report};
use crate::run::{Progress, reports_with};

/// Returns the ids that the crate `crate_name` registers at link time. The names `my-envs` and
/// `my_envs` mean the same crate.
pub fn ids_of(crate_name: &str) -> Vec<String> {
    let underscored = crate_name.replace('-', "_");
    let all = registry::all();
    let own = all
        .iter()
        .filter(|registration| registration.source.package.replace('-', "_") == underscored);
    own.map(|registration| registration.id().to_owned())
        .collect()
}

/// The function that [`suite!`](crate::suite) calls.
///
/// # Panics
/// If the crate registers nothing, or one of its environments breaks a rule.
pub fn assert_conforms(crate_name: &str) {
    let ids = ids_of(crate_name);
    assert!(
        !ids.is_empty(),
        "`{crate_name}` registers no environment: put `gym_core::register!(...)` at the top level of a module, and \
         let there be one gym-core in `cargo tree --duplicates`"
    );
    let long = |progress: Progress<'_>| {
        if !matches!(progress, Progress::Begins { .. }) {
            eprintln!("{progress}");
        }
    };
    let reports = reports_with(&ids, long).unwrap_or_else(|error: Error| panic!("{error}"));
    let text = Format::Text.write(&reports);
    // print the text once: by the panic, or below
    assert!(reports.iter().all(Report::passes), "{text}");
    println!("{text}");
}

/// A plugin's test: makes a `#[test]` that runs every check over every environment that a crate
/// registers.
///
/// Put it in a file of the folder `tests`, with the crate's name as in `use`:
///
/// ```
/// # use gym_conform as my_envs;
/// gym_conform::suite!(my_envs);
/// ```
#[macro_export]
macro_rules! suite {
    ($name:ident) => {
        // (Cargo links only crates that the code names)
        use $name as _;

        #[test]
        fn every_environment_conforms() {
            $crate::assert_conforms(stringify!($name));
        }
    };
}
