//! Recording environments, with concrete types and with `BoxEnv`.

use std::cell::Cell;
use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use gym_core::canvas::{Canvas, Color};
use gym_core::render::{Frame, Metadata, RenderMode, Rendered};
use gym_core::vector::{Autoreset, SyncVectorEnv, VectorReset};
use gym_core::wrappers::{Render, RenderCollection};
use gym_core::{
    BoxEnv, Env, EnvExt, Error, Outcome, Reset, Result, Snapshot, Space, Value, VectorEnv,
    VectorEnvExt,
};
use gym_render::{
    RecordVectorVideo, RecordVectorVideoConfig, RecordVideo, RecordVideoConfig, Recorder, Video,
    VideoFormat, capped_cubic, write_video,
};
use tempfile::TempDir;

#[path = "recording/clones.rs"]
mod clones;
#[path = "recording/options.rs"]
mod options;

thread_local! {
    /// How many pictures a test's thread has drawn.
    static DRAWN: Cell<u32> = const { Cell::new(0) };
}

/// An environment that counts to 3 and shows the count as a bar.
#[derive(Clone, Default, Debug)]
struct Count(i64);

impl Env for Count {
    type Observation = i64;
    type Action = i64;

    fn observation_space(&self) -> Space {
        Space::discrete(4)
    }

    fn action_space(&self) -> Space {
        Space::discrete(1)
    }

    fn reset_into(&mut self, _reset: &Reset, observation: &mut i64) -> Result<()> {
        self.0 = 0;
        *observation = 0;
        Ok(())
    }

    fn step_into(&mut self, _action: &i64, observation: &mut i64) -> Result<Outcome> {
        self.0 += 1;
        *observation = self.0;
        Ok(Outcome {
            reward: 1.0,
            terminated: self.0 == 3,
            truncated: false,
        })
    }

    fn snapshot(&self) -> Result<Snapshot> {
        Snapshot::of(&self.0)
    }

    fn restore(&mut self, snapshot: &Snapshot) -> Result<()> {
        snapshot.get().map(|count| self.0 = count)
    }

    fn metadata(&self) -> Metadata {
        Metadata::drawn(10, (8, 4))
    }

    fn draw(&self, canvas: &mut dyn Canvas) {
        DRAWN.set(DRAWN.get() + 1);
        canvas.clear(Color::WHITE);
        canvas.rect([0.0, 0.0], [2.0 * self.0 as f64, 4.0], Color::BLACK);
    }
}

fn drawn() -> Render<Count> {
    Render::new(Count::default(), RenderMode::RgbArray).unwrap()
}

/// Plays `episodes` whole episodes.
fn play<E: Env>(env: &mut E, episodes: u32) {
    let mut actions = env.action_sampler(0).unwrap();
    for _ in 0..episodes {
        env.reset(()).unwrap();
        while !env.step(&actions.sample()).unwrap().done() {}
    }
}

/// Returns the names of the files in a folder, including hidden files.
fn names(folder: &Path) -> Vec<String> {
    let name =
        |entry: std::io::Result<fs::DirEntry>| entry.unwrap().file_name().into_string().unwrap();
    let mut names: Vec<_> = fs::read_dir(folder).unwrap().map(name).collect();
    names.sort();
    names
}

/// Returns the length of the bar in each image of a GIF, in steps.
fn counts(path: &Path) -> Vec<usize> {
    let mut options = gif::DecodeOptions::new();
    options.set_color_output(gif::ColorOutput::RGBA);
    let mut decoder = options.read_info(fs::File::open(path).unwrap()).unwrap();
    let mut row = [255; 8];
    let mut counts = Vec::new();
    while let Some(picture) = decoder.read_next_frame().unwrap() {
        for (x, pixel) in picture
            .buffer
            .chunks(4)
            .take(usize::from(picture.width))
            .enumerate()
        {
            if pixel[3] > 0 {
                row[usize::from(picture.left) + x] = pixel[0];
            }
        }
        counts.push(row.iter().filter(|&&shade| shade == 0).count() / 2);
    }
    counts
}

