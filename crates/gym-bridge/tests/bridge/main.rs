//! Environments of a real Python with gymnasium: `GYM_BRIDGE_PYTHON`, or else `python3`. Without
//! gymnasium, the tests print a note and pass.

mod failures;
mod recorded;
mod snapshots;
mod values;

use std::process::Command;

use gym_bridge as _;
use gym_core::registry::EnvBuilder;
use gym_core::{BoxEnv, EnvExt, builder};

const MODULE: &str = "tests.python.envs";

fn python() -> String {
    std::env::var("GYM_BRIDGE_PYTHON").unwrap_or_else(|_| "python3".into())
}

/// Whether Python can import all `modules`. If not, prints the missing modules.
fn has(modules: &[&str]) -> bool {
    let import = format!("import {}", modules.join(", "));
    let there = Command::new(python())
        .args(["-W", "ignore", "-c", &import])
        .output()
        .is_ok_and(|output| output.status.success());
    if !there {
        println!(
            "SKIPPED: `{}` has not all of {}",
            python(),
            modules.join(", ")
        );
    }
    there
}

fn bridge(env_id: &str) -> EnvBuilder {
    builder("GymV26Environment-v0")
        .arg("env_id", env_id)
        .arg("python", python())
        .arg("backend", "gymnasium")
}

fn bad() -> EnvBuilder {
    bridge("bridge/Bad-v0").arg("module", MODULE)
}

fn echo(kind: &str) -> EnvBuilder {
    bridge("bridge/Echo-v0")
        .arg("module", MODULE)
        .arg("make_kwargs", serde_json::json!({"kind": kind}))
}

fn is_running(pid: i64) -> bool {
    let status = std::fs::read_to_string(format!("/proc/{pid}/status")).unwrap_or_default();
    status
        .lines()
        .any(|line| line.starts_with("State:") && !line.contains('Z'))
}

/// Returns the process id of an environment of the kind `Bad`.
fn pid(env: &BoxEnv) -> i64 {
    env.info_map()["pid"].as_int().expect("a number")
}

/// Returns an environment that counts its steps in its info, without the wrappers of Python's
/// `make`.
fn widens(start: i64) -> EnvBuilder {
    let env = bridge("bridge/Widens-v0")
        .arg("module", MODULE)
        .arg("allow_pickle", true);
    let env = env.arg("make_kwargs", serde_json::json!({ "start": start }));
    env.order_enforce(false).disable_env_checker(true)
}
