//! Reset options of all ids, where the sample of conformance has one of each task.

use gym::prelude::*;
use gym::{make, registry};
use serde_json::Value as Json;

#[test]
fn every_example_of_an_option_is_accepted() {
    let mut refused = Vec::new();
    for registration in registry::self_contained() {
        for (name, example) in registration.reset_options.0 {
            let example: Json = serde_json::from_str(example).unwrap();
            let reset = Reset::seed(3).option(name, example);
            if let Err(error) = make(registration.id()).unwrap().reset(reset) {
                refused.push(format!("{}: {error}", registration.id()));
            }
        }
    }
    assert!(refused.is_empty(), "{}", refused.join("\n"));
}