#[test]
fn a_recorder_takes_single_frames_and_lists() {
    let folder = TempDir::new().unwrap();
    let [single, list] = ["single.gif", "list.gif"].map(|name| folder.path().join(name));
    let mut env = drawn();
    let mut recorder = Recorder::new(&single, &env).unwrap();
    for _ in 0..2 {
        env.reset(0).unwrap();
        recorder.capture(&mut env).unwrap();
        for _ in 0..3 {
            env.step(&0).unwrap();
            recorder.capture(&mut env).unwrap();
        }
    }
    assert_eq!(recorder.finish().unwrap(), 8);

    let mut env = BoxEnv::new(RenderCollection::new(drawn()));
    let mut recorder = Recorder::new(&list, &env).unwrap();
    for _ in 0..2 {
        play(&mut env, 1);
        recorder.capture(&mut env).unwrap();
    }
    assert_eq!(recorder.frames(), 8);
    drop(recorder);
    assert_eq!(counts(&single), [0, 1, 2, 3, 0, 1, 2, 3]);
    assert_eq!(fs::read(single).unwrap(), fs::read(list).unwrap());
}

#[test]
fn a_recorder_stops_at_its_maximum_and_refuses_other_modes() {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("a.gif");
    let mut env = RenderCollection::new(drawn());
    let mut recorder = Recorder::new(&path, &env).unwrap().max_frames(3);
    play(&mut env, 1);
    recorder.capture(&mut env).unwrap();
    recorder.capture(&mut env).unwrap();
    assert_eq!(recorder.finish().unwrap(), 3);
    assert_eq!(counts(&path), [0, 1, 2]);
    let mut recorder = Recorder::new(folder.path().join("b.gif"), &env).unwrap();
    assert!(matches!(
        recorder.capture(&mut Count::default()),
        Err(Error::UnsupportedMode { .. })
    ));
    assert!(matches!(
        recorder.finish(),
        Err(Error::InvalidArgument { .. })
    ));
    // also before the first frame
    let refused = Recorder::new(folder.path().join("c.gif"), &Count::default());
    assert!(matches!(refused, Err(Error::UnsupportedMode { .. })));
    assert_eq!(names(folder.path()), ["a.gif"]);
}

#[test]
fn cubes_are_recorded() {
    let recorded: Vec<_> = (0..3001).filter(|&episode| capped_cubic(episode)).collect();
    assert_eq!(
        recorded,
        [0, 1, 8, 27, 64, 125, 216, 343, 512, 729, 1000, 2000, 3000]
    );
    let folder = TempDir::new().unwrap();
    let videos = folder.path().join("new/videos");
    let mut env = RecordVideo::new(drawn(), &videos).unwrap();
    play(&mut env, 10);
    let expected = [0, 1, 8].map(|episode| format!("rl-video-episode-{episode}.gif"));
    assert_eq!(names(&videos), expected);
    assert_eq!(counts(&videos.join(&expected[2])), [0, 1, 2, 3]);
}

#[test]
fn triggers_length_and_prefix() {
    let folder = TempDir::new().unwrap();
    let config = RecordVideoConfig {
        video_length: 5,
        name_prefix: "try".into(),
        ..folder.path().into()
    };
    let mut env = RecordVideo::new(BoxEnv::new(drawn()), config)
        .unwrap()
        .step_trigger(|step| step == 4);
    play(&mut env, 4);
    assert!(!env.is_recording());
    assert_eq!(names(folder.path()), ["try-step-4.gif"]);
    assert_eq!(
        counts(&folder.path().join("try-step-4.gif")),
        [2, 3, 0, 1, 2]
    );

    let config = RecordVideoConfig {
        extension: "png".into(),
        ..folder.path().into()
    };
    let mut both = RecordVideo::new(drawn(), config)
        .unwrap()
        .step_trigger(|step| step == 1)
        .episode_trigger(|episode| episode == 0);
    play(&mut both, 2);
    let expected = [
        "rl-video-episode-0.png",
        "rl-video-step-1.png",
        "try-step-4.gif",
    ];
    assert_eq!(names(folder.path()), expected);
}

#[test]
fn only_what_is_recorded_is_drawn() {
    let folder = TempDir::new().unwrap();
    let mut env = RecordVideo::new(drawn(), folder.path())
        .unwrap()
        .episode_trigger(|episode| episode == 1);
    let pictures = [0, 1, 2].map(|_| {
        let before = DRAWN.get();
        play(&mut env, 1);
        DRAWN.get() - before
    });
    assert_eq!(pictures, [0, 4, 0]);
}

