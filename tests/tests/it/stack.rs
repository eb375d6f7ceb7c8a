//! Environments fit on small stacks. A Rust thread has 2 MiB, and a user's build without
//! optimisation moves values through the stack. Weekly, this test runs without optimisation and with
//! `GYM_STACK`, the number of bytes, of a quarter of that; each change runs it with a little
//! optimisation, on a smaller stack.

use std::sync::Mutex;
use std::thread;

use gym::render::RenderMode;
use gym::{Env, EnvExt, Reset, Result, registry};

/// Returns the stack's size in bytes.
fn stack() -> usize {
    std::env::var("GYM_STACK").map_or(256 << 10, |bytes| bytes.parse().expect("a number"))
}

/// Uses an environment as a program would.
fn use_all(id: &str) -> Result<()> {
    let mut env = gym::builder(id)
        .render_mode(RenderMode::RgbArray)
        .build()
        .or_else(|_| gym::make(id))?;
    env.reset(0)?;
    let mut actions = env.action_sampler(0)?;
    env.step(&actions.sample())?;
    let mut clone = env.clone();
    clone.restore(&env.snapshot()?)?;
    clone.step(&actions.sample())?;
    if env.render_mode().is_some() {
        env.render()?;
    }
    drop((env, clone));
    gym::make(id)?.reset(Reset::default()).map(drop)
}

/// A stack overflow aborts the process, so the next test runs this test in a separate process.
#[test]
#[ignore = "run by every_environment_fits_a_small_stack"]
fn in_a_small_stack() {
    let waiting = Mutex::new(registry::self_contained().into_iter());
    let next = || waiting.lock().expect("no panic").next();
    let work = || {
        while let Some(registration) = next() {
            let id = registration.id();
            println!("{id}");
            use_all(id).expect("no error");
        }
    };
    thread::scope(|scope| {
        for _ in 0..thread::available_parallelism().map_or(1, usize::from) {
            let thread = thread::Builder::new().stack_size(stack());
            thread.spawn_scoped(scope, work).expect("a thread");
        }
    });
}

#[test]
fn every_environment_fits_a_small_stack() {
    let mut this = std::process::Command::new(std::env::current_exe().expect("this program"));
    let output = this
        .args([
            "stack::in_a_small_stack",
            "--exact",
            "--ignored",
            "--nocapture",
        ])
        .output()
        .expect("it runs");
    let [text, said] =
        [output.stdout, output.stderr].map(|text| String::from_utf8_lossy(&text).into_owned());
    assert!(
        output.status.success(),
        "one of the last of these needs more stack than {} bytes: {text}\n{said}",
        stack()
    );
    assert!(text.lines().count() > 40, "all were tried: {text}");
}
