//! How many sub-environments there can be.

use std::hint::black_box;

use crate::spaces::MAX_ELEMENTS;
use crate::{Error, Result, Space};

/// More threads than any machine has cores to gain from; so many can be had on common systems.
pub(super) const MAX_THREADS: usize = 1024;

/// Refuses a number of sub-environments that cannot be, before anything is built: none, more than batched
/// spaces can hold, or more than memory holds at `bytes` for each beside its row of the columns.
pub(crate) fn check(n: usize, observation: &Space, action: &Space, bytes: usize) -> Result<()> {
    let refuse = |reason: String| Err(Error::argument("a vector", reason));
    if n == 0 {
        return refuse("there are no sub-environments: at least one is needed".into());
    }
    let numbers = observation.len_of_row().max(action.len_of_row()).max(1);
    if n > MAX_ELEMENTS / numbers {
        return refuse(format!(
            "num_envs is {n}: at most {} are possible, as a batch has at most {MAX_ELEMENTS} numbers",
            MAX_ELEMENTS / numbers
        ));
    }
    // observations and final observations, as numbers of up to 8 bytes; reward and flags
    let row = 2 * 8 * observation.len_of_row() + 8 * action.len_of_row() + 16;
    if fits(n.checked_mul(row.saturating_add(bytes))) {
        return Ok(());
    }
    refuse(format!("num_envs is {n}: so many do not fit in memory"))
}

/// Whether the system would give so much memory.
fn fits(bytes: Option<usize>) -> bool {
    let mut probe = Vec::<u8>::new();
    let reserved = bytes.is_some_and(|bytes| probe.try_reserve_exact(bytes).is_ok());
    // the compiler may otherwise leave out memory that nobody uses
    black_box(&mut probe);
    reserved
}
