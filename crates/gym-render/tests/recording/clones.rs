//! Clones of what records and renders go on as the original does.

use super::*;

/// A clone counts episodes and steps on from where the original is: with triggers of its own it records under the numbers
/// under which the original goes on, with the same arguments.
#[test]
fn a_clone_counts_on() {
    for (episodes, steps, expected) in [
        (
            0,
            0,
            "a-episode-1.gif a-step-0.gif a-step-1.gif a-step-2.gif a-step-3.gif a-step-4.gif a-step-5.gif",
        ),
        (
            0,
            2,
            "a-episode-1.gif a-step-2.gif a-step-3.gif a-step-4.gif a-step-5.gif",
        ),
        (
            2,
            1,
            "a-episode-3.gif a-step-10.gif a-step-11.gif a-step-7.gif a-step-8.gif a-step-9.gif",
        ),
    ] {
        let folder = TempDir::new().unwrap();
        let config = RecordVideoConfig {
            name_prefix: "a".into(),
            video_length: 2,
            fps: Some(5),
            ..folder.path().into()
        };
        let mut env = RecordVideo::new(drawn(), config).unwrap();
        env = env.episode_trigger(|_| false);
        play(&mut env, episodes);
        env.reset(0).unwrap();
        for _ in 0..steps {
            env.step(&0).unwrap();
        }
        let clone = env.clone();
        let recorded = [clone, env].map(|env| {
            let mut env = env.episode_trigger(|_| true).step_trigger(|_| true);
            while !env.step(&0).unwrap().done() {}
            play(&mut env, 1);
            drop(env);
            let names = names(folder.path());
            let files = names.iter().map(|name| folder.path().join(name));
            let videos = files.clone().map(|file| fs::read(file).unwrap());
            let videos: Vec<_> = videos.collect();
            files.for_each(|file| fs::remove_file(file).unwrap());
            (names.join(" "), videos)
        });
        assert_eq!(
            recorded[0].0, expected,
            "after {episodes} episodes and {steps} steps"
        );
        assert!(recorded[0] == recorded[1], "{expected}");
    }
}

/// An environment that shows how many pictures of it were drawn before, as it was told, as a bar.
#[derive(Clone, Debug)]
struct Told(u64);

impl Env for Told {
    type Observation = i64;
    type Action = i64;

    fn observation_space(&self) -> Space {
        Space::discrete(1)
    }

    fn action_space(&self) -> Space {
        Space::discrete(1)
    }

    fn reset_into(&mut self, _: &Reset, _: &mut i64) -> Result<()> {
        Ok(())
    }

    fn step_into(&mut self, _: &i64, _: &mut i64) -> Result<Outcome> {
        Ok(Outcome::default())
    }

    fn metadata(&self) -> Metadata {
        Metadata::drawn(10, (8, 4))
    }

    fn frames_drawn(&mut self, count: u64) {
        self.0 = count;
    }

    fn draw(&self, canvas: &mut dyn Canvas) {
        canvas.clear(Color::WHITE);
        canvas.rect([0.0, 0.0], [self.0 as f64, 4.0], Color::BLACK);
    }
}

/// A clone renders in the same mode and size, and counts its pictures on.
#[test]
fn a_clone_that_renders_goes_on() {
    for pictures in [0, 1, 3] {
        let mut env = Render::new(Told(9), RenderMode::RgbArray).unwrap();
        env = env.with_size(16, 8).unwrap();
        env.reset(0).unwrap();
        for _ in 0..pictures {
            env.render().unwrap();
        }
        let mut clone = env.clone();
        assert_eq!(clone.render_mode(), Some(RenderMode::RgbArray));
        for drawn in pictures..pictures + 3 {
            let [a, b] = [&mut env, &mut clone].map(|env| env.render().unwrap().into_frame());
            let row = &a.as_ref().unwrap().pixels()[..3 * 16];
            let black = row.chunks(3).filter(|pixel| **pixel == [0; 3]).count();
            assert_eq!(black, 2 * drawn, "after {pictures} pictures");
            assert!(a == b, "after {pictures} pictures, {drawn}");
        }
    }
}

#[test]
fn recording_is_no_part_of_clones_and_snapshots() {
    let folder = TempDir::new().unwrap();
    let mut env = RecordVideo::new(drawn(), folder.path()).unwrap();
    env.reset(0).unwrap();
    assert_eq!(env.snapshot().unwrap(), drawn().snapshot().unwrap());
    let start = env.snapshot().unwrap();
    env.step(&0).unwrap();
    let mut clone = env.clone();
    play(&mut clone, 9);
    drop(clone);
    env.restore(&start).unwrap();
    env.step(&0).unwrap();
    env.step(&0).unwrap();
    drop(env);
    assert_eq!(names(folder.path()), ["rl-video-episode-0.gif"]);
    // the frames 0 and 1, then 1 and 2 after the restore
    assert_eq!(
        counts(&folder.path().join("rl-video-episode-0.gif")),
        [0, 1, 2]
    );
}
