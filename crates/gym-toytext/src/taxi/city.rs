//! The map, how the taxi moves on it, and states as numbers.

use super::Action;

/// Cell `(r, c)` is at `MAP[1 + r][1 + 2 * c]`; next to the cell, `|` is a wall and `:` is no wall.
pub(super) const MAP: [&str; 7] = [
    "+---------+",
    "|R: | : :G|",
    "| : | : : |",
    "| : : : : |",
    "| | : | : |",
    "|Y| : |B: |",
    "+---------+",
];
pub(super) const SIZE: usize = 5;
/// Row and column of the locations: red, green, yellow, blue.
pub(super) const STANDS: [(usize, usize); 4] = [(0, 0), (0, 4), (4, 0), (4, 3)];
/// The passenger's position in the taxi.
pub(super) const IN_TAXI: usize = 4;
pub(super) const STATES: usize = SIZE * SIZE * 5 * 4;

/// Encodes a state: the taxi's row and column (0 to 4), the passenger (stand 0 to 3, or 4 in the
/// taxi), the destination (stand 0 to 3). The stands are red, green, yellow, blue.
pub const fn encode(row: usize, col: usize, passenger: usize, destination: usize) -> usize {
    ((row * SIZE + col) * 5 + passenger) * 4 + destination
}

/// Decodes a state below 500: row, column, passenger and destination.
pub const fn decode(state: usize) -> (usize, usize, usize, usize) {
    (state / 100, state / 20 % 5, state / 4 % 5, state % 4)
}

/// Returns 1 for each action that changes the encoded state, 0 for the others.
pub fn action_mask(state: usize) -> [i8; 6] {
    let (row, col, passenger, _) = decode(state);
    Action::ALL.map(|action| {
        i8::from(match action {
            Action::Pickup => STANDS.get(passenger) == Some(&(row, col)),
            Action::Dropoff => passenger == IN_TAXI && STANDS.contains(&(row, col)),
            heading => drive(row, col, heading) != (row, col),
        })
    })
}

/// Returns the neighbouring cell, or the same cell if a wall or the border is in the way.
pub(super) fn drive(row: usize, col: usize, heading: Action) -> (usize, usize) {
    let open = |column: usize| {
        MAP.get(1 + row)
            .is_some_and(|line| line.as_bytes()[column] == b':')
    };
    match heading {
        Action::South => ((row + 1).min(SIZE - 1), col),
        Action::North => (row.saturating_sub(1), col),
        Action::East if open(2 * col + 2) => (row, col + 1),
        Action::West if open(2 * col) => (row, col - 1),
        _ => (row, col),
    }
}

/// Returns the headings to the left and right of `heading`.
pub(super) const fn sides(heading: Action) -> [Action; 2] {
    match heading {
        Action::South => [Action::East, Action::West],
        Action::North => [Action::West, Action::East],
        Action::East => [Action::North, Action::South],
        _ => [Action::South, Action::North],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decode_is_the_inverse_of_encode() {
        for state in 0..STATES {
            let (row, col, passenger, destination) = decode(state);
            assert!(row < 5 && col < 5 && passenger < 5 && destination < 4);
            assert_eq!(encode(row, col, passenger, destination), state);
        }
        assert_eq!(encode(4, 4, 4, 3), STATES - 1);
    }
}
