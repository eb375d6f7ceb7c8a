//! What the arguments of recorders make of the files.

use super::*;

/// The size of an animation, and the hundredths of a second of its first frame.
fn shown(path: &Path) -> ([u16; 2], u16) {
    let options = gif::DecodeOptions::new();
    let mut decoder = options.read_info(fs::File::open(path).unwrap()).unwrap();
    let size = [decoder.width(), decoder.height()];
    (size, decoder.next_frame_info().unwrap().unwrap().delay)
}

/// Six frames of 8 by 4 in the grid whose ratio is the nearest, with no more rows than columns.
#[test]
fn a_grid_has_about_the_ratio_that_is_asked_for() {
    for (ratio, first_only, size) in [
        (None, false, [24, 8]),
        (Some(0.1), false, [24, 8]),
        (Some(7.0), false, [24, 8]),
        (Some(8.0), false, [48, 4]),
        (Some(12.0), false, [48, 4]),
        (Some(12.0), true, [8, 4]),
    ] {
        let folder = TempDir::new().unwrap();
        let mut config = RecordVectorVideoConfig::from(folder.path());
        config.record_first_only = first_only;
        config.video_aspect_ratio = ratio.unwrap_or(config.video_aspect_ratio);
        let envs = SyncVectorEnv::new([(); 6].map(|()| drawn())).unwrap();
        let mut envs = RecordVectorVideo::new(envs, config).unwrap();
        envs.reset(0).unwrap();
        envs.step(&Value::from([0_i64; 6])).unwrap();
        drop(envs.into_inner());
        let found = shown(&folder.path().join("rl-video-episode-0.gif"));
        assert_eq!(found, (size, 10), "{ratio:?} {first_only}");
    }
}

/// The speed is the environment's unless another is given, for one environment and for many.
#[test]
fn a_frame_is_shown_as_long_as_the_rate_says() {
    for (fps, delay) in [(None, 10), (Some(1), 100), (Some(4), 25), (Some(50), 2)] {
        let config = |folder: &TempDir| RecordVideoConfig {
            fps,
            ..folder.path().into()
        };
        let [one, many] = [(); 2].map(|()| TempDir::new().unwrap());
        let mut env = RecordVideo::new(drawn(), config(&one)).unwrap();
        play(&mut env, 1);
        drop(env);
        let mut envs = recorded(config(&many), Autoreset::NextStep);
        envs.reset(0).unwrap();
        step_all(&mut envs, 3);
        drop(envs);
        for folder in [&one, &many] {
            let found = shown(&folder.path().join("rl-video-episode-0.gif"));
            assert_eq!(found, ([8, 4], delay), "{fps:?}");
        }
    }
}

/// A GIF repeats for ever (its extension by Netscape has the count 0), and so does an animated PNG.
#[test]
fn animations_repeat() {
    for (extension, mark) in [
        ("gif", &b"NETSCAPE2.0\x03\x01\0\0"[..]),
        ("png", b"acTL\0\0\0\x04\0\0\0\0"),
    ] {
        let folder = TempDir::new().unwrap();
        let config = RecordVideoConfig {
            extension: extension.into(),
            ..folder.path().into()
        };
        let mut env = RecordVideo::new(drawn(), config).unwrap();
        play(&mut env, 1);
        drop(env);
        let file = folder
            .path()
            .join(format!("rl-video-episode-0.{extension}"));
        let bytes = fs::read(file).unwrap();
        assert!(
            bytes.windows(mark.len()).any(|part| part == mark),
            "{extension}"
        );
    }
}

/// Each format has its range of frames per second, of which both ends are in it.
#[test]
fn a_frame_rate_is_in_the_range_of_its_format() {
    let refused = |fps: u32, most: u32| {
        format!("invalid argument for Video: fps is {fps}: give the frames per second, 1 to {most}")
    };
    for (format, most) in [
        (VideoFormat::Gif, u32::MAX),
        (VideoFormat::Apng, 65535),
        (VideoFormat::Mp4, 1000),
    ] {
        for fps in [0, 1, most, most.saturating_add(1)] {
            let told = Video::in_memory(format, fps)
                .err()
                .map(|error| error.to_string());
            let expected = match (format, (1..=most).contains(&fps)) {
                (_, false) => Some(refused(fps, most)),
                (VideoFormat::Mp4, true) => Some(
                    "invalid argument for Video: MP4 needs a file: use `Video::create`, or another format".to_owned(),
                ),
                (_, true) => None,
            };
            assert_eq!(told, expected, "{format} {fps}");
        }
    }
}

/// A recorder has the environment's rate, or the one that it is given.
#[test]
fn a_recorder_has_the_rate_that_is_asked_for() {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("a.gif");
    for (fps, delay) in [(None, 10), (Some(1), 100), (Some(50), 2)] {
        let mut env = drawn();
        env.reset(0).unwrap();
        let mut recorder = match fps {
            None => Recorder::new(&path, &env).unwrap(),
            Some(fps) => Recorder::with_fps(&path, fps).unwrap(),
        };
        recorder.capture(&mut env).unwrap();
        env.step(&0).unwrap();
        recorder.capture(&mut env).unwrap();
        assert_eq!(recorder.finish().unwrap(), 2);
        assert_eq!(shown(&path), ([8, 4], delay), "{fps:?}");
    }
}
