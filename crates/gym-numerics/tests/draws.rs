//! Draws of many small numbers, and the draw that follows them. numpy 2.5 made the numbers.

use gym_numerics::Generator;

/// Numbers that numpy draws with the seed 7 from `low` to each of some bounds in turn, four times.
#[test]
fn bytes_below_bounds_in_turn_are_numpys() {
    type Row = (u8, &'static [u8], &'static [u8], i64);
    const ROWS: &[Row] = &[
        (0, &[5], &[3, 1, 5, 5], 625),
        (2, &[5], &[4, 3, 5, 5], 625),
        (
            0,
            &[0, 255, 3],
            &[0, 139, 1, 0, 229, 3, 0, 169, 1, 0, 6, 2],
            684,
        ),
        (
            2,
            &[2, 255, 3],
            &[2, 139, 2, 2, 229, 3, 2, 169, 2, 2, 7, 3],
            684,
        ),
        (0, &[255, 255], &[139, 74, 229, 241, 169, 65, 6, 160], 684),
        (1, &[255, 255], &[139, 74, 229, 241, 169, 65, 6, 160], 684),
        (0, &[7, 0], &[4, 0, 2, 0, 7, 0, 7, 0], 625),
        (
            0,
            &[200, 100, 1, 0, 255],
            &[
                179, 66, 0, 0, 6, 125, 58, 0, 0, 38, 137, 80, 1, 0, 229, 76, 98, 0, 0, 148,
            ],
            775,
        ),
    ];
    for (low, bounds, known, next) in ROWS {
        let (mut rng, mut out) = (Generator::from(7), vec![9; known.len()]);
        rng.integers_u8_each(*low, bounds, &mut out);
        assert_eq!((&out[..], rng.integers(0, 1000)), (*known, *next));
        // fewer numbers begin alike
        let (mut rng, mut few) = (Generator::from(7), vec![9; known.len() - 1]);
        rng.integers_u8_each(*low, bounds, &mut few);
        assert_eq!(few, known[..few.len()]);
    }
    let (mut rng, mut out) = (Generator::from(7), [9; 3]);
    rng.integers_u8_each(2, &[], &mut out);
    assert_eq!((out, rng), ([9; 3], Generator::from(7)));
}

/// Tosses of any number are the first of more tosses; what is left of a word is dropped.
#[test]
fn tosses_are_numpys() {
    const ALL: &str = "10111001100111110101001100011010000011100010101101110000101010010\
                       01011010000111001010110100011001001000011110110010000011101101100";
    let known: Vec<i8> = ALL.bytes().map(|byte| (byte - b'0') as i8).collect();
    for (n, next) in [
        (1, 625),
        (4, 625),
        (5, 684),
        (63, 131),
        (64, 131),
        (65, 797),
        (128, 509),
        (130, 995),
    ] {
        let (mut rng, mut out) = (Generator::from(7), vec![9; n]);
        rng.tosses(&mut out);
        assert_eq!((&out[..], rng.integers(0, 1000)), (&known[..n], next));
    }
}
