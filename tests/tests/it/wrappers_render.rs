//! Wrappers of rendered frames.

use gym::render::{Frame, RenderMode, Rendered};
use gym::wrappers::{AddRenderObservation, AddWhiteNoise, ObstructView, add_render_observation};
use gym::{
    Array, DType, Data, Env, EnvExt, Generator, Outcome, Reset, Result, Snapshot, Space, Value,
    VectorEnv, VectorEnvExt, Wrap, spaces::BoxSpace,
};

/// An environment that observes a frame, and renders another of one colour.
#[derive(Clone)]
struct Picture(Option<Generator>);

impl Env for Picture {
    type Observation = Array;
    type Action = i64;

    fn observation_space(&self) -> Space {
        BoxSpace::uniform(0.0, 255.0, [4, 6, 3], DType::U8)
            .expect("bounds")
            .into()
    }

    fn action_space(&self) -> Space {
        Space::discrete(2)
    }

    fn reset_into(&mut self, reset: &Reset, observation: &mut Array) -> Result<()> {
        self.0 = reset.seed.as_ref().map(Generator::new);
        *observation = Array::new(
            [4, 6, 3],
            Data::U8((0..72).map(|i| (i * 3) as u8).collect()),
        )?;
        Ok(())
    }

    fn step_into(&mut self, _action: &i64, _observation: &mut Array) -> Result<Outcome> {
        Ok(Outcome::default())
    }

    fn render_into(&mut self, rendered: &mut Rendered) -> Result<()> {
        let mut frame = Frame::new(5, 4).unwrap();
        frame.pixels_mut().fill(9);
        *rendered = Rendered::Frame(frame);
        Ok(())
    }

    fn generator(&mut self) -> Option<&mut Generator> {
        self.0.as_mut()
    }

    fn snapshot(&self) -> Result<Snapshot> {
        Snapshot::of(&self.0)
    }

    fn restore(&mut self, snapshot: &Snapshot) -> Result<()> {
        snapshot.get().map(|rng| self.0 = rng)
    }
}

/// Returns the pixels that differ from the frame's colour, and the next number of the generator.
fn noise<E: Env>(mut env: E) -> (Vec<u8>, i64) {
    assert!(
        env.render().is_err(),
        "there is no generator before the first reset"
    );
    env.reset(5).unwrap();
    let frame = env.render().unwrap().into_frame().unwrap();
    let noise = frame
        .pixels()
        .chunks(3)
        .filter(|pixel| *pixel != [9; 3])
        .flatten()
        .copied()
        .collect();
    (noise, env.generator().unwrap().integers(0, 1000))
}

/// Recorded from Gymnasium 1.4.0 with the same seed and frame.
#[test]
fn noise_is_gymnasiums() {
    let (pixels, next) = noise(AddWhiteNoise::new(Picture(None), 0.5).unwrap());
    assert_eq!(
        pixels[..12],
        [167, 228, 183, 152, 203, 4, 36, 52, 212, 117, 3, 86]
    );
    assert_eq!((&pixels[24..], next), (&[144, 103, 205][..], 45));
    let (pixels, next) = noise(AddWhiteNoise::new(Picture(None), (0.3, true)).unwrap());
    let grey: Vec<u8> = pixels.chunks(3).map(|pixel| pixel[0]).collect();
    assert_eq!((grey, next), (vec![174, 159, 150, 147, 122, 60], 652));
    let (pixels, next) = noise(ObstructView::new(Picture(None), (0.5, 2)).unwrap());
    assert_eq!(pixels[..9], [70, 41, 72, 236, 15, 193, 205, 12, 142]);
    assert_eq!((&pixels[21..], next), (&[205, 52, 140][..], 148));
}

/// A patch at the edge covers its part inside of the frame.
#[test]
fn a_patch_lies_anywhere_on_the_picture() {
    let mut corners = 0;
    for seed in 0..40 {
        // one patch of 3 by 3 pixels
        let mut env = ObstructView::new(Picture(None), (0.5, 3)).unwrap();
        env.reset(seed).unwrap();
        let frame = env.render().unwrap().into_frame().unwrap();
        let covered: Vec<bool> = frame
            .pixels()
            .chunks(3)
            .map(|pixel| pixel != [9; 3])
            .collect();
        let count = covered.iter().filter(|is| **is).count();
        assert!([4, 6, 9].contains(&count), "seed {seed}: {count}");
        corners += u32::from(covered[0]);
    }
    assert!(corners > 0, "none covers the corner");
}

