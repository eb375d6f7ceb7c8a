//! The level of the CPU that computations use. Results are equal on every level; a lower one shows
//! that on one machine.

use std::env;
use std::ffi::OsStr;
use std::sync::LazyLock;

use fearless_simd::Level;

/// The environment variable that lowers the level.
const VARIABLE: &str = "GYM_CPU";

static LEVEL: LazyLock<Level> =
    LazyLock::new(|| requested_level().unwrap_or_else(|_| Level::new()));

/// Returns the level that computations use: what the CPU has, or less if the environment variable
/// `GYM_CPU` asks for less. The variable is read once.
///
/// | `GYM_CPU` | on x86 |
/// |---|---|
/// | not set, or `avx512` | AVX-512 where the CPU has it |
/// | `avx2` | AVX2 with fused multiply-add, without AVX-512 |
/// | `baseline` | neither; fused multiply-adds are emulated |
///
/// CPUs that are not x86 have one level.
#[inline]
#[must_use]
pub fn level() -> Level {
    *LEVEL
}

/// Returns the level that `GYM_CPU` asks for. A program that should not run with a misspelt
/// variable calls this function first; [`level`] ignores such a variable.
///
/// # Errors
/// A message that names the variable, its value and the possible values, if it has another one.
pub fn requested_level() -> Result<Level, String> {
    env::var_os(VARIABLE).map_or_else(|| Ok(Level::new()), |name| lowered(&name))
}

/// Returns the level `name`, or the CPU's if that is lower.
fn lowered(name: &OsStr) -> Result<Level, String> {
    let best = Level::new();
    match name.to_str() {
        Some("avx512") => Ok(best),
        #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
        Some("avx2") => Ok(best.as_avx2().map_or(best, Level::Avx2)),
        #[cfg(not(any(target_arch = "x86", target_arch = "x86_64")))]
        Some("avx2") => Ok(best),
        Some("baseline") => Ok(Level::baseline()),
        _ => Err(format!(
            "{VARIABLE} is {name:?}: set it to avx512, avx2 or baseline, or do not set it"
        )),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_level_is_lowered_and_never_raised() {
        let lowered = |name: &str| lowered(name.as_ref()).unwrap();
        let best = Level::new();
        assert_eq!(
            format!("{:?}", lowered("avx512")),
            format!("{best:?}"),
            "at most what the CPU has"
        );
        let is_x86 = cfg!(any(target_arch = "x86", target_arch = "x86_64"));
        #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
        {
            assert!(lowered("avx2").as_avx512().is_none());
            assert_eq!(
                lowered("avx2").as_avx2().is_some(),
                best.as_avx2().is_some()
            );
            let asks_the_build = cfg!(target_feature = "avx2");
            assert_eq!(lowered("baseline").as_avx2().is_some(), asks_the_build);
        }
        if !is_x86 {
            assert_eq!(format!("{:?}", lowered("avx2")), format!("{best:?}"));
        }
    }

    #[test]
    fn another_name_is_an_error_that_lists_the_names() {
        for name in ["", "AVX2", "sse", "avx2 "] {
            let error = lowered(name.as_ref()).unwrap_err();
            assert!(error.contains("GYM_CPU") && error.contains(name), "{error}");
            assert!(error.contains("avx512, avx2 or baseline"), "{error}");
        }
    }
}