#[test]
fn a_file_is_finished_by_close_drop_and_into_inner() {
    type End = fn(RecordVideo<Render<Count>>);
    let ends: [End; 3] = [|mut env| env.close(), drop, |env| drop(env.into_inner())];
    for end in ends {
        let folder = TempDir::new().unwrap();
        let mut env = RecordVideo::new(drawn(), folder.path()).unwrap();
        env.reset(0).unwrap();
        env.step(&0).unwrap();
        assert!(names(folder.path())[0].starts_with('.'));
        end(env);
        assert_eq!(
            counts(&folder.path().join("rl-video-episode-0.gif")),
            [0, 1]
        );
    }
}

/// A restore drops the frames from before the restore, also the frames that the recorder has taken
/// from the environment's list.
#[test]
fn a_restored_recording_has_no_old_frames() {
    let folder = TempDir::new().unwrap();
    let mut env = RecordVideo::new(RenderCollection::new(drawn()), folder.path()).unwrap();
    env.reset(0).unwrap();
    let start = env.snapshot().unwrap();
    env.step(&0).unwrap();
    assert!(env.is_recording());
    env.restore(&start).unwrap();
    let number = |env: &mut RecordVideo<_>| match env.render().unwrap() {
        Rendered::Frames(frames) => frames.len(),
        other => panic!("{other:?} are not frames"),
    };
    assert_eq!(number(&mut env), 0);
    env.step(&0).unwrap();
    env.step(&0).unwrap();
    assert_eq!(number(&mut env), 2);
}

/// Returns a vector of two sub-environments that records the first one.
fn recorded(
    config: RecordVideoConfig,
    mode: Autoreset,
) -> RecordVectorVideo<SyncVectorEnv<Render<Count>>> {
    let envs = SyncVectorEnv::new([drawn(), drawn()]).unwrap();
    let config = RecordVectorVideoConfig {
        common: config,
        record_first_only: true,
        ..Default::default()
    };
    RecordVectorVideo::new(envs.with_autoreset(mode), config).unwrap()
}

/// Steps a vector. With autoreset disabled, resets ended episodes by a mask.
fn step_all(envs: &mut impl VectorEnv, steps: usize) {
    for _ in 0..steps {
        let columns = envs.step(&Value::from([0_i64, 0])).unwrap();
        if envs.autoreset() == Autoreset::Disabled && columns.done(0) {
            let mask = VectorReset::default().mask([true, true]);
            envs.reset(mask).unwrap();
        }
    }
}

/// In SameStep mode, the frame after the last step of an episode is the first frame of the next
/// one.
#[test]
fn episodes_of_a_vector_are_recorded_in_every_mode() {
    for (mode, steps, frames) in [
        (Autoreset::NextStep, 4, &[0, 1, 2, 3][..]),
        (Autoreset::SameStep, 3, &[0, 1, 2]),
        (Autoreset::Disabled, 3, &[0, 1, 2, 3]),
    ] {
        let folder = TempDir::new().unwrap();
        let video = |episode| {
            let name = format!("rl-video-episode-{episode}.gif");
            folder.path().join(name)
        };
        let mut envs = recorded(folder.path().into(), mode).episode_trigger(|episode| episode != 2);
        envs.reset(0).unwrap();
        step_all(&mut envs, steps);
        // the second video has one frame
        assert_eq!(counts(&video(0)), frames, "{mode:?}");
        step_all(&mut envs, steps - 1);
        assert!(
            envs.is_recording() || mode == Autoreset::NextStep,
            "{mode:?}"
        );
        step_all(&mut envs, 1);
        assert_eq!(counts(&video(1)), frames, "{mode:?}");
        // the trigger refuses the third episode
        assert!(!envs.is_recording(), "{mode:?}");
        step_all(&mut envs, steps + 1);
        assert!(envs.is_recording(), "{mode:?}");
        drop(envs);
        let expected = [0, 1, 3].map(|episode| format!("rl-video-episode-{episode}.gif"));
        assert_eq!(names(folder.path()), expected, "{mode:?}");
        assert_eq!(counts(&video(3)), frames[..2], "{mode:?}");
    }
}

