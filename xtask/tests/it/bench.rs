//! Tests of `cargo xtask bench`.

use super::{fails, folder, json, prints, program, said};

#[test]
fn seconds_of_a_benchmark_are_a_time() {
    for seconds in ["1e300", "nan", "inf", "-1", "x"] {
        let error = fails(&[
            "bench",
            "CartPole-v1",
            "--kind",
            "make",
            "--seconds",
            seconds,
        ]);
        assert!(
            error.contains("seconds are a number from 0 to"),
            "{seconds}: {error}"
        );
    }
    let of_cartpole = ["bench", "CartPole-v1", "--kind", "make", "--seconds", "0"];
    assert!(!prints(&of_cartpole).contains("GIF"));
    assert!(
        prints(&[&of_cartpole[..], &["--gif"]].concat())
            .contains("a GIF of 500 frames of CartPole-v1")
    );
}

/// Of two ids, kinds or sizes one would be left out.
#[test]
fn steps_alone_are_of_one_environment() {
    let one = ["bench", "CartPole-v1", "--kind", "make", "--num-envs", "1"];
    let with = |more: &[&'static str]| [&one[..], more, &["--only-steps", "1"]].concat();
    assert_eq!(prints(&with(&[])), "");
    for more in [&["Taxi-v4"][..], &["--kind", "sync"], &["--num-envs", "2"]] {
        let error = fails(&with(more));
        assert!(
            error.contains("name an id, a kind and a number, one of each"),
            "{more:?}: {error}"
        );
    }
    let without = [&one[..1], &one[2..], &["--only-steps", "1"]].concat();
    assert!(fails(&without).contains("one of each"), "no id");
}

/// Each of several ids, kinds and sizes is measured, in the order in which they are named.
#[test]
fn several_environments_are_measured_in_their_order() {
    let table = prints(&[
        "bench",
        "Taxi-v4",
        "CartPole-v1",
        "--kind",
        "sync,make",
        "--num-envs",
        "3,2",
        "--seconds",
        "0",
    ]);
    let rows = table.lines().skip(1).map(|line| {
        let words = line.split_whitespace().take(3);
        words.collect::<Vec<_>>().join(" ")
    });
    let rows: Vec<_> = rows.collect();
    let of = |id: &str| [" sync 3", " sync 2", " make 1"].map(|kind| format!("{id}{kind}"));
    assert_eq!(rows, [of("Taxi-v4"), of("CartPole-v1")].concat());
}

/// A kind that an environment lacks is left out, and the file has what the table has.
#[test]
fn the_file_of_a_benchmark_has_the_rows_of_its_table() {
    let report = folder("bench-report").join("report.json");
    let words = "bench CarRacing-v3 Taxi-v4 --kind native,make --num-envs 2 --seconds 0 --json";
    let mut arguments: Vec<_> = words.split(' ').collect();
    arguments.push(report.to_str().unwrap());
    let table = prints(&arguments);
    let rows = table.lines().skip(1);
    let rows: Vec<Vec<_>> = rows.map(|line| line.split_whitespace().collect()).collect();
    let named: Vec<_> = rows.iter().map(|row| row[..3].join(" ")).collect();
    let expected = ["CarRacing-v3 make 1", "Taxi-v4 native 2", "Taxi-v4 make 1"];
    assert_eq!(named, expected, "{table}");
    let report = json(&report);
    let cores = std::thread::available_parallelism().unwrap().get();
    assert_eq!(report["cores"], cores);
    assert!(report["gif"].is_null() && report["start"].is_null());
    let written = report["rows"].as_array().unwrap().iter().map(|row| {
        let text = |name: &str| row[name].as_str().unwrap().to_owned();
        let speed = row["per_second"].as_f64().unwrap();
        let rounded = format!("{speed:.0}");
        vec![
            text("id"),
            text("kind"),
            row["num_envs"].to_string(),
            rounded,
        ]
    });
    assert_eq!(written.collect::<Vec<_>>(), rows, "{table}");
}

/// `bench --instructions` counts what `valgrind` counts: here a program that stands in for it.
#[cfg(unix)]
#[test]
fn instructions_of_a_benchmark_are_those_of_a_step() {
    use std::os::unix::fs::PermissionsExt;

    let bin = folder("valgrind");
    // it runs the program it is given, and counts 1000 instructions, and seven for each step and
    // sub-environment
    let text = "#!/bin/sh\n\
                [ \"$1\" = --tool=callgrind ] || exit 3\n\
                shift 2\n\
                \"$@\" || exit 4\n\
                while [ $# -gt 1 ]; do\n\
                case $1 in --only-steps) steps=$2;; --num-envs) envs=$2;; --kind) kind=$2;; esac\n\
                shift\ndone\n\
                echo \"$kind $envs $steps\" >> \"$0.log\"\n\
                echo \"==1== Collected : $((1000 + 7 * steps * envs))\" >&2\n";
    let valgrind = bin.join("valgrind");
    let install = |text: &str| {
        std::fs::write(&valgrind, text).unwrap();
        std::fs::set_permissions(&valgrind, std::fs::Permissions::from_mode(0o755)).unwrap();
    };
    let report = bin.join("report.json");
    let bench = |kind: &str, paths: &str| {
        let mut program = program();
        program.args(["bench", "CartPole-v1", "--kind", kind, "--seconds", "0"]);
        program.args(["--instructions", "--num-envs", "1,300", "--json"]);
        program.arg(&report).env("PATH", paths).output().unwrap()
    };
    let paths = format!("{}:{}", bin.display(), std::env::var("PATH").unwrap());
    install(text);
    let said = said(&bench("make,sync", &paths), &["bench"]);
    let counts: Vec<&str> = said
        .lines()
        .skip(1)
        .filter_map(|line| line.split_whitespace().last())
        .collect();
    assert_eq!(counts, ["7.0", "7.0", "2100.0"], "{said}");
    let rows = json(&report)["rows"].as_array().unwrap().clone();
    let of = |row: &serde_json::Value| {
        let number = row["instructions_per_step"].as_f64().unwrap();
        (row["num_envs"].as_u64().unwrap(), number)
    };
    assert_eq!(
        rows.iter().map(of).collect::<Vec<_>>(),
        [(1, 7.0), (1, 7.0), (300, 2100.0)]
    );
    // enough steps for several episodes of each sub-environment
    let asked = std::fs::read_to_string(bin.join("valgrind.log")).unwrap();
    assert_eq!(
        asked.lines().collect::<Vec<_>>(),
        [
            "make 1 12000",
            "make 1 2000",
            "sync 1 12000",
            "sync 1 2000",
            "sync 300 18000",
            "sync 300 3000"
        ]
    );
    let told = |output: std::process::Output| {
        assert_eq!(output.status.code(), Some(1));
        String::from_utf8(output.stderr).unwrap()
    };
    install("#!/bin/sh\necho no such tool >&2\n");
    let error = told(bench("make", &paths));
    assert!(
        error.contains("valgrind gives no count: no such tool"),
        "{error}"
    );
    std::fs::remove_file(&valgrind).unwrap();
    let error = told(bench("make", bin.to_str().unwrap()));
    assert!(error.contains("valgrind: No such file"), "{error}");
    assert!(error.contains("is it installed?"), "{error}");
}
