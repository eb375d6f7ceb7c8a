//! Maps: Gymnasium's own, the check of a given one, and random ones.

use gym_core::{Error, Generator, Result, Task};

use super::FrozenLakeDynamics;

/// The maps of Gymnasium's `MAPS`.
const MAPS: [(&str, &[&str]); 2] = [
    ("4x4", &["SFFF", "FHFH", "FFFH", "HFFG"]),
    (
        "8x8",
        &[
            "SFFFFFFF", "FFFFFFFF", "FFFHFFFF", "FFFFFHFF", "FFFHFFFF", "FHHFFFHF", "FHFFHFHF",
            "FFFHFFFG",
        ],
    ),
];

pub(super) fn invalid(reason: String) -> Error {
    Error::argument(FrozenLakeDynamics::NAME, reason)
}

pub(super) fn named_map(name: &str) -> Result<Vec<String>> {
    let rows = MAPS
        .iter()
        .find_map(|(known, rows)| (*known == name).then_some(*rows))
        .ok_or_else(|| {
            let names = MAPS.map(|(name, _)| name).join(", ");
            invalid(format!(
                "unknown map_name `{name}`: the maps are {names}; others can be given as `desc`"
            ))
        })?;
    Ok(rows.iter().map(|row| (*row).to_owned()).collect())
}

pub(super) fn check_map(desc: &[String]) -> Result<()> {
    let Some(ncol) = desc.first().map(String::len).filter(|ncol| *ncol > 0) else {
        return Err(invalid(
            "desc is empty: give a string for each row, as [\"SFFF\", \"FHFG\"]".to_owned(),
        ));
    };
    if let Some(letter) = desc
        .concat()
        .chars()
        .find(|letter| !"SFHG".contains(*letter))
    {
        return Err(invalid(format!(
            "desc has the letter {letter:?}: use S (start), F (frozen), H (hole) and G (goal)"
        )));
    }
    if let Some(row) = desc.iter().find(|row| row.len() != ncol) {
        return Err(invalid(format!(
            "desc has rows of different length: `{}` and `{row}`; make all equally long",
            desc[0]
        )));
    }
    if !desc.iter().any(|row| row.contains('S')) {
        return Err(invalid("desc has no start: mark a cell with S".to_owned()));
    }
    Ok(())
}

/// The most cells that [`generate_random_map`] draws, which takes less than a second.
const MAX_DRAWS: usize = 100_000_000;

/// Returns a random square map with a path from the start, top left, to the goal, bottom right. Any
/// other cell is frozen with probability `p`, otherwise a hole. A seed gives the same map as
/// Gymnasium's function of this name; `None` uses a seed from the operating system.
///
/// # Errors
/// [`Error::InvalidArgument`] for a `size` below 2, for a `p` that is not in `(0, 1]`, and if no
/// drawn map has a path because `p` is small or `size` is large.
pub fn generate_random_map(size: usize, p: f64, seed: Option<u64>) -> Result<Vec<String>> {
    let invalid = |reason: String| Error::argument("generate_random_map", reason);
    if size < 2 {
        return Err(invalid(format!(
            "size is {size}: the smallest map is 2 by 2"
        )));
    }
    if !(p > 0.0 && p <= 1.0) {
        return Err(invalid(format!(
            "p is {p}: the probability of a frozen cell is above 0, at most 1"
        )));
    }
    let mut rng = seed.map_or_else(Generator::from_os, |seed| Ok(Generator::from(seed)))?;
    for _ in 0..MAX_DRAWS / size.saturating_mul(size) {
        let mut board = vec![vec![b'F'; size]; size];
        for cell in board.iter_mut().flatten() {
            *cell = b"FH"[rng.choice_p(&[p, 1.0 - p])];
        }
        board[0][0] = b'S';
        board[size - 1][size - 1] = b'G';
        if has_path(&board) {
            return Ok(board
                .into_iter()
                .map(|row| row.into_iter().map(char::from).collect())
                .collect());
        }
    }
    Err(invalid(format!(
        "no map of size {size} with p {p} had a path: choose a larger p or a smaller size"
    )))
}

/// Whether a square board has a path from the top left to the bottom right, by depth-first search.
fn has_path(board: &[Vec<u8>]) -> bool {
    let size = board.len();
    let mut discovered = vec![false; size * size];
    let mut frontier = vec![(0, 0)];
    while let Some((row, col)) = frontier.pop() {
        // a step off the top or left wraps around to a large number, which is out of range too
        let on_ice = row < size && col < size && board[row][col] != b'H';
        if !on_ice || std::mem::replace(&mut discovered[row * size + col], true) {
            continue;
        }
        if board[row][col] == b'G' {
            return true;
        }
        frontier.extend([
            (row + 1, col),
            (row, col + 1),
            (row.wrapping_sub(1), col),
            (row, col.wrapping_sub(1)),
        ]);
    }
    false
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Recorded from Gymnasium: no episode visits every hole.
    #[test]
    fn holes_are_where_gymnasium_has_them() {
        let holes = |name| {
            let map = named_map(name).unwrap().concat();
            map.match_indices('H').map(|(i, _)| i).collect::<Vec<_>>()
        };
        assert_eq!(holes("4x4"), [5, 7, 11, 12]);
        assert_eq!(holes("8x8"), [19, 29, 35, 41, 42, 46, 49, 52, 54, 59]);
    }

    /// A path may also go up and to the left.
    #[test]
    fn paths_lead_in_every_direction() {
        let board = |rows: &[&str]| {
            rows.iter()
                .map(|row| row.as_bytes().to_vec())
                .collect::<Vec<_>>()
        };
        let up = ["SHFFF", "FHFHF", "FHFHF", "FFFHF", "HHHHG"];
        let left = ["SFFFF", "HHHHF", "FFFFF", "FHHHH", "FFFFG"];
        assert!(has_path(&board(&up)) && has_path(&board(&left)));
        assert!(!has_path(&board(&["SHF", "FHF", "FHG"])));
    }

    /// Gymnasium's `generate_random_map(4, 0.8, seed)`.
    #[test]
    fn random_maps_are_gymnasiums() {
        for (seed, map) in [
            (0, ["SFFF", "HHFF", "FHHF", "HFFG"]),
            (42, ["SFHF", "FHFF", "FFFH", "FHFG"]),
            (123, ["SFFF", "FHHF", "HHFF", "HFFG"]),
        ] {
            assert_eq!(generate_random_map(4, 0.8, Some(seed)).unwrap(), map);
        }
        assert_eq!(generate_random_map(2, 1.0, None).unwrap(), ["SF", "FG"]);
    }

    #[test]
    fn an_impossible_random_map_is_an_error() {
        for (size, p) in [
            (1, 0.8),
            (4, 0.0),
            (4, -1.0),
            (4, 1.5),
            (4, f64::NAN),
            (usize::MAX, 0.8),
            (50, 1e-9),
        ] {
            assert!(generate_random_map(size, p, Some(0)).is_err(), "{size} {p}");
        }
    }
}