/// A recording with `video_length` continues past the ends of episodes.
#[test]
fn a_recording_of_a_length_goes_on_over_episodes_of_a_vector() {
    for (mode, frames) in [
        (Autoreset::NextStep, [0, 1, 2, 3, 0, 1]),
        (Autoreset::SameStep, [0, 1, 2, 0, 1, 2]),
        (Autoreset::Disabled, [0, 1, 2, 3, 0, 1]),
    ] {
        let folder = TempDir::new().unwrap();
        let config = RecordVideoConfig {
            video_length: 6,
            ..folder.path().into()
        };
        let mut envs = recorded(config, mode).episode_trigger(|episode| episode == 0);
        envs.reset(0).unwrap();
        step_all(&mut envs, 9);
        assert!(!envs.is_recording());
        assert_eq!(
            counts(&folder.path().join("rl-video-episode-0.gif")),
            frames,
            "{mode:?}"
        );
    }
}

/// Only resets of the first sub-environment begin videos: a masked reset of another sub-environment
/// does not.
#[test]
fn a_reset_of_another_sub_environment_begins_no_video() {
    for mode in [
        Autoreset::NextStep,
        Autoreset::SameStep,
        Autoreset::Disabled,
    ] {
        let folder = TempDir::new().unwrap();
        let mut envs = recorded(folder.path().into(), mode);
        envs.reset(0).unwrap();
        step_all(&mut envs, 1);
        envs.reset(VectorReset::default().mask([false, true]))
            .unwrap();
        step_all(&mut envs, 1);
        assert_eq!(names(folder.path()).len(), 1, "{mode:?}");
        // a reset of the first sub-environment ends the video
        envs.reset(VectorReset::default().mask([true, false]))
            .unwrap();
        let video = folder.path().join("rl-video-episode-0.gif");
        // an unchanged frame is shown for longer
        assert_eq!(counts(&video), [0, 1, 2], "{mode:?}");
        envs.close();
        let second = folder.path().join("rl-video-episode-1.gif");
        assert_eq!(counts(&second), [0], "{mode:?}");
    }
}

/// A step trigger gets the number of each step, including the last of an episode.
#[test]
fn steps_start_recordings_of_a_vector() {
    let folder = TempDir::new().unwrap();
    let config = RecordVideoConfig {
        name_prefix: "late".into(),
        ..folder.path().into()
    };
    let mut envs = recorded(config, Autoreset::SameStep).step_trigger(|step| step == 2);
    envs.reset(0).unwrap();
    step_all(&mut envs, 7);
    assert_eq!(names(folder.path()), ["late-step-2.gif"]);
    assert_eq!(counts(&folder.path().join("late-step-2.gif")), [0, 1, 2]);
}

#[test]
fn the_list_of_frames_stays_complete() {
    let folder = TempDir::new().unwrap();
    let mut env = RecordVideo::new(RenderCollection::new(drawn()), folder.path()).unwrap();
    for _ in 0..3 {
        play(&mut env, 1);
        assert_eq!(env.render().unwrap().into_frames().unwrap().len(), 4);
        assert_eq!(env.render().unwrap().into_frames().unwrap().len(), 0);
    }
    assert_eq!(
        counts(&folder.path().join("rl-video-episode-1.gif")),
        [0, 1, 2, 3]
    );
}

#[test]
fn an_environment_without_frames_is_refused() {
    let folder = TempDir::new().unwrap();
    let refused = RecordVideo::new(Count::default(), folder.path());
    assert!(
        matches!(refused, Err(Error::UnsupportedMode { .. })),
        "it is told before the training"
    );
}

#[test]
fn a_file_that_cannot_be_written_does_not_stop_the_training() {
    let folder = TempDir::new().unwrap();
    let videos = folder.path().join("videos");
    let mut env = RecordVideo::new(drawn(), &videos).unwrap();
    env.reset(0).unwrap();
    fs::remove_dir_all(&videos).unwrap();
    play(&mut env, 2);
    assert!(matches!(env.take_error(), Some(Error::Io { .. })));
    assert!(env.take_error().is_none());
    fs::create_dir(&videos).unwrap();
    play(&mut env, 6);
    assert_eq!(names(&videos), ["rl-video-episode-8.gif"]);
}

