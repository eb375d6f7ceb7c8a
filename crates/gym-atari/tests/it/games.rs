//! Rarely used rules of games, tested with RAM in which they apply.

use gym_atari::Action;
use gym_atari::games::{self, Ram};

/// Returns RAM that is 0 except for `bytes`.
fn ram(bytes: &[(usize, u8)]) -> [u8; 128] {
    let mut ram = [0; 128];
    bytes.iter().for_each(|&(index, byte)| ram[index] = byte);
    ram
}

/// Each ROM is known by the MD5 in `md5.json` of ale-py 0.12.1.
#[test]
fn games_are_known_by_ale_pys_md5() {
    let known = |game: &games::Game| {
        let found = games::by_md5(game.md5).map(|game| game.name);
        assert_eq!(found, Some(game.name));
        format!("{} {}\n", game.name, game.md5)
    };
    let mut lines: Vec<String> = games::GAMES.iter().map(known).collect();
    lines.sort();
    assert_eq!(lines.len(), 94);
    let text = lines.concat();
    assert_eq!(crc32fast::hash(text.as_bytes()), 0xf3d5_e5d8, "{text}");
}

/// What the table says of a game, and what its functions read from RAM by lot: mostly zeros, mostly small numbers, any bytes.
fn read(game: &games::Game) -> String {
    const SMALL: [u8; 12] = [0, 1, 2, 3, 4, 7, 0x10, 0x40, 0x80, 0xaa, 0xfe, 0xff];
    let mut seed: u64 = 7;
    let mut lot = |n: usize| {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (seed >> 33) as usize % n
    };
    let mut read = format!("{game:?}");
    // the addresses of functions differ from build to build
    read = read
        .split(", ")
        .filter(|field| !field.contains(": 0x"))
        .collect();
    for round in 0..600 {
        let mut bytes = [0; 128];
        for byte in &mut bytes {
            *byte = match round % 4 {
                0 if lot(4) > 0 => 0,
                0 | 1 => SMALL[lot(12)],
                2 => SMALL[lot(4)],
                _ => lot(256) as u8,
            };
        }
        let (ram, mode) = (Ram(&bytes), lot(20) as u16);
        let flags = [
            (game.over)(&ram),
            (game.rewards_count)(&ram),
            (game.lives_count)(&ram),
            (game.mode_also)(&ram, mode),
        ];
        read += &format!("{} {} {flags:?}", (game.score)(&ram), (game.lives)(&ram));
    }
    read
}

/// The games were compared with ale-py on their ROMs, which a change's tests lack: this is what they were then.
#[test]
fn games_are_read_as_when_they_were_compared_with_ale_py() {
    let found: Vec<_> = games::GAMES
        .iter()
        .map(|game| {
            format!(
                "{} {:08x}",
                game.name,
                crc32fast::hash(read(game).as_bytes())
            )
        })
        .collect();
    let known: Vec<_> = include_str!("games.txt").lines().collect();
    assert_eq!(found.len(), known.len());
    let unlike: Vec<_> = found
        .iter()
        .filter(|line| !known.contains(&&***line))
        .collect();
    assert!(unlike.is_empty(), "{unlike:#?}");
}

/// The message does not list every game.
#[test]
fn an_unknown_game_is_told_those_that_begin_alike() {
    for (name, words) in [
        ("brekout", "breakout"),
        ("Brekout", "breakout"),
        ("7up", "the names of their ROMs"),
        ("", "the names of their ROMs"),
    ] {
        let env = gym_core::builder("ALE/Pong-v5").arg("game", name).build();
        let error = env.expect_err("no game").to_string();
        assert!(
            error.contains("unknown game") && error.contains(words),
            "{error}"
        );
        assert!(error.len() < 300 && !error.contains("pong"), "{error}");
    }
}

/// The name of an action says where the stick points, and whether the button is pressed.
#[test]
fn actions_do_what_their_names_say() {
    for action in Action::ALL {
        let name = action.name();
        let sign = |[plus, minus]: [&str; 2]| {
            i32::from(name.contains(plus)) - i32::from(name.contains(minus))
        };
        assert_eq!(action.vertical(), sign(["UP", "DOWN"]), "{name}");
        assert_eq!(action.horizontal(), sign(["RIGHT", "LEFT"]), "{name}");
        assert_eq!(action.fire(), name.contains("FIRE"), "{name}");
    }
}

/// Krull is over only in one phase of its final sequence. Play continues if the last life was lost
/// earlier, or if lives remain.
#[test]
fn krull_ends_where_ale_pys_does() {
    let krull = games::by_name("krull").unwrap();
    let over = |bytes: &[(usize, u8)]| (krull.over)(&Ram(&ram(bytes)));
    assert!(over(&[(0x00, 0x80), (0x1f, 0x00), (0x22, 0x03)]));
    assert!(
        over(&[(0x00, 0x80), (0x1f, 0xf8), (0x22, 0x03)]),
        "only three bits count lives"
    );
    assert!(
        !over(&[(0x00, 0x80), (0x1f, 0x01), (0x22, 0x03)]),
        "a life is left"
    );
    assert!(
        !over(&[(0x00, 0x80), (0x1f, 0x00), (0x22, 0x02)]),
        "another phase"
    );
    assert!(
        !over(&[(0x00, 0x00), (0x1f, 0x00), (0x22, 0x03)]),
        "another phase"
    );
    assert_eq!((krull.lives)(&Ram(&ram(&[(0x1f, 0x02)]))), 3);
    assert_eq!(
        (krull.score)(&Ram(&ram(&[(0x1c, 0x12), (0x1d, 0x34), (0x1e, 0x56)]))),
        123_456
    );
}

