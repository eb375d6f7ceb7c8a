//! What types show of themselves in `Debug`.

use std::fmt::{Debug, Write};
use std::path::Path;

use gym::registry::find;
use gym::render::{Frame, RecordVectorVideo, RecordVideo, RenderMode};
use gym::toytext::Blackjack;
use gym::toytext::blackjack::BlackjackDynamics;
use gym::vector::native::NativeVectorEnv;
use gym::vector::{AsyncVectorEnv, Autoreset, SyncVectorEnv};
use gym::wrappers::{Render, TransformAction, TransformObservation, TransformReward};
use gym::{BoxEnv, Continuous, RandomState, Task, Value, VectorEnv};
use gym_testing::{Count, kept};

#[test]
fn types_show_their_names_and_parts() {
    let mut told = String::new();
    let folder = tempfile::tempdir().unwrap();
    let mut tell = |shown: &dyn Debug| {
        let shown = format!("{shown:?}").replace(&*folder.path().to_string_lossy(), "FOLDER");
        writeln!(told, "{shown}").unwrap();
    };
    let count = Count::default;
    tell(&Frame::new(3, 2).unwrap());
    tell(&Continuous::from([0.1_f32]));
    tell(&Continuous::from([0.1_f64]));
    tell(&RandomState::new(0));
    tell(&find("Taxi-v4").unwrap());
    tell(&BoxEnv::new(count()));
    tell(&Render::new(count(), RenderMode::Ansi).unwrap());
    tell(&TransformReward::new(count(), |reward| reward));
    tell(&TransformAction::new(count(), |action: &i64| *action, None));
    tell(&TransformObservation::new(
        count(),
        |seen: &i64| *seen,
        None,
    ));
    let blackjack = || BlackjackDynamics::new(Default::default()).unwrap();
    tell(&Blackjack::new(Default::default()).unwrap());
    tell(&NativeVectorEnv::new(blackjack(), 2, None, Autoreset::SameStep).unwrap());
    tell(&SyncVectorEnv::new([count(), count()]).unwrap());
    tell(&AsyncVectorEnv::new([count(), count()]).unwrap());
    let boxed: Box<dyn VectorEnv> = Box::new(SyncVectorEnv::new([count()]).unwrap());
    tell(&boxed);
    let drawn = || {
        Render::new(
            Blackjack::new(Default::default()).unwrap(),
            RenderMode::RgbArray,
        )
    };
    tell(&RecordVideo::new(drawn().unwrap(), folder.path()).unwrap());
    let envs = SyncVectorEnv::new([drawn().unwrap()]).unwrap();
    tell(&RecordVectorVideo::new(envs, folder.path()).unwrap());
    tell(&Value::from([0.5, 1.5]));
    kept(
        &Path::new(env!("CARGO_MANIFEST_DIR")).join("shown.txt"),
        &told,
    );
}
