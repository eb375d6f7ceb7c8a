//! Programs of our own that switch banks. Their RAM is compared with ale-py 0.12.1's. ale-py
//! detects the scheme by the size of the ROM, by an empty start of each bank (a cartridge with
//! RAM), by accesses to the addresses of `E0`, and by a call of `$D000` (`FE`).

use gym_atari::Display;
use gym_atari::cartridge::{Banks, Cartridge, Scheme};
use gym_atari::console::{Console, Input};

use crate::lcg::Lcg;

/// Returns a program that selects random banks by every kind of access, and stores bytes of these
/// banks from `$80` on. Each 4K bank holds the same program; the program of `E0` is in the last
/// slice, which is always mapped.
fn program(scheme: Scheme, seed: u32) -> Vec<u8> {
    let (hotspot, hotspots, banks) = match scheme {
        Scheme::F8 | Scheme::F8SC => (0xfff8, 2, 2),
        Scheme::F6 | Scheme::F6SC => (0xfff6, 4, 4),
        _ => (0xffe0, 24, 8),
    };
    let e0 = scheme == Scheme::E0;
    let with_ram = matches!(scheme, Scheme::F8SC | Scheme::F6SC);
    let (start, size, at) = if e0 {
        (0xfc00_u16, 1024, 0)
    } else {
        (0xf100, 4096, 0x100)
    };
    let mut random = Lcg(seed);
    let mut code = vec![
        0x78, 0xd8, 0xa2, 0xff, 0x9a, 0xa9, 0x00, 0xa2, 0x7f, 0x95, 0x80, 0xca, 0x10, 0xfb,
    ]; // clears RAM
    let absolute = |opcode: u8, address: u16| [opcode, address as u8, (address >> 8) as u8];
    if with_ram {
        // give the cartridge's RAM a known content
        for cell in 0..8 {
            code.extend([0xa9, 29 * cell, 0x8d, cell, 0xf0]); // lda #value; sta cell
        }
    }
    for result in 0x80..0xb8 {
        let address = hotspot + random.below(hotspots);
        let (form, k) = (random.below(5), random.below(256));
        match form {
            0 => code.extend(absolute(0xad, address)), // lda address
            1 => code.extend(absolute(0x8d, address)), // sta address
            2 => {
                code.extend([0xa2, k as u8]); // ldx #k
                code.extend(absolute(0xbd, address.wrapping_sub(k))); // lda address - k,x
            }
            3 => code.extend(absolute(0xee, address)), // inc address
            _ => {}
        }
        if with_ram {
            let (what, cell) = (random.below(4), random.below(8));
            match what {
                0 => {
                    code.extend([0xa9, k as u8]); // lda #k
                    code.extend(absolute(0x8d, 0xf000 + cell)); // sta cell
                }
                // inc cell, which writes to an address without a chip
                1 => code.extend(absolute(0xee, 0xf080 + cell)),
                _ => {}
            }
        }
        let data = random.below(if e0 { 0x0c00 } else { 0x0400 });
        let mut data = if e0 { 0xf000 + data } else { 0xf800 + data };
        if with_ram && random.below(2) == 0 {
            data = 0xf080 + random.below(8);
        }
        code.extend(absolute(0xad, data)); // lda data
        code.extend([0x85, result]); // sta result
    }
    let [low, high] = (start + code.len() as u16).to_le_bytes();
    code.extend([
        0xa9, 0x02, 0x85, 0x00, 0x85, 0x02, 0x85, 0x02, 0xa9, 0x00, 0x85, 0x00,
    ]); // VSYNC
    code.extend([0xa2, 0xff, 0x85, 0x02, 0xca, 0xd0, 0xfb, 0x4c, low, high]); // 255 lines
    let bank = |number: usize| {
        let mut bank: Vec<u8> = (0..size)
            .map(|i| (31 * number + 17 * i + (i >> 8)) as u8)
            .collect();
        if with_ram {
            bank[..256].fill(0);
        }
        if !e0 || number == banks - 1 {
            bank[at..][..code.len()].copy_from_slice(&code);
            let [low, high] = start.to_le_bytes();
            bank[size - 4..].copy_from_slice(&[low, high, low, high]);
        }
        bank
    };
    (0..banks).flat_map(bank).collect()
}

