//! `cargo xtask soak`

use gym::{Env, Error, Registration, Reset, Result, Value};

use crate::inputs;
use crate::output::say;
use crate::workspace::Workspace;

#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The environments; by default those that this workspace registers.
    ids: Vec<String>,
    /// Steps over these environments together.
    #[arg(long, default_value_t = 1_000_000, allow_negative_numbers = true, value_parser = inputs::parse_count)]
    steps: u64,
    /// Seeds environments and actions.
    #[arg(long, default_value_t = 0, allow_negative_numbers = true, value_parser = inputs::parse_seed)]
    seed: u64,
}

/// The allowed growth of memory after the first tenth of an environment's steps. (In these first
/// steps, buffers grow.)
const MAX_GROWTH: u64 = 2 << 20; // bytes

/// Steps every environment for a long time. Growing memory is an error.
pub(crate) fn soak(arguments: &Arguments, workspace: &Workspace) -> Result<()> {
    let registrations = workspace.select(&arguments.ids)?;
    let each = arguments.steps.div_ceil(registrations.len().max(1) as u64);
    let mut total = 0;
    for registration in &registrations {
        let (episodes, growth) = soak_one(registration, each, arguments.seed)?;
        total += each;
        let id = registration.id();
        say(format_args!(
            "{id:34} {each} steps, {episodes} episodes, {} kB more memory",
            growth / 1024
        ))?;
        if growth > MAX_GROWTH {
            return Err(Error::custom(format!(
                "`{id}` grows: {growth} bytes more after {each} steps"
            )));
        }
    }
    say(format_args!(
        "{total} steps of {} environments with flat memory",
        registrations.len()
    ))?;
    Ok(())
}

/// Steps one environment. Returns the number of episodes, and the growth of memory in bytes.
fn soak_one(registration: &Registration, steps: u64, seed: u64) -> Result<(u64, u64)> {
    let mut env = gym::make(registration.id())?;
    let mut actions = env.action_space().sampler(seed);
    let (mut action, mut observation) = (Value::Null, Value::Null);
    env.reset_into(&Reset::seed(seed), &mut observation)?;
    let (mut episodes, mut settled) = (0, 0);
    for step in 0..steps {
        if step == steps / 10 {
            settled = resident_memory();
        }
        actions.sample_into(&mut action);
        if env.step_into(&action, &mut observation)?.done() {
            episodes += 1;
            env.reset_into(&Reset::default(), &mut observation)?;
        }
    }
    Ok((episodes, resident_memory().saturating_sub(settled)))
}

/// Returns the bytes of memory in use, from Linux's `/proc`; 0 on other systems.
fn resident_memory() -> u64 {
    const PAGE: u64 = 4096; // bytes
    let statm = std::fs::read_to_string("/proc/self/statm").unwrap_or_default();
    // `statm` has the size in pages, then the resident pages
    let pages = statm
        .split_whitespace()
        .nth(1)
        .and_then(|pages| pages.parse::<u64>().ok());
    pages.unwrap_or(0) * PAGE
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_episode_is_counted_at_its_end() {
        let pendulum = gym::registry::find("Pendulum-v1").unwrap();
        for (steps, episodes) in [(199, 0), (200, 1), (999, 4), (1000, 5)] {
            let (found, _) = soak_one(&pendulum, steps, 0).unwrap();
            assert_eq!(found, episodes, "{steps} steps of episodes of 200");
        }
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn memory_is_what_was_written_to() {
        const SIZE: usize = 1 << 30;
        let before = resident_memory();
        assert!(before > 1 << 20, "{before} bytes");
        let reserved: Vec<u8> = std::hint::black_box(Vec::with_capacity(SIZE));
        let grown = resident_memory().saturating_sub(before);
        assert!(grown < SIZE as u64 / 2, "{grown} bytes are only reserved");
        drop(reserved);
        let before = resident_memory();
        let written = std::hint::black_box(vec![1_u8; 256 << 20]);
        let grown = resident_memory().saturating_sub(before);
        // (other tests may return memory meanwhile)
        assert!(grown > 128 << 20, "{grown} bytes");
        drop(written);
    }
}