/// The observation is the frame after each reset and step.
#[test]
fn pictures_are_observed_as_they_are_rendered() {
    let made = gym::builder("CartPole-v1")
        .render_mode(RenderMode::RgbArray)
        .build()
        .unwrap();
    let mut env = made.add_render_observation().unwrap();
    let start = env.reset(0).unwrap();
    let mut seen = Value::Null;
    for _ in 0..5 {
        seen = env.step(&Value::Int(0)).unwrap().observation;
        let frame = env.render().unwrap().into_frame().unwrap();
        assert!(seen.as_array().unwrap().as_slice::<u8>().unwrap() == frame.pixels());
    }
    assert!(seen != start, "the cart is seen to move");
}

#[test]
fn pictures_turn_grey_and_small() {
    let env = Picture(None).grayscale_observation(false).unwrap();
    assert_eq!(
        env.observation_space().to_string(),
        "Box(0, 255, (4, 6), uint8)"
    );
    let mut env = env.resize_observation([2, 3]).unwrap();
    assert_eq!(
        env.observation_space().to_string(),
        "Box(0, 255, (2, 3), uint8)"
    );
    let observation = env.reset(0).unwrap();
    assert!(env.observation_space().contains(&observation));
    let mut env = Picture(None).grayscale_observation(true).unwrap();
    let first = [
        0.2125 * 0.0 + 0.7154 * 3.0 + 0.0721 * 6.0,
        0.2125 * 9.0 + 0.7154 * 12.0 + 0.0721 * 15.0,
    ];
    let observation = env.reset(0).unwrap();
    assert_eq!(
        observation.as_slice::<u8>().unwrap()[..2],
        first.map(|x: f64| x as u8)
    );
    assert_eq!(observation.as_array().unwrap().shape(), [4, 6, 1]);
}

#[test]
fn rendered_pictures_are_observed() {
    let make = || {
        let builder = gym::builder("CartPole-v1")
            .render_mode(RenderMode::RgbArray)
            .render_size(60, 40);
        builder.build().unwrap()
    };
    let with_state = |render_key: &str, obs_key: &str| add_render_observation::Config {
        render_only: false,
        render_key: render_key.into(),
        obs_key: obs_key.into(),
    };
    let mut env = make().add_render_observation().unwrap();
    assert_eq!(
        env.observation_space().to_string(),
        "Box(0, 255, (40, 60, 3), uint8)"
    );
    let observation = env.reset(0).unwrap();
    let frame = env.render().unwrap().into_frame().unwrap();
    assert_eq!(observation.as_slice::<u8>().unwrap(), frame.pixels());

    let mut env = AddRenderObservation::new(make(), with_state("pixels", "state")).unwrap();
    let observation = env.reset(0).unwrap();
    env.observation_space().check(&observation).unwrap();
    assert_eq!(observation.get("state"), Some(&make().reset(0).unwrap()));
    let spec = env.spec().unwrap();
    assert_eq!(spec.make().unwrap().spec(), Some(spec));
    assert!(AddRenderObservation::new(make(), with_state("x", "x")).is_err());
    assert!(
        gym::make("CartPole-v1")
            .unwrap()
            .add_render_observation()
            .is_err(),
        "no render mode"
    );

    let mut noisy = make()
        .add_white_noise(0.5)
        .unwrap()
        .add_render_observation()
        .unwrap();
    assert_ne!(
        noisy.reset(0).unwrap().as_slice::<u8>().unwrap(),
        frame.pixels()
    );
}

#[test]
fn a_vector_is_recorded_as_a_grid() {
    use gym::render::RecordVectorVideo;
    use gym::vector::{Autoreset, VectorReset};
    let folder = std::env::temp_dir().join(format!("gym-vector-video-{}", std::process::id()));
    for (autoreset, expected) in [
        (Autoreset::NextStep, ["episode-0", "episode-2"]),
        (Autoreset::SameStep, ["episode-0", "episode-2"]),
        (Autoreset::Disabled, ["episode-0", "episode-2"]),
    ] {
        let vector = gym::builder("CartPole-v1")
            .max_episode_steps(4)
            .render_mode(RenderMode::RgbArray);
        let envs = vector
            .render_size(60, 40)
            .vector(6)
            .autoreset(autoreset)
            .build()
            .unwrap();
        let mut envs = RecordVectorVideo::new(envs, &folder)
            .unwrap()
            .episode_trigger(|episode| episode % 2 == 0);
        let push = Value::Array([1i64, 0, 1, 0, 1, 0].into());
        let mut columns = envs.reset(0).unwrap();
        for _ in 0..14 {
            envs.step_into(&push, &mut columns).unwrap();
            if autoreset == Autoreset::Disabled && columns.done(0) {
                envs.reset_into(&VectorReset::default().mask([true; 6]), &mut columns)
                    .unwrap();
            }
        }
        envs.close();
        assert!(envs.take_error().is_none());
        let mut names: Vec<_> = std::fs::read_dir(&folder)
            .unwrap()
            .map(|entry| entry.unwrap().path())
            .collect();
        names.sort();
        let expected = expected.map(|name| folder.join(format!("rl-video-{name}.gif")));
        assert_eq!(names, expected, "{autoreset:?}");
        for name in names {
            let gif = std::fs::read(name).unwrap();
            // three columns and two rows, in the header of the GIF
            assert_eq!(gif[6..10], [180, 0, 80, 0]);
        }
        std::fs::remove_dir_all(&folder).unwrap();
    }
}

