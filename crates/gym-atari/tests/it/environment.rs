//! Tests of the environments with a program of our own.

use gym_atari::{
    AtariEnv, AtariPreprocessing, Config, Frameskip, ObsType, Preprocessing, Rom, RomDir, games,
};
use gym_core::wrappers::{OrderEnforcing, TimeLimit};
use gym_core::{
    BoxEnv, Configure, Env, EnvExt, Error, NoArguments, Outcome, Registration, Reset, Result,
    Value, WrapperSpec, builder,
};

/// Returns a program whose colour depends on the stick and on a frame counter.
pub(crate) fn homebrew() -> Rom {
    let code = [
        0x78, 0xd8, 0xa2, 0xff, 0x9a, 0xa9, 0x00, 0x95, 0x00, 0xca, 0xd0, 0xfb, // clears all
        0xa9, 0x02, 0x85, 0x00, 0x85, 0x02, 0x85, 0x02, 0x85, 0x02, 0xa9, 0x00, 0x85,
        0x00, // VSYNC
        0xe6, 0x80, 0xa5, 0x80, 0x0a, 0x4d, 0x80, 0x02, 0x85,
        0x09, // inc $80; lda $80; asl; eor SWCHA; sta COLUBK
        0x18, 0x65, 0x81, 0x85, 0x81, 0x85, 0x0e, // clc; adc $81; sta $81; sta PF1
        0xa2, 0xff, 0x85, 0x02, 0xca, 0xd0, 0xfb, // 255 lines
        0x4c, 0x0c, 0xf0,
    ];
    program(&code)
}

/// Returns a program that shows a frame counter as a colour. Of each eight frames, the first
/// `short` frames end early and leave the rest of the picture unchanged.
pub(crate) fn stutter(short: u8) -> Rom {
    let code = [
        0x78, 0xd8, 0xa2, 0xff, 0x9a, 0xa9, 0x00, 0x95, 0x00, 0xca, 0xd0, 0xfb, // clears all
        0xa9, 0x02, 0x85, 0x00, 0x85, 0x02, 0x85, 0x02, 0x85, 0x02, 0xa9, 0x00, 0x85,
        0x00, // VSYNC
        0xe6, 0x80, 0xa5, 0x80, 0x0a, 0x85, 0x09, // inc $80; lda $80; asl; sta COLUBK
        0xa5, 0x80, 0x29, 0x07, 0xc9, short, 0x90, 0x04, // lda $80; and #7; cmp #short; bcc
        0xa2, 0xff, 0xd0, 0x02, 0xa2, 0x50, // 255 lines, or 80
        0x85, 0x02, 0xca, 0xd0, 0xfb, 0x4c, 0x0c, 0xf0,
    ];
    program(&code)
}

fn program(code: &[u8]) -> Rom {
    let mut rom = vec![0xea; 4096];
    rom[..code.len()].copy_from_slice(code);
    rom[4092..].copy_from_slice(&[0x00, 0xf0, 0x00, 0xf0]);
    Rom::homebrew(games::by_name("seaquest").unwrap(), &rom)
}

fn env(config: Config) -> AtariEnv {
    AtariEnv::with_rom(config, &homebrew()).unwrap()
}

#[test]
fn observations_have_the_shape_of_their_space() {
    for (obs_type, shape) in [
        (ObsType::Rgb, vec![210, 160, 3]),
        (ObsType::Grayscale, vec![210, 160]),
        (ObsType::Ram, vec![128]),
    ] {
        let mut env = env(Config {
            obs_type,
            ..Config::default()
        });
        let observation = env.reset(1).unwrap();
        assert_eq!(observation.shape(), shape);
        assert!(env.observation_space().contains(&Value::Array(observation)));
    }
}

