//! Recordings of a program of our own, and pictures of it on a canvas.

use gym_atari::recording::{Recording, Start};
use gym_atari::{Action, Ale, AtariEnv, Config, Frameskip};
use gym_core::canvas::{Align, Canvas, Color, Point, Shape, Transform};
use gym_core::{Env, EnvExt};

use crate::environment::homebrew;

/// A recording of some operations without results.
fn asked(ops: &[i8]) -> Recording {
    let rom = homebrew();
    Recording {
        kind: "raw".to_owned(),
        rom: rom.game().name.to_owned(),
        md5: rom.game().md5.to_owned(),
        mode: None,
        difficulty: Some(1),
        start: Start {
            ram: String::new(),
            screen: String::new(),
            lives: 0,
        },
        ops: ops.to_vec(),
        ram: Vec::new(),
        screen: Vec::new(),
        gray: vec![String::new(), "wanted".to_owned()],
        rgb: vec!["wanted".to_owned()],
        reward: Vec::new(),
        lives: Vec::new(),
        over: Vec::new(),
        frame: Vec::new(),
    }
}

fn checksum(bytes: &[u8]) -> String {
    format!("{:08x}", crc32fast::hash(bytes))
}

/// The results are those of the same game, played by hand.
#[test]
fn a_replay_records_what_the_game_shows() {
    let rom = homebrew();
    let ops = [0, 3, 1, -1, 17, 4];
    let replay = asked(&ops).replay(&rom).unwrap();
    let mut ale = Ale::new(rom.game(), rom.bytes(), 0);
    ale.configure(gym_atari::ale::Settings {
        difficulty: Some(1),
        ..gym_atari::ale::Settings::default()
    });
    ale.reset();
    let hex = |ale: &Ale| -> String { ale.ram().0.iter().map(|x| format!("{x:02x}")).collect() };
    assert_eq!(replay.start.ram, hex(&ale));
    assert_eq!(replay.start.lives, ale.lives());
    assert_eq!(replay.start.screen, checksum(ale.picture().as_flattened()));
    let mut ram = *ale.ram().0;
    for (i, op) in ops.into_iter().enumerate() {
        let reward = match usize::try_from(op) {
            Ok(index) => ale.act(Action::ALL[index]),
            Err(_) => {
                ale.reset();
                0
            }
        };
        let changes = replay.ram[i].split(' ').filter(|change| !change.is_empty());
        for change in changes {
            let number = |digits: &str| u8::from_str_radix(digits, 16).unwrap();
            let (index, value) = (usize::from(number(&change[..2])), number(&change[2..]));
            assert_ne!(ram[index], value, "only what changed, operation {i}");
            ram[index] = value;
        }
        assert_eq!(ram, *ale.ram().0, "operation {i}");
        let picture = ale.picture().as_flattened();
        assert_eq!(replay.screen[i], checksum(picture), "operation {i}");
        let display = &rom.game().display;
        let gray: Vec<u8> = picture
            .iter()
            .map(|x| display.gray()[usize::from(*x)])
            .collect();
        let rgb: Vec<u8> = picture
            .iter()
            .flat_map(|x| display.rgb()[usize::from(*x)])
            .collect();
        let wanted = |is: bool, bytes: &[u8]| if is { checksum(bytes) } else { String::new() };
        assert_eq!(replay.gray[i], wanted(i == 1, &gray), "operation {i}");
        assert_eq!(replay.rgb[i], wanted(i == 0, &rgb), "operation {i}");
        assert_eq!(
            (
                replay.reward[i],
                replay.lives[i],
                replay.over[i],
                replay.frame[i]
            ),
            (
                reward,
                ale.lives(),
                ale.game_over().into(),
                ale.episode_frame_number()
            ),
            "operation {i}"
        );
    }
    assert_eq!(replay.first_difference(&replay.replay(&rom).unwrap()), None);
}