#[test]
fn a_refused_step_is_not_filmed() {
    use gym::render::RecordVectorVideo;
    let folder = std::env::temp_dir().join(format!("gym-refused-video-{}", std::process::id()));
    let film = |refused: usize| {
        let vector = gym::builder("CartPole-v1")
            .max_episode_steps(4)
            .render_mode(RenderMode::RgbArray);
        let envs = vector.render_size(60, 40).vector(2).build().unwrap();
        let mut envs = RecordVectorVideo::new(envs, &folder)
            .unwrap()
            .step_trigger(|step| step == 1);
        let mut columns = envs.reset(0).unwrap();
        for _ in 0..3 {
            for _ in 0..refused {
                envs.step_into(&Value::Array([7i64, 7].into()), &mut columns)
                    .unwrap_err();
            }
            envs.step_into(&Value::Array([1i64, 0].into()), &mut columns)
                .unwrap();
        }
        envs.close();
        let gif = std::fs::read(folder.join("rl-video-step-1.gif")).unwrap();
        std::fs::remove_dir_all(&folder).unwrap();
        gif
    };
    assert!(film(0) == film(2));
}

#[test]
fn a_picture_drawn_over_another_is_a_new_one() {
    use gym::wrappers::{Render, RenderCollection};
    /// An environment that draws a square without a background.
    #[derive(Clone)]
    struct Square(Picture);

    impl gym::Wrapper for Square {
        type Inner = Picture;
        type Observation = Array;
        type Action = i64;

        fn inner(&self) -> &Picture {
            &self.0
        }

        fn inner_mut(&mut self) -> &mut Picture {
            &mut self.0
        }

        fn on_metadata(&self) -> gym::render::Metadata {
            gym::render::Metadata::drawn(10, (4, 4))
        }

        fn on_draw(&self, canvas: &mut dyn gym::canvas::Canvas) {
            canvas.rect([1.0, 1.0], [2.0, 2.0], gym::canvas::Color::WHITE);
        }

        fn on_reset(&mut self, reset: &Reset, observation: &mut Array) -> Result<()> {
            self.0.reset_into(reset, observation)
        }

        fn on_step(&mut self, action: &i64, observation: &mut Array) -> Result<Outcome> {
            self.0.step_into(action, observation)
        }
    }

    let mut env = Render::new(Square(Picture(None)), RenderMode::RgbArray).unwrap();
    let fresh = env.render().unwrap();
    let mut used = Frame::new(4, 4).unwrap();
    used.pixels_mut().fill(99);
    for other in [used, Frame::new(3, 2).unwrap()] {
        let mut rendered = Rendered::Frame(other);
        env.render_into(&mut rendered).unwrap();
        assert_eq!(rendered, fresh);
    }

    let mut list = gym::BoxEnv::new(RenderCollection::new(env));
    list.reset(0).unwrap();
    let mut rendered = fresh.clone();
    list.render_into(&mut rendered).unwrap();
    assert_eq!(
        rendered,
        Rendered::Frames(vec![fresh.into_frame().unwrap()])
    );
}

#[test]
fn depths_are_of_the_picture_and_in_metres() {
    let made = |mode| {
        let hopper = gym::builder("Hopper-v5")
            .render_mode(mode)
            .render_size(64, 48);
        let mut env = hopper.build().unwrap();
        env.reset(1).unwrap();
        env
    };
    let depth = made(RenderMode::DepthArray).render().unwrap();
    let depth = depth.into_depth().unwrap();
    assert_eq!(
        (depth.width, depth.height, depth.metres.len()),
        (64, 48, 64 * 48)
    );
    // the robot is in the middle, and the camera 3.4 m from the robot
    let middle = depth.metres[24 * 64 + 32];
    assert!((3.0..3.4).contains(&middle), "{middle}");
    assert!(depth.metres.iter().all(|metres| *metres > 1.0));
    let mut env = made(RenderMode::RgbdTuple);
    let Rendered::Rgbd(frame, again) = env.render().unwrap() else {
        panic!("a frame with its depths");
    };
    assert_eq!(again, depth);
    let seen = made(RenderMode::RgbArray).render().unwrap();
    assert_eq!(Some(frame), seen.into_frame());
    // only MuJoCo tasks render depths
    let refused = gym::builder("CartPole-v1")
        .render_mode(RenderMode::DepthArray)
        .build();
    let error = refused.err().unwrap().to_string();
    assert!(error.contains("its modes are human, rgb_array"), "{error}");
}