#[test]
fn formats_go_by_the_extension() {
    let folder = TempDir::new().unwrap();
    let mut env = RenderCollection::new(drawn());
    play(&mut env, 1);
    let frames = env.render().unwrap().into_frames().unwrap();
    for (name, signature) in [
        ("a.gif", &b"GIF89a"[..]),
        ("b.PNG", b"\x89PNG"),
        ("c.apng", b"\x89PNG"),
    ] {
        let path = folder.path().join(name);
        write_video(&path, 10, &frames).unwrap();
        assert!(fs::read(path).unwrap().starts_with(signature), "{name}");
    }
    for name in ["a.webm", "a", ".gif"] {
        let error = Video::create(folder.path().join(name), 10).unwrap_err();
        assert!(matches!(error, Error::InvalidArgument { .. }), "{error}");
    }
    assert!(Video::create(folder.path().join("d.png"), 65536).is_err());
    // frames of different sizes are an error, and the incomplete file is removed
    let mixed = [frames[0].clone(), Frame::new(1, 1).unwrap()];
    for name in ["e.gif", "e.png"] {
        assert!(
            write_video(folder.path().join(name), 10, &mixed).is_err(),
            "{name}"
        );
    }
    // also if the format cannot hold the frames
    for (width, height) in [(65_536, 1), (1, 65_536), (0, 1), (1, 0)] {
        let frame = Frame::new(width, height).unwrap();
        let error = write_video(folder.path().join("f.gif"), 10, &[frame])
            .unwrap_err()
            .to_string();
        assert!(
            error.contains("width and height must be 1 to 65535 pixels"),
            "{error}"
        );
    }
    assert_eq!(names(folder.path()), ["a.gif", "b.PNG", "c.apng"]);
}

#[test]
fn mp4_needs_ffmpeg_and_says_so() {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("a.mp4");
    let mut env = RenderCollection::new(drawn());
    play(&mut env, 1);
    let frames = env.render().unwrap().into_frames().unwrap();
    let installed = Command::new("ffmpeg")
        .arg("-version")
        .stdout(Stdio::null())
        .status()
        .is_ok();
    let written = write_video(&path, 10, &frames);
    if installed {
        written.unwrap();
        assert_eq!(&fs::read(path).unwrap()[4..8], b"ftyp");
        let mut given_up = Video::create(folder.path().join("b.mp4"), 10).unwrap();
        given_up.write(&frames[0]).unwrap();
        given_up.abandon();
        assert_eq!(names(folder.path()), ["a.mp4"]);
    } else {
        assert!(
            written
                .unwrap_err()
                .to_string()
                .contains("`ffmpeg`, which was not found")
        );
        assert_eq!(names(folder.path()), [""; 0]);
    }
}

const FOLDER: &str = "GYM_RENDER_TEST_FOLDER";

/// Records until it is killed; does nothing unless the next test starts it.
#[test]
fn endless_recording() {
    let Some(folder) = std::env::var_os(FOLDER) else {
        return;
    };
    let config = RecordVideoConfig {
        video_length: u64::MAX,
        ..folder.into()
    };
    let mut env = RecordVideo::new(drawn(), config)
        .unwrap()
        .episode_trigger(|episode| episode == 0);
    loop {
        play(&mut env, 1);
    }
}

#[test]
fn a_killed_recording_leaves_only_a_hidden_file() {
    let folder = TempDir::new().unwrap();
    let mut child = Command::new(std::env::current_exe().unwrap())
        .args(["--exact", "endless_recording"])
        .env(FOLDER, folder.path())
        .stdout(Stdio::null())
        .spawn()
        .unwrap();
    let written = || {
        names(folder.path())
            .iter()
            .any(|name| folder.path().join(name).metadata().unwrap().len() > 0)
    };
    let start = Instant::now();
    while !written() && start.elapsed() < Duration::from_secs(20) {
        std::thread::sleep(Duration::from_millis(5));
    }
    child.kill().unwrap();
    child.wait().unwrap();
    let names = names(folder.path());
    assert!(
        names.len() == 1 && names[0].starts_with(".rl-video-episode-0.gif"),
        "{names:?}"
    );
}