/// Each list is compared, up to its end, and the first operation that differs is told.
#[test]
fn a_difference_is_told_by_its_operation_and_list() {
    let rom = homebrew();
    let replay = asked(&[2; 5]).replay(&rom).unwrap();
    type Change = fn(&mut Recording, usize);
    let lists: [(&str, Change); 8] = [
        ("RAM", |r, i| r.ram[i] += "?"),
        ("picture", |r, i| r.screen[i] += "?"),
        ("gray", |r, i| r.gray[i] += "?"),
        ("colours", |r, i| r.rgb[i] += "?"),
        ("reward", |r, i| r.reward[i] += 1),
        ("lives", |r, i| r.lives[i] += 1),
        ("end", |r, i| r.over[i] ^= 1),
        ("frame number", |r, i| r.frame[i] += 1),
    ];
    for (k, (part, change)) in lists.iter().enumerate() {
        for i in 0..5 {
            let mut other = replay.clone();
            change(&mut other, i);
            let expected = Some(format!("operation {i}: {part}"));
            assert_eq!(replay.first_difference(&other), expected);
            assert_eq!(other.first_difference(&replay), expected);
            // what differs later changes nothing
            lists[7].1(&mut other, i);
            if i < 4 {
                lists[0].1(&mut other, i + 1);
            }
            if k < 7 {
                assert_eq!(replay.first_difference(&other), expected);
            }
        }
    }
    let mut longer = replay.clone();
    longer.lives.push(0);
    let expected = Some("operation 5: lives".to_owned());
    assert_eq!(longer.first_difference(&replay), expected);
    let mut other = replay.clone();
    other.start.lives += 1;
    assert_eq!(
        replay.first_difference(&other),
        Some("the start".to_owned())
    );
}

#[test]
fn a_recording_of_another_game_or_operation_is_refused() {
    let rom = homebrew();
    let refused = |recording: Recording| recording.replay(&rom).unwrap_err().to_string();
    for (op, fits) in [(-1, true), (17, true), (18, false), (-2, false)] {
        let recording = asked(&[0, op]);
        if fits {
            recording.replay(&rom).unwrap();
        } else {
            let error = refused(recording);
            let expected = format!("operation 1 is {op}: it must be -1 to 17");
            assert!(error.contains(&expected), "{error}");
        }
    }
    let error = refused(Recording {
        rom: "pong".to_owned(),
        md5: "7".repeat(32),
        ..asked(&[0])
    });
    let expected = "this is a recording of pong, not of seaquest";
    assert!(error.contains(expected), "{error}");
}

/// A canvas of pixels, for rectangles at whole coordinates.
struct Pixels(Vec<[u8; 3]>);

impl Canvas for Pixels {
    fn clear(&mut self, color: Color) {
        self.0.fill([color.r, color.g, color.b]);
    }

    fn fill(&mut self, shape: Shape<'_>, color: Color) {
        let Shape::Rect { min, size, corner } = shape else {
            panic!("{shape:?}");
        };
        assert_eq!(corner, 0.0);
        for y in min[1] as usize..(min[1] + size[1]) as usize {
            let row = &mut self.0[160 * y..160 * (y + 1)];
            row[min[0] as usize..(min[0] + size[0]) as usize].fill([color.r, color.g, color.b]);
        }
    }

    fn stroke(&mut self, shape: Shape<'_>, _: f64, _: Color) {
        panic!("{shape:?}");
    }

    fn text(&mut self, text: &str, _: Point, _: f64, _: Align, _: Color) {
        panic!("{text}");
    }

    fn push(&mut self, transform: Transform) {
        panic!("{transform:?}");
    }

    fn pop(&mut self) {}
}

/// A frame that is drawn has the pixels of an observation in colours.
#[test]
fn a_drawn_frame_is_the_picture() {
    let config = Config {
        frameskip: Frameskip::Range([1, 4]),
        ..Config::default()
    };
    let mut env = AtariEnv::with_rom(config, &homebrew()).unwrap();
    let mut seen = env.reset(3).unwrap();
    let mut colors = std::collections::BTreeSet::new();
    for step in 0..12_usize {
        let mut canvas = Pixels(vec![[7; 3]; 160 * 210]);
        env.draw(&mut canvas);
        assert_eq!(
            canvas.0.as_flattened(),
            seen.as_slice::<u8>().unwrap(),
            "step {step}"
        );
        colors.extend(canvas.0);
        seen = env.step(&(step % 6).into()).unwrap().observation;
    }
    assert!(colors.len() > 10, "{}", colors.len());
}