/// Both of the last two pictures are complete, even if frames end early and steps have random
/// lengths.
#[test]
fn pictures_of_short_frames_are_whole() {
    let frames = |env: &AtariEnv| env.ale().frame_number();
    for short in 1..8 {
        for frameskip in [
            Frameskip::Range([1, 7]),
            Frameskip::Range([1, 3]),
            Frameskip::Fixed(2),
            Frameskip::Fixed(3),
            Frameskip::Fixed(4),
            Frameskip::Fixed(5),
            Frameskip::Fixed(7),
        ] {
            let config = |frameskip| Config {
                frameskip,
                repeat_action_probability: 0.0,
                ..Config::default()
            };
            let mut skipping = AtariEnv::with_rom(config(frameskip), &stutter(short)).unwrap();
            let mut single =
                AtariEnv::with_rom(config(Frameskip::Fixed(1)), &stutter(short)).unwrap();
            assert_eq!(skipping.reset(5).unwrap(), single.reset(5).unwrap());
            for step in 0..60 {
                let seen = skipping.step(&0.into()).unwrap().observation;
                let mut expected = None;
                while frames(&single) < frames(&skipping) {
                    expected = Some(single.step(&0.into()).unwrap().observation);
                }
                assert_eq!(
                    Some(seen),
                    expected,
                    "{short} short frames of eight, {frameskip:?}, step {step}"
                );
            }
        }
    }
}

/// Skipped frames give the same observations as single frames, whichever frames are drawn.
#[test]
fn skipped_frames_show_the_same() {
    for skip in [2, 3, 4, 5] {
        let config = |frameskip| Config {
            frameskip,
            repeat_action_probability: 0.25,
            ..Config::default()
        };
        let mut skipping = env(config(Frameskip::Fixed(skip)));
        let mut single = env(config(Frameskip::Fixed(1)));
        assert_eq!(skipping.reset(5).unwrap(), single.reset(5).unwrap());
        for step in 0..30usize {
            let action = (step * 7 % 18).into();
            let expected = (0..skip)
                .map(|_| single.step(&action).unwrap())
                .last()
                .unwrap();
            assert_eq!(
                skipping.step(&action).unwrap().observation,
                expected.observation,
                "skip {skip}, step {step}"
            );
        }
    }
}

#[test]
fn snapshots_continue_in_another_environment() {
    let config = Config {
        frameskip: Frameskip::Range([2, 5]),
        ..Config::default()
    };
    let mut first = env(config.clone());
    first.reset(3).unwrap();
    for step in 0..7usize {
        first.step(&(step % 18).into()).unwrap();
    }
    let snapshot = first.snapshot().unwrap();
    let mut second = env(config);
    second.restore(&snapshot).unwrap();
    assert_eq!(second.info_map(), first.info_map());
    for step in 0..20usize {
        let action = (step % 18).into();
        assert_eq!(second.step(&action).unwrap(), first.step(&action).unwrap());
    }
    assert_eq!(second.snapshot().unwrap(), first.snapshot().unwrap());
    let mut other = env(Config::default());
    assert!(
        matches!(other.restore(&snapshot), Err(Error::Snapshot(_))),
        "other arguments"
    );
}

#[test]
fn preprocessing_takes_the_brighter_of_two_frames() {
    let settings = Preprocessing {
        noop_max: 0,
        screen_size: [210, 160],
        ..Preprocessing::default()
    };
    let gray = Config {
        frameskip: Frameskip::Fixed(1),
        obs_type: ObsType::Grayscale,
        ..Config::default()
    };
    let mut plain = env(gray.clone());
    let mut small = AtariPreprocessing::new(env(gray), settings).unwrap();
    assert_eq!(small.reset(9).unwrap(), plain.reset(9).unwrap());
    for step in 0..20usize {
        let action = (step * 5 % 18).into();
        let frames: Vec<_> = (0..4)
            .map(|_| plain.step(&action).unwrap().observation)
            .collect();
        let [.., before, last] = &frames[..] else {
            unreachable!()
        };
        let pairs = before
            .as_slice::<u8>()
            .unwrap()
            .iter()
            .zip(last.as_slice::<u8>().unwrap());
        let brighter: Vec<u8> = pairs.map(|(a, b)| *a.max(b)).collect();
        let observed = small.step(&action).unwrap().observation;
        assert_eq!(observed.as_slice::<u8>().unwrap(), brighter, "step {step}");
    }
    let snapshot = small.snapshot().unwrap();
    let next = small.step(&3.into()).unwrap();
    small.restore(&snapshot).unwrap();
    assert_eq!(small.step(&3.into()).unwrap(), next);
}