/// Returns a program that calls subroutines in both banks of `FE`. Each subroutine reads a byte of
/// its bank. The program stores the bytes from `$80` on.
fn calls(seed: u32) -> Vec<u8> {
    let mut random = Lcg(seed);
    let mut code = vec![
        0x78, 0xd8, 0xa2, 0xff, 0x9a, 0xa9, 0x00, 0xa2, 0x7f, 0x95, 0x80, 0xca, 0x10, 0xfb,
    ]; // clears RAM
    let absolute = |opcode: u8, address: u16| [opcode, address as u8, (address >> 8) as u8];
    let mut base = 0xf100;
    for result in 0x80..0xb8 {
        if random.below(4) == 0 {
            base ^= 0x2000;
            // jmp to the next instruction, in the other bank's addresses
            code.extend(absolute(0x4c, base + code.len() as u16 + 3));
        }
        let subroutines = if random.below(2) == 1 { 0xd600 } else { 0xf600 };
        code.extend(absolute(0x20, subroutines + 4 * random.below(8))); // jsr
        if random.below(2) == 1 {
            let bank = if random.below(2) == 1 { 0xf700 } else { 0xd700 };
            code.extend(absolute(0xad, bank + random.below(256))); // lda data
        }
        code.extend([0x85, result]); // sta result
    }
    let [low, high] = (base + code.len() as u16).to_le_bytes();
    code.extend([
        0xa9, 0x02, 0x85, 0x00, 0x85, 0x02, 0x85, 0x02, 0xa9, 0x00, 0x85, 0x00,
    ]); // VSYNC
    code.extend([0xa2, 0xff, 0x85, 0x02, 0xca, 0xd0, 0xfb, 0x4c, low, high]); // 255 lines
    let bank = |number: usize| {
        let mut bank: Vec<u8> = (0..4096)
            .map(|i| (31 * number + 17 * i + (i >> 8) + 5) as u8)
            .collect();
        bank[0x100..][..code.len()].copy_from_slice(&code);
        for i in 0..8u8 {
            let high = if i % 2 == 1 { 0xd7 } else { 0xf7 };
            bank[0x600 + 4 * usize::from(i)..][..4].copy_from_slice(&[
                0xad,
                i.wrapping_mul(37),
                high,
                0x60,
            ]); // lda data; rts
        }
        bank[0xf00..][..5].copy_from_slice(&[0x20, 0x00, 0xd0, 0xc6, 0xc5]); // jsr $D000; dec $C5
        bank[4092..].copy_from_slice(&[0x00, 0xf1, 0x00, 0xf1]);
        bank
    };
    (0..2).flat_map(bank).collect()
}

#[test]
fn banks_are_switched_as_in_ale_py() {
    let cases = [
        (
            Scheme::F8,
            &[0x3b0a_540e, 0x60bd_2693, 0x0e13_a816, 0x2e6d_4272][..],
        ),
        (
            Scheme::F8SC,
            &[0xeb11_f258, 0xc3e0_20b1, 0xfac3_7f69, 0xea30_8f17][..],
        ),
        (
            Scheme::F6,
            &[0x9aba_474f, 0x8c30_ea64, 0x4aa5_51b3, 0x7599_1d54][..],
        ),
        (
            Scheme::F6SC,
            &[0xcaa2_8dc0, 0xb313_6294, 0xa227_dc73, 0x626b_84ce][..],
        ),
        (Scheme::E0, &[0x4060_ddde, 0x2ba7_0574][..]),
        (
            Scheme::FE,
            &[0xada2_1f07, 0x5cfb_b452, 0x36da_ca9c, 0x2309_4254][..],
        ),
    ];
    for (scheme, expected) in cases {
        for (seed, expected) in (0..).zip(expected.iter().copied()) {
            let rom = if scheme == Scheme::FE {
                calls(seed)
            } else {
                program(scheme, seed)
            };
            let mut console =
                Console::new(Cartridge::new(&rom, scheme), Display::NTSC, [0; 128], 74);
            console.frame(&Input::default());
            assert_eq!(
                crc32fast::hash(console.ram()),
                expected,
                "{scheme:?}, seed {seed}"
            );
        }
    }
}

/// A window of a stored cartridge starts at any kilobyte of its ROM, and nowhere else.
#[test]
fn stored_windows_lie_within_the_rom() {
    let kilobytes = [4, 4, 8, 8, 16, 16, 8, 8, 10];
    for (scheme, kilobytes) in Scheme::ALL.into_iter().zip(kilobytes) {
        let mut cartridge = Cartridge::new(&[1, 2, 3], scheme);
        let stored = serde_json::to_value(cartridge.banks()).unwrap();
        for (window, half) in (0..4).flat_map(|window| (0..36).map(move |half| (window, half))) {
            let mut changed = stored.clone();
            changed["windows"][window] = (half * 0x200).into();
            let banks: Banks = serde_json::from_value(changed).unwrap();
            let before = cartridge.banks().clone();
            let fits = half % 2 == 0 && half / 2 < kilobytes;
            let what = format!("{scheme:?}, window {window} at {half} halves");
            assert_eq!(cartridge.set_banks(&banks), fits, "{what}");
            assert_eq!(
                *cartridge.banks(),
                if fits { banks } else { before },
                "{what}"
            );
        }
        for other in Scheme::ALL {
            let banks = Cartridge::new(&[], other).banks().clone();
            assert_eq!(
                cartridge.set_banks(&banks),
                other == scheme,
                "{scheme:?} {other:?}"
            );
        }
    }
}

/// Stored pictures have a colour for each of their pixels, and one of the two is being drawn.
#[test]
fn damaged_pictures_are_refused_and_change_nothing() {
    const PIXELS: u32 = 2 * 250 * 160;
    let cartridge = Cartridge::new(&[], Scheme::Rom4K);
    let mut console = Console::new(cartridge, Display::NTSC, [0; 128], 74);
    for (fits, current, runs) in [
        (true, 0, vec![(PIXELS, 4)]),
        (true, 1, vec![(1, 2), (PIXELS - 1, 4)]),
        (false, 2, vec![(PIXELS, 4)]),
        (false, 0, vec![]),
        (false, 0, vec![(PIXELS - 1, 4)]),
        (false, 0, vec![(PIXELS + 1, 4)]),
        (false, 0, vec![(PIXELS, 4), (1, 6)]),
        (false, 1, vec![(u32::MAX, 4)]),
    ] {
        let stored = serde_json::json!({"current": current, "runs": runs});
        let pictures = serde_json::from_value(stored.clone()).unwrap();
        let before = console.pictures();
        assert_eq!(console.set_pictures(&pictures), fits, "{stored}");
        assert_eq!(
            console.pictures(),
            if fits { pictures } else { before },
            "{stored}"
        );
    }
}
