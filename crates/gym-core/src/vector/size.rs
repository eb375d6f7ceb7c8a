//! The largest number of sub-environments.

use std::hint::black_box;

use crate::spaces::{MAX_ELEMENTS, Space};
use crate::value::{Error, Result};

/// The most threads: more than machines have cores, and within the limits of common systems.
pub(super) const MAX_THREADS: usize = 1024;

/// Refuses 0 sub-environments, more than batched spaces can hold, and more than fit in memory,
/// before anything is built. Each takes `bytes` beside its rows of the columns.
pub fn check(n: usize, observation: &Space, action: &Space, bytes: usize) -> Result<()> {
    if n == 0 {
        return Err(Error::argument(
            "a vector",
            "it needs at least one sub-environment",
        ));
    }
    check_len(n, action.len_of_row())?;
    check_bytes(
        n,
        observation,
        bytes.saturating_add(8 * action.len_of_row()),
    )
}

/// Refuses columns whose rows do not fit in memory.
pub(super) fn check_rows(n: usize, observation: &Space) -> Result<()> {
    check_bytes(n, observation, 0)
}

/// Checks the memory of `n` rows as [`check_rows`] does, with `bytes` more for each
/// sub-environment.
fn check_bytes(n: usize, observation: &Space, bytes: usize) -> Result<()> {
    let numbers = observation.len_of_row();
    check_len(n, numbers)?;
    // observations and final observations, as numbers of up to 8 bytes; reward and flags
    if fits(n.checked_mul((2 * 8 * numbers + 16).saturating_add(bytes))) {
        return Ok(());
    }
    Err(Error::argument(
        "a vector",
        format!("num_envs = {n} does not fit in memory"),
    ))
}

/// Checks that a batch can have `n` elements of `numbers` numbers.
fn check_len(n: usize, numbers: usize) -> Result<()> {
    let most = MAX_ELEMENTS / numbers.max(1);
    if n <= most {
        return Ok(());
    }
    let reason = format!(
        "num_envs is {n}: at most {most} are possible, as a batch has at most {MAX_ELEMENTS} numbers"
    );
    Err(Error::argument("a vector", reason))
}

/// Whether the system can allocate `bytes` bytes.
fn fits(bytes: Option<usize>) -> bool {
    let mut probe = Vec::<u8>::new();
    let reserved = bytes.is_some_and(|bytes| probe.try_reserve_exact(bytes).is_ok());
    // the compiler may otherwise remove an unused allocation
    black_box(&mut probe);
    reserved
}

/// The error of an index beyond the last sub-environment.
pub fn no_such_env(index: usize, num_envs: usize) -> Error {
    Error::custom(format!(
        "there is no sub-environment {index}: the indices are 0 to {}",
        num_envs - 1
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_environments_that_cannot_be_are_refused() {
        let (observation, action) = (Space::boxed([-1.0; 4], [1.0; 4]), Space::discrete(2));
        let refusal =
            |n, bytes| check(n, &observation, &action, bytes).map_err(|error| error.to_string());
        assert_eq!(refusal(1, 0), Ok(()));
        assert_eq!(refusal(1000, 1000), Ok(()));
        assert!(
            refusal(0, 0)
                .unwrap_err()
                .contains("at least one sub-environment")
        );
        // four numbers of an observation, or one number of an action
        let most = MAX_ELEMENTS / 4;
        let reason = format!("num_envs is {}: at most {most} are possible", most + 1);
        assert!(refusal(most + 1, 0).unwrap_err().contains(&reason));
        let swapped = check(most + 1, &action, &observation, 0)
            .unwrap_err()
            .to_string();
        assert!(swapped.contains(&reason), "{swapped}");
        assert!(
            check_rows(most + 1, &observation)
                .unwrap_err()
                .to_string()
                .contains(&reason)
        );
        // the memory of each sub-environment, besides its row
        for bytes in [usize::MAX, usize::MAX / 8, usize::MAX / 16] {
            assert!(
                refusal(16, bytes)
                    .unwrap_err()
                    .contains("num_envs = 16 does not fit in memory"),
                "{bytes}"
            );
        }
    }
}