/// A spec names the wrapper with its arguments. `make` of the spec makes the same wrapper.
#[test]
fn preprocessing_is_made_from_its_spec() {
    let config = || Config {
        frameskip: Frameskip::Fixed(1),
        ..Config::default()
    };
    let settings = Preprocessing {
        noop_max: 5,
        frame_skip: 3,
        screen_size: [64, 80],
        terminal_on_life_loss: true,
    };
    let mut typed = AtariPreprocessing::new(env(config()), settings).unwrap();
    let spec = gym_core::Wrapper::wrapper_spec(&typed).unwrap();
    let spec: WrapperSpec = serde_json::from_str(&serde_json::to_string(&spec).unwrap()).unwrap();
    let mut made = spec
        .wrap(BoxEnv::new(OrderEnforcing::new(env(config()))))
        .unwrap();
    assert_eq!(
        Value::Array(typed.reset(4).unwrap()),
        made.reset(4).unwrap()
    );
    for step in 0..20usize {
        let (typed, made) = (
            typed.step(&(step % 18).into()).unwrap(),
            made.step(&Value::Int(step as i64 % 18)).unwrap(),
        );
        assert_eq!(
            Value::Array(typed.observation),
            made.observation,
            "step {step}"
        );
        assert_eq!(
            (typed.reward, typed.terminated),
            (made.reward, made.terminated)
        );
    }

    let refused = |spec: &WrapperSpec, env| spec.wrap(env).unwrap_err().to_string();
    let unknown = WrapperSpec::new("AtariPreprocessing").arg("grayscale_newaxis", 7);
    assert!(refused(&unknown, BoxEnv::new(env(config()))).contains("grayscale_newaxis"));
    let plain = WrapperSpec::new("AtariPreprocessing");
    let between = BoxEnv::new(TimeLimit::new(env(config()), 9).unwrap());
    assert!(refused(&plain, between).contains("wrapped in TimeLimit"));
    let skipping = BoxEnv::new(env(Config::default()));
    assert!(refused(&plain, skipping).contains("it must be 1"));
}

/// A registered game with our own program instead of a ROM.
#[derive(Clone)]
struct Homebrew(AtariEnv);

impl gym_core::Wrapper for Homebrew {
    type Inner = AtariEnv;
    type Observation = <AtariEnv as Env>::Observation;
    type Action = <AtariEnv as Env>::Action;

    fn inner(&self) -> &AtariEnv {
        &self.0
    }

    fn inner_mut(&mut self) -> &mut AtariEnv {
        &mut self.0
    }

    fn on_reset(&mut self, reset: &Reset, observation: &mut Self::Observation) -> Result<()> {
        self.0.reset_into(reset, observation)
    }

    fn on_step(
        &mut self,
        action: &Self::Action,
        observation: &mut Self::Observation,
    ) -> Result<Outcome> {
        self.0.step_into(action, observation)
    }

    fn on_visit_layers(&self, visit: &mut dyn FnMut(&'static str)) {
        self.0.visit_layers(visit);
    }
}

impl Configure for Homebrew {
    type Config = NoArguments;

