//! Tests of what `run` prints, lists and plots.

use serde_json::Value as Json;

use super::{folder, json, prints, xtask};

#[test]
fn run_writes_episodes() {
    let run = |name: &str, seeds: &str| {
        let file = folder(name).join("episodes.json");
        let path = file.to_str().unwrap();
        let kwargs = r#"{"g": 9.81}"#;
        prints(&[
            "run",
            "Pendulum-v1",
            "--seeds",
            seeds,
            "--kwargs",
            kwargs,
            "--json",
            path,
        ]);
        json(&file)
    };
    let episodes = run("run", "3..5");
    let episodes = episodes.as_array().expect("a list");
    assert_eq!(episodes.len(), 2);
    assert_eq!(episodes[0]["seed"], 3);
    assert_eq!(episodes[0]["length"], 200);
    assert_eq!(
        (&episodes[0]["terminated"], &episodes[0]["truncated"]),
        (&false.into(), &true.into())
    );
    let [sum, last] = ["return", "last_reward"].map(|name| episodes[0][name].as_f64().unwrap());
    assert!(
        sum < last && last < 0.0,
        "every reward is a cost: {sum}, {last}"
    );
    assert_eq!(episodes[0]["last_observation"].as_array().unwrap().len(), 3);
    assert_eq!(
        run("run-again", "4..5")[0],
        episodes[1],
        "an episode depends on its seed alone"
    );
}

#[test]
fn run_refuses_names_before_it_plays() {
    let out = folder("run-names");
    let [bmp, svg, detour] = ["a.bmp", "a.svg", "../run-names/a.svg"]
        .map(|name| out.join(name).to_str().unwrap().to_owned());
    for (options, message) in [
        (&["--plot", &bmp][..], "the extensions are .svg and .png"),
        (&["--plot", &svg, "--json", &svg], "name one file"),
        (&["--plot", &svg, "--json", &detour], "name one file"),
    ] {
        let output = xtask(&[&["run", "CartPole-v1"], options].concat());
        assert!(
            !output.status.success() && output.stdout.is_empty(),
            "{options:?}: it plays first"
        );
        assert!(
            String::from_utf8_lossy(&output.stderr).contains(message),
            "{options:?}"
        );
    }
    assert_eq!(std::fs::read_dir(&out).unwrap().count(), 0);
}

/// Results can go to the standard output, which is not replaced like a file.
#[cfg(target_os = "linux")]
#[test]
fn json_goes_to_the_standard_output() {
    let text = prints(&[
        "run",
        "CartPole-v1",
        "--seeds",
        "0..1",
        "--json",
        "/dev/stdout",
    ]);
    let (table, json) = text.split_at(text.find("[{").expect("a list"));
    assert!(table.starts_with("    seed"), "{table}");
    let episodes: Json = serde_json::from_str(json).expect("JSON");
    assert_eq!(episodes[0]["seed"], 0);
}

#[test]
fn a_plot_has_the_format_of_its_name() {
    let out = folder("run-plots");
    for (name, begins) in [("a.svg", &b"<svg"[..]), ("a.png", b"\x89PNG\r\n")] {
        let file = out.join(name);
        prints(&[
            "run",
            "CartPole-v1",
            "--seeds",
            "0..2",
            "--plot",
            file.to_str().unwrap(),
        ]);
        let bytes = std::fs::read(&file).expect("the plot");
        assert!(
            bytes.starts_with(begins),
            "{name}: {:?}",
            &bytes[..bytes.len().min(40)]
        );
    }
}

#[test]
fn a_list_has_the_episodes_of_every_policy() {
    let out = folder("run-policies");
    let [plot, list] = ["a.svg", "a.json"].map(|name| out.join(name));
    let arguments = "run MountainCar-v0 --policy random,good --seeds 0..2 --plot";
    let mut arguments: Vec<_> = arguments.split_whitespace().collect();
    arguments.extend([plot.to_str().unwrap(), "--json", list.to_str().unwrap()]);
    prints(&arguments);
    let list = std::fs::read_to_string(list).expect("the list");
    let episodes: Vec<Json> = serde_json::from_str(&list).expect("JSON");
    let seeds: Vec<_> = episodes.iter().map(|episode| &episode["seed"]).collect();
    assert_eq!(seeds, [0, 1, 0, 1]);
    let lengths: Vec<_> = episodes.iter().map(|episode| &episode["length"]).collect();
    assert!(
        lengths[..2] == [200, 200] && lengths[2..] != [200, 200],
        "{lengths:?}"
    );
    assert!(plot.exists());
}