/// Blackjack is over with 1,000 points, or with none left and blank digits.
#[test]
fn blackjack_ends_where_ale_pys_does() {
    let blackjack = games::by_name("blackjack").unwrap();
    for (bytes, score, over) in [
        ([0x02, 0x00], 200, false),
        ([0x09, 0x99], 999, false),
        ([0x10, 0x00], 1000, true),
        ([0x00, 0x00], 0, false),
        ([0x0b, 0xbb], 0, true),
        ([0x0b, 0x00], 1100, true),
        ([0x00, 0xbb], 121, false),
    ] {
        let ram = ram(&[(0x06, bytes[0]), (0x09, bytes[1])]);
        assert_eq!((blackjack.score)(&Ram(&ram)), score, "{bytes:x?}");
        assert_eq!((blackjack.over)(&Ram(&ram)), over, "{bytes:x?}");
    }
}

/// Space War is over with ten points, or when its time is up.
#[test]
fn space_war_ends_where_ale_pys_does() {
    let space_war = games::by_name("space_war").unwrap();
    let over = |bytes: &[(usize, u8)]| (space_war.over)(&Ram(&ram(bytes)));
    assert!(over(&[(0x00, 0x75), (0x27, 0x10)]));
    assert!(over(&[(0x00, 0x00), (0x27, 0x03)]));
    assert!(!over(&[(0x00, 0x75), (0x27, 0x09)]));
    assert!(!over(&[(0x00, 0x75), (0x27, 0x11)]), "ten alone ends it");
}

/// The scores and ends of games that are told apart by several bytes at once, which no lot draws.
#[test]
fn rare_ends_are_scored() {
    type Bytes = &'static [(usize, u8)];
    let cases: [(&str, Bytes, i32, bool); 19] = [
        (
            "superman",
            &[(0x00, 0xac), (0x01, 0xf2), (0x1f, 0x40)],
            5999,
            true,
        ),
        (
            "superman",
            &[
                (0x00, 0xac),
                (0x01, 0xf2),
                (0x1f, 0xff),
                (0x62, 0x34),
                (0x63, 0x12),
            ],
            5245,
            true,
        ),
        (
            "superman",
            &[(0x00, 0xac), (0x01, 0xf2), (0x1f, 0xbf), (0x62, 0x34)],
            0,
            false,
        ),
        (
            "superman",
            &[(0x00, 0xad), (0x01, 0xf2), (0x1f, 0x40), (0x62, 0x34)],
            0,
            false,
        ),
        (
            "superman",
            &[(0x00, 0xac), (0x01, 0xf3), (0x1f, 0x40), (0x62, 0x34)],
            0,
            false,
        ),
        (
            "tic_tac_toe_3d",
            &[(0x7e, 0x10), (0x7f, 0xf3), (0x61, 0x08)],
            1,
            true,
        ),
        (
            "tic_tac_toe_3d",
            &[(0x7e, 0x10), (0x7f, 0xf3), (0x61, 0x09)],
            -1,
            true,
        ),
        (
            "tic_tac_toe_3d",
            &[(0x7e, 0x10), (0x7f, 0xf2), (0x61, 0x08)],
            0,
            false,
        ),
        (
            "tic_tac_toe_3d",
            &[(0x7e, 0x11), (0x7f, 0xf3), (0x61, 0x08)],
            0,
            false,
        ),
        ("video_chess", &[(0x61, 0x82), (0x6e, 0x00)], 1, true),
        ("video_chess", &[(0x61, 0x82), (0x6e, 0x01)], -1, true),
        ("video_chess", &[(0x61, 0x82), (0x6e, 0x02)], 0, false),
        ("video_chess", &[(0x61, 0x83)], 0, false),
        (
            "demon_attack",
            &[(0x01, 0xab), (0x03, 0xcd), (0x05, 0xea)],
            0,
            false,
        ),
        (
            "demon_attack",
            &[(0x01, 0x01), (0x03, 0x23), (0x05, 0x45)],
            12_345,
            false,
        ),
        (
            "double_dunk",
            &[(0x76, 0x24), (0x77, 0x10), (0x7e, 0xe7)],
            14,
            true,
        ),
        (
            "double_dunk",
            &[(0x76, 0x09), (0x77, 0x24), (0x7e, 0xe7)],
            -15,
            true,
        ),
        (
            "double_dunk",
            &[(0x76, 0x23), (0x77, 0x10), (0x7e, 0xe7)],
            13,
            false,
        ),
        (
            "double_dunk",
            &[(0x76, 0x24), (0x77, 0x10), (0x7e, 0xe6)],
            14,
            false,
        ),
    ];
    for (name, bytes, score, over) in cases {
        let (game, ram) = (games::by_name(name).unwrap(), ram(bytes));
        let found = ((game.score)(&Ram(&ram)), (game.over)(&Ram(&ram)));
        assert_eq!(found, (score, over), "{name} {bytes:x?}");
    }
}