    fn configure(_: NoArguments, _: u32) -> Result<Self> {
        Ok(Self(env(Config {
            frameskip: Frameskip::Fixed(1),
            ..Config::default()
        })))
    }
}

gym_core::register!(Registration::new::<Homebrew>("tests/Homebrew-v0"));

#[test]
fn preprocessing_goes_around_what_make_gives() {
    let preprocessing = || WrapperSpec::new("AtariPreprocessing");
    let made = builder("tests/Homebrew-v0")
        .wrap(preprocessing())
        .build()
        .unwrap();
    assert_eq!(made.observation_space().shape(), Some(&[84, 84][..]));
    let limited = builder("tests/Homebrew-v0")
        .max_episode_steps(9)
        .wrap(preprocessing())
        .build();
    assert!(
        limited
            .unwrap_err()
            .to_string()
            .contains("wrapped in TimeLimit")
    );
}

#[test]
fn steps_allocate_nothing() {
    let config = Config {
        frameskip: Frameskip::Fixed(1),
        ..Config::default()
    };
    let mut small = AtariPreprocessing::new(env(config), Preprocessing::default()).unwrap();
    let mut large = env(Config::default());
    let (mut a, mut b) = (small.reset(1).unwrap(), large.reset(1).unwrap());
    let allocations = allocation_counter::measure(|| {
        for step in 0..20usize {
            small.step_into(&(step % 18).into(), &mut a).unwrap();
            large.step_into(&(step % 18).into(), &mut b).unwrap();
        }
    });
    assert_eq!(allocations.count_total, 0);
}

/// Each argument that makes no environment is refused with its name, its value and what it may be.
#[test]
fn mistakes_are_named() {
    type Set = fn(&mut Config);
    let cases: [(Set, &str); 12] = [
        (
            |config| config.frameskip = Frameskip::Fixed(0),
            "Invalid frameskip of 0, frameskip must be positive.",
        ),
        (
            |config| config.frameskip = Frameskip::Fixed(10_001),
            "frameskip is 10001: it must be at most 10000",
        ),
        (
            |config| config.frameskip = Frameskip::Range([0, 3]),
            "Invalid stochastic frameskip, lower bound must be positive.",
        ),
        (
            |config| config.frameskip = Frameskip::Range([3, 3]),
            "Invalid stochastic frameskip, lower bound must be strictly less than upper bound.",
        ),
        (
            |config| config.frameskip = Frameskip::Range([1, 10_001]),
            "frameskip is 10001: it must be at most 10000",
        ),
        (
            |config| config.difficulty = Some(9),
            "Invalid difficulty requested: difficulty is 9, and the difficulties are [0, 1]",
        ),
        (
            |config| config.mode = Some(9),
            "Invalid game mode requested: mode is 9, and the modes are [0]",
        ),
        (
            |config| config.repeat_action_probability = -0.1,
            "repeat_action_probability is -0.1: it is a probability, 0 to 1",
        ),
        (
            |config| config.repeat_action_probability = f64::NAN,
            "repeat_action_probability is NaN: it is a probability, 0 to 1",
        ),
        (
            |config| config.repeat_action_probability = f64::INFINITY,
            "repeat_action_probability is inf: it is a probability, 0 to 1",
        ),
        (
            |config| config.continuous_action_threshold = f64::NAN,
            "continuous_action_threshold is NaN: it must be a finite number",
        ),
        (
            |config| config.sound_obs = true,
            "sound_obs is true: sound is not emulated, so it cannot be observed",
        ),
    ];
    for (set, reason) in cases {
        let mut config = Config::default();
        set(&mut config);
        let error = AtariEnv::with_rom(config, &homebrew()).unwrap_err();
        let expected = format!("invalid argument for Atari (seaquest): {reason}");
        assert_eq!(error.to_string(), expected);
    }
    let mut env = env(Config::default());
    assert!(matches!(env.step(&0.into()), Err(Error::ResetNeeded(_))));
    env.reset(0).unwrap();
    assert!(matches!(
        env.step(&18.into()),
        Err(Error::InvalidAction { .. })
    ));
}

#[test]
fn missing_and_wrong_roms_are_named() {
    let folder = std::env::temp_dir().join(format!("gym-atari-roms-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let game = games::by_name("breakout").unwrap();
    let error = RomDir::new(&folder).rom(game).unwrap_err().to_string();
    assert!(
        error.contains("pip install ale-py") && error.contains("breakout.bin"),
        "{error}"
    );
    std::fs::write(folder.join("breakout.bin"), [0; 2048]).unwrap();
    let error = RomDir::new(&folder).rom(game).unwrap_err().to_string();
    assert!(error.contains(game.md5), "{error}");
    std::fs::File::create(folder.join("breakout.bin"))
        .unwrap()
        .set_len(2 << 20)
        .unwrap();
    let error = RomDir::new(&folder).rom(game).unwrap_err().to_string();
    assert!(error.contains("longer than 1048576 bytes"), "{error}");
    std::fs::remove_dir_all(&folder).unwrap();
}

/// A ROM from memory is taken before a folder that is found, and after one that is named. Where folders are found, an
/// environment variable says, so the test runs itself with it.
#[test]
fn a_provided_rom_comes_before_the_folder_that_is_found() {
    const NOWHERE: &str = "/nowhere/roms";
    if std::env::var_os(gym_atari::rom::VARIABLE).is_none_or(|path| path != NOWHERE) {
        let mut again = std::process::Command::new(std::env::current_exe().unwrap());
        again.env(gym_atari::rom::VARIABLE, NOWHERE);
        again.args([
            "--exact",
            "environment::a_provided_rom_comes_before_the_folder_that_is_found",
        ]);
        assert!(again.status().unwrap().success());
        return;
    }
    gym_atari::rom::provide(homebrew());
    let [seaquest, breakout] = ["seaquest", "breakout"].map(|name| games::by_name(name).unwrap());
    let found = gym_atari::rom::load(seaquest, None).unwrap();
    assert_eq!(found.md5(), homebrew().md5());
    for (game, folder) in [(breakout, None), (seaquest, Some("/nowhere/else".as_ref()))] {
        let error = gym_atari::rom::load(game, folder).unwrap_err().to_string();
        assert!(error.contains("/nowhere/"), "{error}");
    }
}

/// A pipe would wait for a writer, and a device such as `/dev/zero` never ends.
#[cfg(unix)]
#[test]
fn roms_that_are_not_regular_files_are_refused() {
    use std::os::unix::fs::symlink;
    use std::sync::mpsc;
    use std::time::Duration;

    let folder = std::env::temp_dir().join(format!("gym-atari-no-files-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let path = folder.join("breakout.bin");
    let game = games::by_name("breakout").unwrap();
    let pipe = folder.join("pipe");
    assert!(
        std::process::Command::new("mkfifo")
            .args([&path, &pipe])
            .status()
            .unwrap()
            .success()
    );
    for target in [
        None,
        Some(pipe.as_path()),
        Some("/dev/zero".as_ref()),
        Some(folder.as_path()),
    ] {
        if let Some(target) = target {
            std::fs::remove_file(&path).unwrap();
            symlink(target, &path).unwrap();
        }
        // on a thread, so that the test fails if the call waits
        let (sender, receiver) = mpsc::channel();
        let roms = RomDir::new(&folder);
        std::thread::spawn(move || sender.send(roms.rom(game).unwrap_err().to_string()));
        let error = receiver.recv_timeout(Duration::from_secs(20)).unwrap();
        assert!(error.contains(&*path.to_string_lossy()), "{error}");
        assert!(
            error.contains("not a regular file") && error.contains("rom_dir"),
            "{error}"
        );
    }
    std::fs::remove_dir_all(&folder).unwrap();
}

/// Pictures are large, but an environment fits on a thread's stack of a quarter of the default
/// size.
#[test]
fn an_environment_fits_on_a_small_stack() {
    let play = || {
        let mut env = env(Config::default());
        env.reset(1).unwrap();
        env.step(&0.into()).unwrap();
        let snapshot = env.snapshot().unwrap();
        env.restore(&snapshot).unwrap();
    };
    std::thread::Builder::new()
        .stack_size(512 << 10)
        .spawn(play)
        .unwrap()
        .join()
        .unwrap();
}

/// The ROM is not an argument, so a snapshot contains its checksum.
#[test]
fn a_snapshot_of_another_rom_is_refused() {
    let mut env = env(Config::default());
    env.reset(1).unwrap();
    let text = serde_json::to_string(&env.snapshot().unwrap()).unwrap();
    let own = text
        .split("\"md5\":\"")
        .nth(1)
        .and_then(|rest| rest.get(..32))
        .unwrap();
    let other = text.replace(own, "00112233445566778899aabbccddeeff");
    let error = env
        .restore(&serde_json::from_str(&other).unwrap())
        .unwrap_err()
        .to_string();
    assert!(
        error.contains("MD5 00112233445566778899aabbccddeeff"),
        "{error}"
    );
    env.restore(&serde_json::from_str(&text).unwrap()).unwrap();
}

/// An environment refuses a continuous action with a NaN or an infinity, and an action of the other
/// kind. A refused action plays no frame. A continuous action outside of the bounds is accepted.
#[test]
fn sticks_that_are_no_numbers_are_refused() {
    use gym_atari::AtariAction::{Index, Stick};
    let mut continuous = env(Config {
        continuous: true,
        ..Config::default()
    });
    continuous.reset(0).unwrap();
    let frames = continuous.ale().frame_number();
    for part in 0..3 {
        for number in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            let mut stick = [0.0; 3];
            stick[part] = number;
            let error = continuous.step(&Stick(stick)).unwrap_err();
            assert!(
                matches!(error, Error::InvalidAction { .. }),
                "{stick:?}: {error}"
            );
        }
    }
    assert!(continuous.step(&Index(0)).is_err());
    assert_eq!(continuous.ale().frame_number(), frames);
    continuous.step(&Stick([7.0, -9.0, -1.0])).unwrap();

    let mut discrete = env(Config::default());
    discrete.reset(0).unwrap();
    let n = discrete.actions().len();
    assert!(discrete.step(&Index(n - 1)).is_ok());
    assert!(discrete.step(&Index(n)).is_err());
    assert!(discrete.step(&Stick([0.0; 3])).is_err());
}
