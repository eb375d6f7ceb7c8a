//! Tests of the pictures and films that `gif` and `mjcf` write.

use std::path::Path;

use super::{fails, folder, prints};

/// Returns the size of a PNG file, and the seconds that its frames are shown. (Equal frames are one.)
fn png(path: &Path) -> ([u32; 2], f64) {
    let bytes = std::fs::read(path).expect("the file");
    let starts = |chunk: &'static [u8]| {
        let fours = bytes.windows(4).enumerate();
        fours
            .filter(move |(_, four)| *four == chunk)
            .map(|(at, _)| at + 4)
    };
    let number = |at: usize| u32::from_be_bytes(bytes[at..at + 4].try_into().unwrap());
    let head = starts(b"IHDR").next().expect("a head");
    // after a number, a size and a place, a frame has its delay as a fraction
    let delays = starts(b"fcTL").map(|at| {
        let [over, under] = [20, 22].map(|part| [bytes[at + part], bytes[at + part + 1]]);
        f64::from(u16::from_be_bytes(over)) / f64::from(u16::from_be_bytes(under))
    });
    ([number(head), number(head + 4)], delays.sum())
}

/// Returns the number of frames that a command says it wrote to `path`, and checks it: they are shown
/// for `fps` to a second.
fn frames(said: &str, path: &Path, fps: f64) -> u32 {
    let told = format!("{}: ", path.display());
    let last = said.lines().last().unwrap();
    let frames = last
        .strip_prefix(&told)
        .and_then(|rest| rest.strip_suffix(" frames"));
    let frames = frames.and_then(|frames| frames.parse().ok()).expect(said);
    let shown = png(path).1;
    assert!(
        (shown * fps - f64::from(frames)).abs() < 0.1,
        "{frames} frames for {shown} s"
    );
    frames
}

#[test]
fn a_recording_ends_with_its_episode_or_the_frames_asked_for() {
    let file = folder("gif-frames").join("a.png");
    let path = file.to_str().unwrap();
    let of = |id: &str, options: &[&str], fps| {
        let said = prints(&[&["gif", id, "--out", path], options].concat());
        frames(&said, &file, fps)
    };
    for most in [1, 2, 7] {
        let options = ["--max-frames", &most.to_string()];
        assert_eq!(of("CartPole-v1", &options, 50.0), most);
        assert_eq!(png(&file).0, [600, 400]);
    }
    // a frame after the reset and after each step
    let table = prints(&["run", "CartPole-v1", "--policy=random", "--seeds=5..6"]);
    let row = table.lines().nth(1).expect("a row");
    let length: u32 = row.split_whitespace().nth(2).unwrap().parse().expect(row);
    assert_eq!(of("CartPole-v1", &["--seed=5"], 50.0), length + 1);
    // environments without a limit end too
    assert_eq!(of("CliffWalking-v1", &["--max-frames=3"], 4.0), 3);
}

const BALL: &str = r#"<mujoco><option timestep="TIMESTEP"/><worldbody><light pos="0 0 3"/>
    <geom type="plane" size="1 1 1" rgba="0.2 0.6 0.2 1"/><camera name="above" pos="0 0 3"/>
    <body pos="0.3 0 0.5"><freejoint/><geom size="0.2" rgba="0.8 0.1 0.1 1"/></body></worldbody>
    <keyframe><key name="high" qpos="0.3 0 1 1 0 0 0"/></keyframe></mujoco>"#;

#[test]
fn a_film_is_in_the_time_of_its_model() {
    let out = folder("mjcf-films");
    let [model, film] = ["ball.xml", "film.apng"].map(|name| out.join(name));
    let [model_path, path] = [&model, &film].map(|path| path.to_str().unwrap());
    // 25 frames per second: a frame at the state that is nearest to its time
    for (timestep, steps, frames) in [
        ("0.01", "100", 26), // the first state, and each fourth step
        ("0.01", "3", 1),
        ("0.002", "19", 1),
        ("0.002", "20", 2),
        ("0.03", "1", 2),  // 0.03 s is nearer to 0.04 s than the next state
        ("0.03", "4", 4),  // 0, 0.03, 0.09 and 0.12 s for 0, 0.04, 0.08 and 0.12 s
        ("0.1", "10", 11), // each state
    ] {
        std::fs::write(&model, BALL.replace("TIMESTEP", timestep)).unwrap();
        let said = prints(&[
            "mjcf",
            model_path,
            "--steps",
            steps,
            "--size=32x24",
            "--out",
            path,
        ]);
        assert!(said.starts_with(&format!("{steps} steps in ")), "{said}");
        let written = self::frames(&said, &film, 25.0);
        assert_eq!(written, frames, "{timestep} s, {steps} steps");
        assert_eq!(png(&film).0, [32, 24]);
    }
    let error = fails(&["mjcf", model_path, "--out", path]);
    assert!(
        error.contains("a film needs steps") && error.contains("--steps"),
        "{error}"
    );
}

#[test]
fn a_picture_shows_the_last_state_from_the_camera_asked_for() {
    let out = folder("mjcf-pictures");
    let model = out.join("ball.xml");
    std::fs::write(&model, BALL.replace("TIMESTEP", "0.002")).unwrap();
    let picture = |name: &str, options: &str| {
        let file = out.join(format!("{name}.png"));
        let mut arguments = vec![
            "mjcf",
            model.to_str().unwrap(),
            "--out",
            file.to_str().unwrap(),
        ];
        arguments.extend(options.split_whitespace());
        let said = prints(&arguments);
        let (size, shown) = png(&file);
        let end = format!("{}: {}x{} pixels\n", file.display(), size[0], size[1]);
        assert!(said.ends_with(&end) && shown == 0.0, "{said}");
        (size, std::fs::read(&file).unwrap())
    };
    let plain = picture("plain", "");
    assert_eq!(plain.0, [480, 360]);
    assert_eq!(picture("size", "--size 200x100").0, [200, 100]);
    // what is said by default
    let same = "--azimuth 120 --elevation -20";
    assert!(picture("same", same) == plain, "{same}");
    assert!(picture("turned", "--azimuth 480") == plain, "a whole turn");
    let mut seen = vec![plain];
    for options in [
        "--azimuth 90",
        "--elevation -60",
        "--distance 2",
        "--distance 8",
        "--camera above",
        "--keyframe high",
        "--steps 60",
    ] {
        let other = picture("other", options);
        assert!(!seen.contains(&other), "{options} changes nothing");
        seen.push(other);
    }
    let path = model.to_str().unwrap();
    let to = out.join("no.png");
    let to = to.to_str().unwrap();
    for (options, part) in [
        (["--camera", "behind"], "behind"),
        (["--keyframe", "low"], "low"),
        (["--size", "0x10"], "a size is such as 480x360"),
        (["--size", "10x8193"], "of at most 8192x8192"),
        (["--size", "10"], "a size is such as 480x360"),
    ] {
        let error = fails(&["mjcf", path, "--out", to, options[0], options[1]]);
        assert!(error.contains(part), "{options:?}: {error}");
    }
    assert!(!out.join("no.png").exists());
}
