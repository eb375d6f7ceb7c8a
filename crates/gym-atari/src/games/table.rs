//! The games, sorted by name.
//!
//! `r` is the RAM by index: `$80` of the processor is index `0x00`.

use super::{Controller, DEFAULT, GAME_WON, Game, Menu, Rewards};
use crate::action::Action;
use crate::action::Action::*;
use crate::cartridge::Scheme::*;
use crate::env::ids::ids;
use crate::tia::Display;

/// Casino's start: 60 frames without action, then two with the button.
const CASINO_START: [Action; 62] = {
    let mut start = [Noop; 62];
    start[60] = Fire;
    start[61] = Fire;
    start
};

/// Defines the games and their ids: name, title, and the frame skip of the `Deterministic` ids, or
/// `v5` if ale-py has no older ids.
macro_rules! games {
    ($($name:ident $title:literal $family:tt { $($field:ident: $value:expr,)* })*) => {
        /// The games that are exactly as in ale-py.
        pub static GAMES: &[Game] = &[$(
            Game { name: stringify!($name), title: $title, $($field: $value,)* ..DEFAULT },
        )*];
        $(ids!(stringify!($name), $title, $family);)*
    };
}

games! {
    adventure "Adventure" 4 {
        md5: "4b27f5397c442d25f0c418ccdacf1926", scheme: Rom4K,
        display: Display::PAL,
        select_random: true,
        mode_at: Some(0x5d), modes: &[(0, 0), (1, 2), (2, 4)],
        difficulties: &[0, 1, 2, 3],
        score: |r| i32::from(r.at(0x39) == 0x12),
        lives: |_| 1,
        lives_at_end: 1,
        over: |r| r.at(0x39) == 0x12 || r.at(0x60) == 2,
    }
    air_raid "AirRaid" 4 {
        md5: "35be55426c1fec32dfb503b4f0651572", scheme: Rom4K,
        minimal: &[Noop, Fire, Right, Left, RightFire, LeftFire],
        display: Display::PAL,
        start: &[Fire],
        select_frames: 10,
        press_first: true,
        mode_at: Some(0x2a),
        modes: &[(1, 1), (2, 2), (3, 3), (4, 4), (5, 5), (6, 6), (7, 7), (8, 8)],
        score: |r| r.decimal(&[0x28, 0x29, 0x2a]),
        lives: |_| 1,
        over: |r| r.at(0x27) == 0xff,
    }
    alien "Alien" 4 {
        md5: "f1a0a23e6464d954e3a9579c4ccd01c8", scheme: Rom4K,
        minimal: &Action::ALL,
        select_frames: 1,
        mode_at: Some(0x01), modes: &[(0, 0), (1, 1), (2, 2), (3, 3)],
        difficulties: &[0, 1, 2, 3],
        score: |r| 10 * r.pictures(&[0x03, 0x05, 0x07, 0x09, 0x0b], 0x80),
        lives: |r| r.low(0x40),
        over: |r| r.low(0x40) == 0,
    }
    amidar "Amidar" 4 {
        md5: "acb7750b4d0c4bd34969802a7deb2990", scheme: Rom4K,
        minimal: &[Noop, Fire, Up, Right, Left, Down, UpFire, RightFire, LeftFire, DownFire],
        difficulties: &[0, 3],
        score: |r| r.decimal(&[0x5b, 0x5a, 0x59]),
        lives: |r| r.low(0x56),
        over: |r| r.at(0x56) == 0x80,
    }
    assault "Assault" 4 {
        md5: "de78b3a064d374390ac0710f95edde92", scheme: Rom4K,
        minimal: &[Noop, Fire, Up, Right, Left, RightFire, LeftFire],
        score: |r| r.decimal(&[0x00, 0x01, 0x02]),
        lives: |r| r.at(0x65),
        over: |r| r.at(0x65) == 0,
    }
    asterix "Asterix" 4 {
        md5: "89a68746eff7f266bbf08de2483abe55", scheme: F8,
        minimal: &[Noop, Up, Right, Left, Down, UpRight, UpLeft, DownRight, DownLeft],
        start: &[Fire],
        score: |r| r.decimal(&[0x5e, 0x5f, 0x60]),
        lives: |r| r.low(0x53),
        over: |r| r.at(0x53) == 1 && r.at(0x47) == 1,
    }
    asteroids "Asteroids" 4 {
        md5: "ccbd36746ed4525821a8083b0d6d2c2c", scheme: F8,
        minimal: &[
            Noop, Fire, Up, Right, Left, Down, UpRight, UpLeft, UpFire, RightFire, LeftFire,
            DownFire, UpRightFire, UpLeftFire,
        ],
        display: Display { comb: false, ..Display::NTSC },
        rewards: Rewards::Wrap(100_000),
        mode_at: Some(0x00),
        modes: &[
            (0, 0), (1, 1), (2, 2), (3, 3), (4, 4), (5, 5), (6, 6), (7, 7), (8, 8), (9, 9),
            (10, 10), (11, 11), (12, 12), (13, 13), (14, 14), (15, 15), (16, 16), (17, 17),
            (18, 18), (19, 19), (20, 20), (21, 21), (22, 22), (23, 23), (24, 24), (25, 25),
            (26, 26), (27, 27), (28, 28), (29, 29), (30, 30), (31, 31), (128, 128),
        ],
        difficulties: &[0, 3],
        score: |r| 10 * r.decimal(&[0x3d, 0x3e]),
        lives: |r| r.high(0x3c),
        over: |r| r.high(0x3c) == 0,
    }
    atlantis "Atlantis" 4 {
        md5: "9ad36e699ef6f45d9eb6c4cf90475c9f", scheme: Rom4K,
        minimal: &[Noop, Fire, RightFire, LeftFire],
        mode_at: Some(0x0d), modes: &[(0, 0), (1, 1), (2, 2), (3, 3)],
        score: |r| 100 * r.decimal(&[0x21, 0x23, 0x22]),
        lives: |r| r.at(0x71),
        over: |r| r.at(0x71) == 0xff,
    }
    atlantis2 "Atlantis2" v5 {
        md5: "826481f6fc53ea47c9f272f7050eedf7", scheme: Rom4K,
        minimal: &[Noop, Fire, RightFire, LeftFire],
        score: |r| r.decimal(&[0x23, 0x22, 0x21]),
        lives: |r| r.at(0x71),
        over: |r| r.at(0x71) == 0xff,
    }
    bank_heist "BankHeist" 4 {
        md5: "00ce0bdd43aed84a983bef38fe7f5ee3", scheme: Rom4K,
        minimal: &Action::ALL,
        select_frames: 1,
        mode_at: Some(0x00),
        modes: &[(0, 0), (4, 4), (8, 8), (12, 12), (16, 16), (20, 20), (24, 24), (28, 28)],
        difficulties: &[0, 1, 2, 3],
        score: |r| r.decimal(&[0x58, 0x59, 0x5a]),
        lives: |r| r.at(0x55),
        over: |r| r.at(0x55) == 0 && r.at(0x4e) == 1,
    }
    basic_math "BasicMath" v5 {
        md5: "819aeeb9a2e11deb54e6de334f843894", scheme: Rom2K,
        minimal: &[Noop, Fire, Up, Right, Left, Down],
        mode_at: Some(0x45), modes: &[(5, 5), (6, 6), (7, 7), (8, 8)],
        difficulties: &[0, 2, 3],
        score: |r| r.bcd(0x04),
        lives: |_| 1,
        over: |r| r.at(0x06) != 0,
    }
    battle_zone "BattleZone" 4 {
        md5: "41f252a66c6301f1e8ab3612c19bc5d4", scheme: F8,
        minimal: &Action::ALL,
        display: Display { comb: false, ..Display::NTSC },
        mode_at: Some(0x21), modes: &[(1, 1), (2, 2), (3, 3)],
        score: |r| {
            1000 * r.ten_high(0x1d) + 10_000 * r.ten_digits(&[0x1e]) + 100_000 * r.ten_high(0x1e)
        },
        lives: |r| r.low(0x3a),
        over: |r| r.low(0x3a) == 0,
    }
    beam_rider "BeamRider" 4 {
        md5: "79ab4123a83dc11d468fb2108ea09e2e", scheme: F8,
        minimal: &[Noop, Fire, Up, Right, Left, UpRight, UpLeft, RightFire, LeftFire],
        start: &[Right], difficulties: &[0, 1],
        score: |r| r.decimal(&[0x0b, 0x0a, 0x09]),
        lives: |r| r.at(0x05) + 1,
        lives_count: |r| r.at(0x0c) == 1,
        over: |r| r.at(0x05) == 0xff,
    }
    berzerk "Berzerk" 4 {
        md5: "136f75c4dd02c29283752b7e5799f978", scheme: Rom4K,
        minimal: &Action::ALL,
        idle: 20,
        mode_at: Some(0x00),
        modes: &[
            (1, 1), (2, 2), (3, 3), (4, 4), (5, 5), (6, 6), (7, 7), (8, 8), (9, 9), (16, 16),
            (17, 17), (18, 18),
        ],
        score: |r| r.decimal(&[0x5d, 0x5e, 0x5f]),
        lives: |r| r.at(0x5a) + 1,
        over: |r| r.at(0x5a) == 0xff,
    }
    blackjack "Blackjack" v5 {
        md5: "0a981c03204ac2b278ba392674682560", scheme: Rom2K,
        minimal: &[Noop, Fire, Up, Down],
        controller: Controller::LeftPaddle(0), paddle_end: 795_000,
        difficulties: &[0, 1, 2, 3],
        score: |r| r.blackjack(),
        lives: |_| 1,
        over: |r| r.blackjack_is_over(),
    }
    bowling "Bowling" 4 {
        md5: "c9b7afad3bfd922e006a6bfc1d4f3fe7", scheme: Rom2K,
        minimal: &[Noop, Fire, Up, Down, UpFire, DownFire],
        mode_at: Some(0x02), modes: &[(0, 0), (2, 2), (4, 4)], difficulties: &[0, 1],
        score: |r| r.decimal(&[0x26, 0x21]),
        over: |r| r.at(0x24) > 0x10,
    }
    boxing "Boxing" 4 {
        md5: "c3ef5c4653212088eda54dc91d787870", scheme: Rom2K,
        minimal: &Action::ALL,
        difficulties: &[0, 1, 2, 3],
        score: |r| r.boxing(0x12) - r.boxing(0x13),
        over: |r| r.at(0x12) == 0xc0 || r.at(0x13) == 0xc0 || r.at(0x15) == 0x0c,
    }
    breakout "Breakout" 4 {
        md5: "f34f08e5eb96e500e851a80be3277a56", scheme: Rom2K,
        minimal: &[Noop, Fire, Right, Left],
        controller: Controller::Paddle(0),
        select_frames: 1,
        mode_at: Some(0x32),
        modes: &[
            (0, 0), (4, 4), (8, 8), (12, 12), (16, 16), (20, 20), (24, 24), (28, 28), (32, 32),
            (36, 36), (40, 40), (44, 44),
        ],
        difficulties: &[0, 1],
        score: |r| r.bcd(0x4d) + 100 * r.low(0x4c),
        lives: |r| r.at(0x39),
        over: |r| r.at(0x39) == 0,
    }
    carnival "Carnival" 4 {
        md5: "028024fb8e5e5f18ea586652f9799c96", scheme: Rom4K,
        minimal: &[Noop, Fire, Right, Left, RightFire, LeftFire],
        display: Display { first_line: 26, rows: 214, ..Display::NTSC },
        score: |r| 10 * r.decimal(&[0x2d, 0x2e]),
        over: |r| r.at(0x03) == 0,
    }
    casino "Casino" v5 {
        md5: "b816296311019ab69a21cb9e9e235d12", scheme: Rom4K,
        minimal: &[Noop, Fire, Up, Down],
        controller: Controller::LeftPaddle(0),
        start: &CASINO_START,
        mode_at: Some(0x54), modes: &[(0, 0), (2, 2), (3, 3)],
        difficulties: &[0, 1, 2, 3],
        score: |r| r.decimal(&[0x0c, 0x15]),
        rewards_count: |r| r.at(0x53) & 0x80 == 0,
        lives: |_| 1,
        over: |r| r.casino_is_over(),
    }
    centipede "Centipede" 4 {
        md5: "91c2098e88a6b13f977af8c003e0bca5", scheme: F8,
        minimal: &Action::ALL,
        rewards: Rewards::NeverNegative, mode_at: Some(0x27), modes: &[(22, 22), (86, 86)],
        score: |r| r.decimal(&[0x74, 0x75, 0x76]),
        lives: |r| (r.high(0x6d) & 7) + 1,
        over: |r| r.at(0x26) & 0x40 != 0,
    }
    chopper_command "ChopperCommand" 4 {
        md5: "c1cb228470a87beb5f36e90ac745da26", scheme: Rom4K,
        minimal: &Action::ALL,
        mode_at: Some(0x60), modes: &[(0, 0), (2, 2)], difficulties: &[0, 1],
        score: |r| 100 * r.decimal(&[0x6c, 0x6e]),
        lives: |r| r.low(0x64),
        over: |r| r.low(0x64) == 0,
    }
    crazy_climber "CrazyClimber" 4 {
        md5: "55ef7b65066428367844342ed59f956c", scheme: F8,
        minimal: &[Noop, Up, Right, Left, Down, UpRight, UpLeft, DownRight, DownLeft],
        mode_at: Some(0x00), modes: &[(0, 0), (1, 1), (2, 2), (3, 3)], difficulties: &[0, 1],
        score: |r| {
            100 * r.bcd(0x02) + 1000 * r.low(0x03) + 10_000 * r.bcd(0x04) + 100_000 * r.low(0x05)
        },
        lives: |r| r.at(0x2a),
        over: |r| r.at(0x2a) == 0,
    }
    crossbow "Crossbow" v5 {
        md5: "8cd26dcf249456fe4aeb8db42d49df74", scheme: F6,
        mode_at: Some(0x0d), modes: &[(0, 1), (2, 3), (4, 5), (6, 7)],
        difficulties: &[0, 1],
        score: |r| r.decimal(&[0x0b, 0x0c, 0x0d]),
        lives: |_| 1,
        over: |r| r.at(0x67) == 0x82,
    }
    defender "Defender" 4 {
        md5: "0f643c34e40e3f1daafd9c524d3ffe64", scheme: Rom4K,
        minimal: &Action::ALL,
        mode_at: Some(0x1b),
        modes: &[(1, 1), (2, 2), (3, 3), (4, 4), (5, 5), (6, 6), (7, 7), (8, 8), (9, 9), (16, 16)],
        difficulties: &[0, 1],
        score: |r| r.ten_digits(&[0x21, 0x20, 0x1f, 0x1e, 0x1d, 0x1c]),
        lives: |r| r.at(0x42),
        over: |r| r.at(0x42) == 0,
    }
    demon_attack "DemonAttack" 4 {
        md5: "f0e0addc07971561ab80d9abe1b8d333", scheme: Rom4K,
        minimal: &[Noop, Fire, Right, Left, RightFire, LeftFire],
        select_frames: 1,
        mode_at: Some(0x6a),
        modes: &[(1, 1), (3, 3), (5, 5), (7, 7)],
        difficulties: &[0, 1],
        score: |r| r.demon_attack(),
        lives: |r| r.at(0x72) + 1,
        over: |r| r.at(0x72) == 0 && r.at(0x71) == 0xbd,
    }
    donkey_kong "DonkeyKong" v5 {
        md5: "36b20c427975760cb9cf4a47e41369e4", scheme: Rom4K,
        minimal: &Action::ALL,
        score: |r| 100 * r.decimal(&[0x07, 0x08]),
        lives: |r| r.at(0x23),
        over: |r| r.at(0x23) == 0 && r.at(0x0f) == 0x03 && r.at(0x0b) == 0x1f,
    }
    double_dunk "DoubleDunk" 4 {
        md5: "368d88a6c071caba60b4f778615aae94", scheme: F6,
        start: &[UpFire],
        menu: Some(Menu {
            line: 0x30, set: 0x00, options: &[(2, 0x08), (3, 0x10), (4, 0x04), (5, 0x20)],
        }),
        modes: &[
            (0, 0), (1, 1), (2, 2), (3, 3), (4, 4), (5, 5), (6, 6), (7, 7), (8, 8), (9, 9),
            (10, 10), (11, 11), (12, 12), (13, 13), (14, 14), (15, 15),
        ],
        score: |r| r.bcd(0x76) - r.bcd(0x77),
        over: |r| r.double_dunk_is_over(),
    }
    earthworld "Earthworld" v5 {
        md5: "5aea9974b975a6a844e6df10d2b861c4", scheme: F8,
        score: |r| r.bcd(0x27),
        lives: |_| 1,
        over: |r| r.bcd(0x27) == 10,
    }
    enduro "Enduro" 4 {
        md5: "94b92a882f6dbaa6993a46e2dcc58402", scheme: Rom4K,
        minimal: &[Noop, Fire, Right, Left, Down, DownRight, DownLeft, RightFire, LeftFire],
        start: &[Fire],
        score: |r| r.enduro(),
        over: |r| r.at(0x2f) == 0xff,
    }
    entombed "Entombed" v5 {
        md5: "6b683be69f92958abe0e2a9945157ad5", scheme: Rom4K,
        minimal: &Action::ALL,
        start: &[Fire, Noop, Noop, Noop, Noop, Noop],
        difficulties: &[0, 2],
        score: |r| r.at(0x63),
        lives: |_| 1,
        over: |r| r.at(0x47) & 3 == 0,
    }
    et "Et" v5 {
        md5: "615a3bf251a38eb6638cdc7ffbde5480", scheme: F8,
        select_frames: 25,
        mode_at: Some(0x6a), modes: &[(0, 1), (1, 2), (2, 3)],
        difficulties: &[0, 1, 2, 3],
        score: |r| r.decimal(&[0x5f, 0x60, 0x61]),
        lives: |r| i32::from((r.at(0x65) + 1) as i8),
        over: |r| r.at(0x65) == 0xff && r.at(0x00) == 0x08,
    }
    fishing_derby "FishingDerby" 4 {
        md5: "b8865f05676e64f3bec72b9defdacfa7", scheme: Rom2K,
        minimal: &Action::ALL,
        difficulties: &[0, 1, 2, 3],
        score: |r| r.bcd(0x3d) - r.bcd(0x3e),
        over: |r| r.at(0x3d) == 0x99 || r.at(0x3e) == 0x99,
    }
    flag_capture "FlagCapture" v5 {
        md5: "30512e0e83903fc05541d2f6a6a62654", scheme: Rom2K,
        minimal: &Action::ALL,
        mode_at: Some(0x56), modes: &[(8, 8), (9, 9), (10, 10)],
        score: |r| r.bcd(0x6a),
        lives: |_| 1,
        over: |r| r.at(0x6b) == 0,
    }
    freeway "Freeway" 4 {
        md5: "8e0ab801b1705a740b476b7f588c6d16", scheme: Rom2K,
        minimal: &[Noop, Up, Down],
        select_frames: 1,
        mode_at: Some(0x00),
        modes: &[(0, 0), (1, 1), (2, 2), (3, 3), (4, 4), (5, 5), (6, 6), (7, 7)],
        difficulties: &[0, 1],
        score: |r| r.bcd(0x67),
        over: |r| r.at(0x16) == 1,
    }
    frogger "Frogger" v5 {
        md5: "081e2c114c9c20b61acf25fc95c71bf4", scheme: Rom4K,
        minimal: &[Noop, Up, Right, Left, Down],
        mode_at: Some(0x5d), modes: &[(0, 1), (1, 3), (2, 5)], difficulties: &[0, 1],
        score: |r| r.decimal(&[0x4c, 0x4e]),
        lives: |r| r.at(0x50),
        over: |r| r.at(0x50) == 0xff,
    }
    frostbite "Frostbite" 4 {
        md5: "4ca73eb959299471788f0b685c3ba0b5", scheme: Rom4K,
        minimal: &Action::ALL,
        select_frames: 1, mode_at: Some(0x00), modes: &[(0, 0), (2, 2)],
        score: |r| r.decimal(&[0x48, 0x49, 0x4a]),
        lives: |r| r.low(0x4c) + 1,
        over: |r| r.low(0x4c) == 0 && r.at(0x71) == 0x80,
    }
    galaxian "Galaxian" v5 {
        md5: "211774f4c5739042618be8ff67351177", scheme: F8,
        minimal: &[Noop, Fire, Right, Left, RightFire, LeftFire],
        rewards: Rewards::Wrap(1_000_000),
        select_frames: 1,
        mode_at: Some(0x33),
        modes: &[(1, 1), (2, 2), (3, 3), (4, 4), (5, 5), (6, 6), (7, 7), (8, 8), (9, 9)],
        difficulties: &[0, 1],
        score: |r| r.decimal(&[0x2c, 0x2d, 0x2e]),
        lives: |r| r.at(0x39) + 1,
        over: |r| r.at(0x3f) & 0x80 != 0,
    }
    gopher "Gopher" 4 {
        md5: "c16c79aad6272baffb8aae9a7fff0864", scheme: Rom4K,
        minimal: &[Noop, Fire, Up, Right, Left, UpFire, RightFire, LeftFire],
        first_reset: 8, start: &[Fire],
        select_frames: 5,
        mode_at: Some(0x53), modes: &[(0, 0), (2, 2)],
        difficulties: &[0, 1],
        score: |r| r.decimal(&[0x30, 0x31, 0x32]),
        lives: |r| (r.at(0x34) & 7).count_ones() as i32,
        over: |r| r.at(0x34) & 7 == 0,
    }
    gravitar "Gravitar" 4 {
        md5: "8ac18076d01a6b63acf6e2cab4968940", scheme: F8,
        minimal: &Action::ALL,
        start: &[Fire; 16],
        select_frames: 10,
        mode_at: Some(0x00), modes: &[(0, 0), (1, 1), (2, 2), (3, 3), (4, 4)],
        score: |r| r.decimal(&[0x07, 0x08, 0x09]),
        lives: |r| r.at(0x04) + 1,
        over: |r| r.at(0x01) == 1,
    }
    hangman "Hangman" v5 {
        md5: "f16c709df0a6c52f47ff52b9d95b7d8d", scheme: Rom4K,
        minimal: &Action::ALL,
        mode_at: Some(0x6e), modes: &[(0, 0), (1, 1), (2, 2), (3, 3)],
        difficulties: &[0, 1],
        score: |r| r.bcd(0x6b) - r.bcd(0x6c),
        lives: |_| 1,
        over: |r| r.at(0x6b) != 0 || r.at(0x6c) != 0,
    }
    haunted_house "HauntedHouse" v5 {
        md5: "f0a6e99f5875891246c3dbecbf2d2cea", scheme: Rom4K,
        rewards: Rewards::Changes,
        mode_at: Some(0x4c),
        modes: &[(0, 0), (1, 1), (2, 2), (3, 3), (4, 4), (5, 5), (6, 6), (7, 7), (8, 8)],
        difficulties: &[0, 1],
        score: |r| r.bcd(0x02) + if r.at(0x19) == 0x44 { GAME_WON } else { 0 },
        lives: |r| r.at(0x16),
        over: |r| r.at(0x16) == 0 || r.at(0x19) == 0x44,
    }
    hero "Hero" 4 {
        md5: "fca4a5be1251927027f2c24774a02160", scheme: F8,
        minimal: &Action::ALL,
        select_frames: 1, mode_at: Some(0x00), modes: &[(0, 0), (1, 1), (2, 2), (3, 3), (4, 4)],
        score: |r| r.decimal(&[0x37, 0x38, 0x39]),
        lives: |r| r.at(0x33),
        over: |r| r.at(0x33) == 0,
    }
    human_cannonball "HumanCannonball" v5 {
        md5: "7972e5101fa548b952d852db24ad6060", scheme: Rom2K,
        mode_at: Some(0x36),
        modes: &[(0, 1), (1, 2), (2, 3), (3, 4), (4, 5), (5, 6), (6, 7), (7, 8)],
        mode_also: |r, _| r.at(0x37) == 1,
        difficulties: &[0, 1],
        score: |r| r.bcd(0x36),
        lives: |_| 1,
        over: |r| r.at(0x36) == 7 || r.at(0x37) == 7,
    }
    ice_hockey "IceHockey" 4 {
        md5: "a4c08c4994eb9d24fb78be1793e82e26", scheme: Rom4K,
        minimal: &Action::ALL,
        mode_at: Some(0x00), modes: &[(0, 0), (2, 2)], difficulties: &[0, 1, 2, 3],
        score: |r| r.bcd(0x0a) - r.bcd(0x0b),
        over: |r| r.at(0x06) | r.at(0x07) == 0,
    }
    jamesbond "Jamesbond" 4 {
        md5: "e51030251e440cffaab1ac63438b44ae", scheme: E0,
        minimal: &Action::ALL,
        select_frames: 20, mode_at: Some(0x0c), mode_bits: 0x48, modes: &[(0, 0), (1, 1)],
        score: |r| r.decimal(&[0x5e, 0x5d, 0x5c]),
        lives: |r| r.low(0x06) + 1,
        over: |r| r.at(0x0c) == 0x68 && r.low(0x06) == 0,
    }
    kaboom "Kaboom" v5 {
        md5: "5428cdfada281c569c74c7308c7f2c26", scheme: Rom2K,
        minimal: &[Noop, Fire, Right, Left],
        start: &[Fire], controller: Controller::Paddle(0),
        score: |r| r.decimal(&[0x24, 0x25]),
        lives: |_| 1,
        over: |r| r.at(0x21) == 0,
    }
    kangaroo "Kangaroo" 4 {
        md5: "4326edb70ff20d0ee5ba58fa5cb09d60", scheme: F8,
        minimal: &Action::ALL,
        mode_at: Some(0x3a), mode_bits: 0x80, modes: &[(0, 0), (1, 1)],
        score: |r| 100 * r.decimal(&[0x27, 0x28]),
        lives: |r| (r.at(0x2d) & 7) + 1,
        over: |r| r.at(0x2d) == 0xff,
    }
    keystone_kapers "KeystoneKapers" v5 {
        md5: "6c1f3f2e359dbf55df462ccbcdd2f6bf", scheme: Rom4K,
        minimal: &[
            Noop, Fire, Up, Right, Left, Down, UpRight, UpLeft, DownRight, DownLeft, UpFire,
            RightFire, LeftFire, DownFire,
        ],
        first_reset: 5, display: Display::PAL,
        score: |r| r.decimal(&[0x1b, 0x1c]),
        lives: |r| r.at(0x16),
        over: |r| r.at(0x16) | r.at(0x08) == 0,
    }
    king_kong "KingKong" v5 {
        md5: "0dd4c69b5f9a7ae96a7a08329496779a", scheme: Rom4K,
        minimal: &[Noop, Fire, Up, Right, Left, Down],
        display: Display::PAL,
        mode_at: Some(0x6c), modes: &[(0, 0), (1, 2), (2, 4), (3, 6)],
        score: |r| r.decimal(&[0x02, 0x03]),
        lives: |r| r.at(0x6e),
        over: |r| r.at(0x6e) == 0,
    }
    koolaid "Koolaid" v5 {
        md5: "534e23210dd1993c828d944c6ac4d9fb", scheme: Rom4K,
        minimal: &[Noop, Up, Right, Left, Down, UpRight, UpLeft, DownRight, DownLeft],
        score: |r| 100 * r.decimal(&[0x00, 0x01]),
        over: |r| r.at(0x51) == 0x80,
    }
    krull "Krull" 4 {
        md5: "4baada22435320d185c95b7dd2bcdb24", scheme: F8,
        minimal: &Action::ALL,
        score: |r| r.decimal(&[0x1c, 0x1d, 0x1e]),
        lives: |r| (r.at(0x1f) & 7) + 1,
        over: |r| r.at(0x00) == 0x80 && r.at(0x1f) & 7 == 0 && r.at(0x22) == 0x03,
    }
    kung_fu_master "KungFuMaster" 4 {
        md5: "5b92a93b23523ff16e2789b820e2a4c5", scheme: F8,
        minimal: &[
            Noop, Up, Right, Left, Down, DownRight, DownLeft, RightFire, LeftFire, DownFire,
            UpRightFire, UpLeftFire, DownRightFire, DownLeftFire,
        ],
        score: |r| r.decimal(&[0x18, 0x19, 0x1a]),
        lives: |r| (r.at(0x1d) & 7) + 1,
        over: |r| r.at(0x1d) == 0xff,
    }
    laser_gates "LaserGates" v5 {
        md5: "8e4cd60d93fcde8065c1a2b972a26377", scheme: Rom4K,
        first_reset: 5, display: Display::PAL,
        score: |r| r.decimal(&[0x00, 0x01, 0x02]),
        over: |r| r.at(0x03) == 0,
    }
    lost_luggage "LostLuggage" v5 {
        md5: "2d76c5d1aad506442b9e9fb67765e051", scheme: Rom4K,
        minimal: &[Noop, Up, Right, Left, Down, UpRight, UpLeft, DownRight, DownLeft],
        legal: &[Noop, Up, Right, Left, Down, UpRight, UpLeft, DownRight, DownLeft],
        start: &[Fire],
        mode_at: Some(0x14), modes: &[(0, 1), (1, 4)],
        difficulties: &[0, 1],
        score: |r| r.decimal(&[0x14, 0x15, 0x16]),
        lives: |r| r.at(0x4a),
        over: |r| r.at(0x48) == 0x0a && r.at(0x4a) | r.at(0x25) | r.at(0x29) == 0,
    }
    mario_bros "MarioBros" v5 {
        md5: "e908611d99890733be31733a979c62d8", scheme: F8,
        start: &[
            Noop, Noop, Noop, Noop, Noop, Noop, Noop, Noop, Noop, Noop, Fire, Fire, Fire, Fire,
            Fire, Fire, Fire,
        ],
        select_frames: 5, mode_at: Some(0x00), modes: &[(0, 0), (2, 2), (4, 4), (6, 6)],
        score: |r| 100 * r.decimal(&[0x09, 0x0a]),
        lives: |r| r.at(0x07),
        over: |r| r.at(0x07) == 0,
    }
    montezuma_revenge "MontezumaRevenge" 4 {
        md5: "3347a6dd59049b15a38394aa2dafa585", scheme: E0,
        minimal: &Action::ALL,
        score: |r| r.decimal(&[0x13, 0x14, 0x15]),
        lives: |r| (r.at(0x3a) & 7) + 1,
        over: |r| r.at(0x3a) == 0 && r.at(0x7e) == 0x60,
    }
    mr_do "MrDo" v5 {
        md5: "aa7bb54d2c189a31bb1fa20099e42859", scheme: F8,
        minimal: &[Noop, Fire, Up, Right, Left, Down, UpFire, RightFire, LeftFire, DownFire],
        display: Display::PAL,
        start: &[Fire],
        select_frames: 5, mode_at: Some(0x00), modes: &[(0, 0), (1, 1), (2, 2), (3, 3)],
        score: |r| 10 * r.decimal(&[0x03, 0x02]),
        lives: |r| r.at(0x5b),
        over: |r| r.at(0x5a) == 0x40,
    }
    ms_pacman "MsPacman" 4 {
        md5: "87e79cd41ce136fd4f72cc6e2c161bee", scheme: F8,
        minimal: &[Noop, Up, Right, Left, Down, UpRight, UpLeft, DownRight, DownLeft],
        display: Display { comb: false, ..Display::NTSC },
        select_frames: 10, mode_at: Some(0x19), modes: &[(0, 1), (1, 1), (2, 2), (3, 3)],
        mode_also: |r, mode| r.at(0x00) == 0 && (r.at(0x21) != 0) == (mode == 0),
        score: |r| r.decimal(&[0x7a, 0x79, 0x78]),
        lives: |r| (r.at(0x7b) & 7) + 1,
        over: |r| r.low(0x7b) == 0 && r.at(0x27) == 0x53,
    }
    name_this_game "NameThisGame" 4 {
        md5: "36306070f0c90a72461551a7a4f3a209", scheme: Rom4K,
        minimal: &[Noop, Fire, Right, Left, RightFire, LeftFire],
        mode_at: Some(0x5e), modes: &[(8, 8), (24, 24), (40, 40)],
        difficulties: &[0, 1],
        score: |r| r.decimal(&[0x44, 0x45, 0x46]),
        lives: |r| r.at(0x47) & 7,
        over: |r| r.at(0x47) & 7 == 0,
    }
    othello "Othello" v5 {
        md5: "113cd09c9771ac278544b7e90efe7df2", scheme: Rom2K,
        minimal: &[Noop, Fire, Up, Right, Left, Down, UpRight, UpLeft, DownRight, DownLeft],
        mode_at: Some(0x5e), modes: &[(0, 1), (1, 2), (2, 3)],
        difficulties: &[0, 2],
        score: |r| r.bcd(0x4e) - r.bcd(0x50),
        lives: |_| 1,
        over: |r| r.at(0x40) == 0,
        over_frames: 51,
    }
    pacman "Pacman" v5 {
        md5: "fc2233fc116faef0d3c31541717ca2db", scheme: Rom4K,
        minimal: &[Noop, Up, Right, Left, Down],
        display: Display::PAL,
        mode_at: Some(0x4c),
        modes: &[(0, 1), (1, 2), (2, 3), (3, 4), (4, 5), (5, 6), (6, 7), (7, 8)],
        mode_also: |r, _| r.at(0x66) == 0,
        difficulties: &[0, 1],
        score: |r| r.decimal(&[0x50, 0x4e, 0x4c]),
        lives: |r| r.at(0x18) + 1,
        over: |r| r.at(0x18) == 0 && r.at(0x64) == 0x3f,
    }
    phoenix "Phoenix" 4 {
        md5: "7e52a95074a66640fcfde124fffd491a", scheme: F8,
        minimal: &[Noop, Fire, Right, Left, Down, RightFire, LeftFire, DownFire],
        score: |r| 10_000 * r.bcd(0x49) + 100 * r.bcd(0x48) + 10 * r.high(0x47),
        lives: |r| r.at(0x4b) & 7,
        over: |r| r.at(0x4c) == 0x80,
    }
    pitfall "Pitfall" 4 {
        md5: "3e90cf23106f2e08b2781e41299de556", scheme: Rom4K,
        minimal: &Action::ALL,
        start: &[Up],
        score: |r| r.decimal(&[0x55, 0x56, 0x57]),
        lives: |r| match r.high(0x00) { 0xa => 3, 0x8 => 2, _ => 1 },
        over: |r| r.high(0x00) == 0 && r.at(0x1e) != 0,
    }
    pong "Pong" 4 {
        md5: "60e0ea3cbe0913d39803477945e9e5ec", scheme: Rom2K,
        minimal: &[Noop, Fire, Right, Left, RightFire, LeftFire],
        controller: Controller::Paddle(1), mode_at: Some(0x16), modes: &[(0, 0), (1, 1)],
        difficulties: &[0, 1, 2, 3],
        score: |r| r.at(0x0e) - r.at(0x0d),
        over: |r| r.at(0x0d) == 21 || r.at(0x0e) == 21,
    }
    pooyan "Pooyan" 4 {
        md5: "4799a40b6e889370b7ee55c17ba65141", scheme: Rom4K,
        minimal: &[Noop, Fire, Up, Down, UpFire, DownFire],
        display: Display { first_line: 26, rows: 220, ..Display::NTSC },
        press_first: true, mode_at: Some(0x3d), modes: &[(10, 10), (30, 30), (50, 50), (70, 70)],
        score: |r| r.decimal(&[0x08, 0x09, 0x0a]),
        lives: |r| (r.at(0x16) & 7) + 1,
        over: |r| r.at(0x16) == 0 && r.at(0x18) == 5,
    }
    private_eye "PrivateEye" 4 {
        md5: "ef3a4f64b6494ba770862768caf04b86", scheme: F8,
        minimal: &Action::ALL,
        start: &[Up], mode_at: Some(0x00), modes: &[(0, 0), (1, 1), (2, 2), (3, 3), (4, 4)],
        difficulties: &[0, 1, 2, 3],
        score: |r| r.decimal(&[0x48, 0x49, 0x4a]),
        over: |r| r.at(0x42) > 1,
    }
    qbert "Qbert" 4 {
        md5: "484b0076816a104875e00467d431c2d2", scheme: Rom4K,
        minimal: &[Noop, Fire, Up, Right, Left, Down],
        display: Display { first_line: 40, ..Display::NTSC }, difficulties: &[0, 1],
        score: |r| r.decimal(&[0x59, 0x5a, 0x5b]),
        lives: |r| if r.at(0x01) == 0 && r.at(0x08) == 0 { 4 } else { r.signed(0x08) + 2 },
        over: |r| r.at(0x08) == 0xfe,
    }
    riverraid "Riverraid" 4 {
        md5: "393948436d1f4cc3192410bb918f9724", scheme: Rom4K,
        minimal: &Action::ALL,
        difficulties: &[0, 1],
        score: |r| r.pictures(&[0x4d, 0x4f, 0x51, 0x53, 0x55, 0x57], 0x58),
        lives: |r| match r.at(0x40) { 0x58 => 4, 0x59 => 1, byte => byte / 8 + 1 },
        over: |r| r.at(0x40) == 0x58 && r.at(0x46) == 0xff,
    }
    road_runner "RoadRunner" 4 {
        md5: "ce5cc62608be2cd3ed8abd844efb8919", scheme: F6,
        minimal: &Action::ALL,
        score: |r| 100 * r.low_digits(&[0x4c, 0x4b, 0x4a, 0x49]),
        lives: |r| (r.at(0x44) & 7) + 1,
        over: |r| r.at(0x44) & 7 == 0 && (r.at(0x39) > 1 || r.at(0x3d) != 0),
    }
    robotank "Robotank" 4 {
        md5: "4f618c2429138e0280969193ed6c107e", scheme: FE,
        minimal: &Action::ALL,
        score: |r| 12 * r.at(0x36) + r.at(0x35),
        lives: |r| r.low(0x28) + 1,
        over: |r| r.at(0x28) == 0 && r.at(0x34) == 0xff,
    }
    seaquest "Seaquest" 4 {
        md5: "240bfbac5163af4df5ae713985386f92", scheme: Rom4K,
        minimal: &Action::ALL,
        difficulties: &[0, 1],
        score: |r| r.decimal(&[0x38, 0x39, 0x3a]),
        lives: |r| r.at(0x3b) + 1,
        over: |r| r.at(0x23) != 0,
    }
    sir_lancelot "SirLancelot" v5 {
        md5: "dd0cbe5351551a538414fb9e37fc56e8", scheme: F8,
        minimal: &[Noop, Fire, Right, Left, RightFire, LeftFire],
        display: Display::PAL, first_reset: 5, start: &[Left],
        score: |r| r.decimal(&[0x1e, 0x1f, 0x20]),
        lives: |r| r.at(0x29),
        over: |r| r.at(0x29) == 0 && r.at(0x27) == 0xa0,
    }
    skiing "Skiing" 4 {
        md5: "b76fbadc8ffb1f83e2ca08b6fb4d6c9f", scheme: Rom2K,
        minimal: &[Noop, Right, Left],
        legal: &[Noop, Up, Right, Left, Down, UpRight, UpLeft, DownRight, DownLeft],
        start: &[Down; 16],
        score: |r| -(6000 * r.at(0x68) + 100 * r.bcd(0x69) + r.bcd(0x6a)),
        over: |r| r.at(0x11) == 0xff,
    }
    solaris "Solaris" 4 {
        md5: "e72eb8d4410152bdcb69e7fba327b420", scheme: F6,
        minimal: &Action::ALL,
        score: |r| 10 * r.decimal(&[0x5e, 0x5d, 0x5c]),
        lives: |r| r.low(0x59),
        over: |r| r.at(0x59) == 0,
    }
    space_invaders "SpaceInvaders" 3 {
        md5: "72ffbef6504b75e69ee1045af9075f66", scheme: Rom4K,
        minimal: &[Noop, Fire, Right, Left, RightFire, LeftFire],
        mode_at: Some(0x5c),
        modes: &[
            (0, 0), (1, 1), (2, 2), (3, 3), (4, 4), (5, 5), (6, 6), (7, 7), (8, 8), (9, 9),
            (10, 10), (11, 11), (12, 12), (13, 13), (14, 14), (15, 15),
        ],
        difficulties: &[0, 1],
        score: |r| r.bcd(0x68) + 100 * r.bcd(0x66),
        lives: |r| r.at(0x49),
        over: |r| r.at(0x49) == 0 || r.at(0x18) & 0x80 != 0,
    }
    space_war "SpaceWar" v5 {
        md5: "b702641d698c60bcdc922dbd8c9dd49c", scheme: Rom2K,
        display: Display::PAL,
        mode_at: Some(0x27),
        modes: &[
            (6, 0x06), (7, 0x07), (8, 0x08), (9, 0x09), (10, 0x10), (11, 0x11), (12, 0x12),
            (13, 0x13), (14, 0x14), (15, 0x15), (16, 0x16), (17, 0x17),
        ],
        score: |r| r.bcd(0x27),
        lives: |_| 1,
        over: |r| r.bcd(0x27) == 10 || r.at(0x00) == 0,
    }
    star_gunner "StarGunner" 4 {
        md5: "a3c1c70024d7aabb41381adbfb6d3b25", scheme: Rom4K,
        minimal: &Action::ALL,
        select_frames: 15,
        mode_at: Some(0x74), modes: &[(0, 0), (1, 1), (2, 2), (3, 3)],
        score: |r| 100 * r.ten_digits(&[0x06, 0x05, 0x04, 0x03]),
        lives: |r| r.low(0x07).min(5),
        over: |r| r.at(0x07) == 0,
    }
    superman "Superman" v5 {
        md5: "a9531c763077464307086ec9a1fd057d", scheme: Rom4K,
        difficulties: &[0, 1, 2, 3],
        score: |r| r.superman(),
        lives: |_| 1,
        over: |r| r.superman_is_over(),
    }
    surround "Surround" v5 {
        md5: "4d7517ae69f95cfbc053be01312b7dba", scheme: Rom2K,
        minimal: &[Noop, Up, Right, Left, Down],
        controller: Controller::RightJoystick,
        mode_at: Some(0x79), modes: &[(0, 1), (2, 3)],
        difficulties: &[0, 1, 2, 3],
        score: |r| r.bcd(0x77) - r.bcd(0x76),
        lives: |_| 1,
        over: |r| r.bcd(0x76) == 10 || r.bcd(0x77) == 10,
    }
    tennis "Tennis" 4 {
        md5: "42cdd6a9e42a3639e190722b8ea3fc51", scheme: Rom2K,
        minimal: &Action::ALL,
        rewards: Rewards::Games,
        mode_at: Some(0x00), modes: &[(0, 0), (2, 2)],
        difficulties: &[0, 1, 2, 3],
        score: |r| GAME_WON * (r.at(0x47) - r.at(0x48)) + r.at(0x45) - r.at(0x46),
        over: |r| {
            (r.at(0x47) >= 6 && r.at(0x47) - r.at(0x48) >= 2)
                || (r.at(0x48) >= 6 && r.at(0x48) - r.at(0x47) >= 2)
                || r.at(0x47) == 7
                || r.at(0x48) == 7
        },
    }
    tetris "Tetris" v5 {
        md5: "b0e1ee07fbc73493eac5651a52f90f00", scheme: Rom2K,
        minimal: &[Noop, Fire, Right, Left, Down],
        score: |r| r.decimal(&[0x72, 0x71]),
        over: |r| r.at(0x73) & 0x80 != 0,
    }
    tic_tac_toe_3d "TicTacToe3D" v5 {
        md5: "0db4f4150fecf77e4ce72ca4d04c052f", scheme: Rom2K,
        minimal: &[Noop, Fire, Up, Right, Left, Down, UpRight, UpLeft, DownRight, DownLeft],
        mode_at: Some(0x08),
        modes: &[(0, 0), (1, 1), (2, 2), (3, 3), (4, 4), (5, 5), (6, 6), (7, 7), (8, 8)],
        difficulties: &[0, 2],
        score: |r| r.tic_tac_toe_3d(),
        lives: |_| 1,
        over: |r| r.tic_tac_toe_3d_is_over(),
    }
    time_pilot "TimePilot" 4 {
        md5: "fc2104dd2dadf9a6176c1c1c8f87ced9", scheme: F8,
        minimal: &[Noop, Fire, Up, Right, Left, Down, UpFire, RightFire, LeftFire, DownFire],
        difficulties: &[0, 1, 2],
        score: |r| 100 * r.decimal(&[0x0f, 0x0d]),
        lives: |r| ((r.at(0x0b) & 7) + 1).min(5),
        over: |r| r.at(0x20) != 0,
    }
    trondead "Trondead" v5 {
        md5: "fb27afe896e7c928089307b32e5642ee", scheme: Rom4K,
        minimal: &Action::ALL,
        difficulties: &[0, 1],
        score: |r| r.decimal(&[0x3d, 0x3e, 0x3f]),
        lives: |r| 5 - r.at(0x48),
        over: |r| r.at(0x48) == 5,
    }
    turmoil "Turmoil" v5 {
        md5: "7a5463545dfb2dcfdafa6074b2f2c15e", scheme: Rom4K,
        minimal: &[
            Noop, Fire, Up, Right, Left, Down, UpRight, UpLeft, DownRight, DownLeft, RightFire,
            LeftFire,
        ],
        start: &[Fire],
        mode_at: Some(0x6a),
        modes: &[(0, 0), (1, 1), (2, 2), (3, 3), (4, 4), (5, 5), (6, 6), (7, 7), (8, 8)],
        score: |r| 10 * (r.decimal(&[0x0a, 0x09]) + r.at(0x53)),
        lives: |r| r.at(0x39),
        over: |r| r.at(0x39) == 0 && r.at(0x45) == 1,
    }
    tutankham "Tutankham" 4 {
        md5: "085322bae40d904f53bdcc56df0593fc", scheme: E0,
        minimal: &[Noop, Up, Right, Left, Down, UpFire, RightFire, LeftFire],
        mode_at: Some(0x2b), modes: &[(0, 0), (4, 4), (8, 8), (12, 12)],
        score: |r| r.decimal(&[0x1a, 0x1c]),
        lives: |r| r.at(0x1e) & 3,
        over: |r| r.at(0x1e) == 0 && r.at(0x01) != 0x84,
    }
    up_n_down "UpNDown" 4 {
        md5: "a499d720e7ee35c62424de882a3351b6", scheme: F8,
        minimal: &[Noop, Fire, Up, Down, UpFire, DownFire],
        start: &[Fire], display: Display { first_line: 30, ..Display::NTSC },
        difficulties: &[0, 1, 2, 3],
        score: |r| r.decimal(&[0x00, 0x01, 0x02]),
        lives: |r| r.low(0x06) + 1,
        over: |r| r.low(0x06) == 0 && r.at(0x14) > 0x40,
    }
    venture "Venture" 4 {
        md5: "3e899eba0ca8cd2972da1ae5479b4f0d", scheme: Rom4K,
        minimal: &Action::ALL,
        difficulties: &[0, 1, 2, 3],
        score: |r| 100 * r.decimal(&[0x47, 0x48]),
        lives: |r| (r.at(0x46) & 7) + 1,
        over: |r| r.at(0x46) == 0 && r.at(0x4d) == 0xff && r.at(0x3f) & 0x80 != 0,
    }
    video_chess "VideoChess" v5 {
        md5: "f0b7db930ca0e548c41a97160b9f6275", scheme: Rom4K,
        minimal: &[Noop, Fire, Up, Right, Left, Down, UpRight, UpLeft, DownRight, DownLeft],
        select_frames: 1,
        mode_at: Some(0x6a), modes: &[(0, 0), (1, 1), (2, 2), (3, 3), (4, 4)],
        score: |r| if r.video_chess_is_over() { 1 - 2 * r.at(0x6e) } else { 0 },
        lives: |_| 1,
        over: |r| r.video_chess_is_over(),
    }
    video_pinball "VideoPinball" 4 {
        md5: "107cc025334211e6d29da0b6be46aec7", scheme: Rom4K,
        minimal: &[Noop, Fire, Up, Right, Left, Down, UpFire, RightFire, LeftFire],
        mode_at: Some(0x41), modes: &[(0, 0), (2, 2)], difficulties: &[0, 1],
        score: |r| r.decimal(&[0x34, 0x32, 0x30]),
        lives: |r| 4 - (r.at(0x19) & 7) + (r.at(0x28) & 1),
        over: |r| r.at(0x2f) & 1 != 0,
    }
    wizard_of_wor "WizardOfWor" 4 {
        md5: "7e8aa18bc9502eb57daaf5e7c1e94da7", scheme: Rom4K,
        minimal: &[Noop, Fire, Up, Right, Left, Down, UpFire, RightFire, LeftFire, DownFire],
        controller: Controller::RightJoystick,
        difficulties: &[0, 1],
        score: |r| 100 * r.bcd(0x06) + 10_000 * (10 * (r.high(0x08) & 7) + r.low(0x08)),
        lives: |r| r.low(0x0d) + i32::from(r.at(0x57) == 1),
        over: |r| r.low(0x0d) == 0 && r.at(0x74) == 0xf8,
    }
    yars_revenge "YarsRevenge" 4 {
        md5: "c5930d0e8cdae3e037349bfa08e871be", scheme: Rom4K,
        minimal: &Action::ALL,
        start: &[Fire],
        select_frames: 1,
        press_first: true,
        mode_at: Some(0x63),
        modes: &[(0, 0), (32, 32), (64, 64), (96, 96)],
        difficulties: &[0, 1],
        score: |r| r.decimal(&[0x60, 0x61, 0x62]),
        lives: |r| r.high(0x1e),
        over: |r| r.high(0x1e) == 0,
    }
    zaxxon "Zaxxon" 4 {
        md5: "eea0da9b987d661264cce69a7c13c3bd", scheme: F8,
        minimal: &Action::ALL,
        select_frames: 10, mode_at: Some(0x02), modes: &[(0, 0), (8, 8), (16, 16), (24, 24)],
        score: |r| 100 * r.decimal(&[0x68, 0x69]),
        lives: |r| r.at(0x6a) & 7,
        over: |r| r.at(0x6a) & 7 == 0,
    }
}
