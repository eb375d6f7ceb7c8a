use gym_core::{BoxEnv, Env, EnvExt, Registration, registry};

/// Compares what a package has registered with a kept file, a line for each id: checksums of its spec, of
/// its page, of its arguments with their defaults, and of what the environment that `make` makes says of
/// itself: spaces, metadata, names, keys, and the depths of the first picture, if it has any.
///
/// After an intended change, `GYM_UPDATE_FACTS=1` writes the file `path`.
///
/// # Panics
/// If a line differs; the message has all such lines.
pub fn facts(
    package: &str,
    kept: &str,
    path: &str,
    make: impl Fn(&Registration) -> Option<BoxEnv>,
) {
    let all = registry::all();
    let own = all.iter().filter(|one| one.source.package == package);
    let found: Vec<String> = own.map(|one| line(one, make(one))).collect();
    if std::env::var_os("GYM_UPDATE_FACTS").is_some() {
        std::fs::write(path, found.join("\n") + "\n").expect("the file can be written");
    }
    let kept: Vec<&str> = kept.lines().collect();
    let unlike: Vec<&str> = (found.iter().map(String::as_str))
        .filter(|line| !kept.contains(line))
        .collect();
    assert!(
        unlike.is_empty(),
        "not as in {path}:\n{}",
        unlike.join("\n")
    );
    assert_eq!(found.len(), kept.len(), "{package}");
}

fn line(one: &Registration, made: Option<BoxEnv>) -> String {
    let sum = |text: String| format!("{:08x}", crc32fast::hash(text.as_bytes()));
    let spec = one.spec().expect("a spec");
    let spec = sum(serde_json::to_string(&spec).expect("a spec is JSON"));
    let page = sum(format!(
        "{} {:?} {:?} {:?} {:?} {:?} {:?} {}",
        one.description,
        one.reset_options,
        one.exceptions,
        one.needs.map(|need| need.what),
        one.page.clip,
        one.page.actions,
        one.page.policy.map(|policy| policy.description),
        one.light_step,
    ));
    let arguments = one.arguments().expect("arguments");
    let arguments = arguments.iter().map(|argument| {
        format!(
            "{} {} {} {} {} {};",
            argument.name,
            argument.kind,
            argument.unit,
            argument.versions,
            argument.default,
            argument.required
        )
    });
    let arguments = sum(arguments.collect());
    let made = made.map_or_else(|| "none".to_owned(), |env| sum(says(one, env)));
    format!(
        "{} spec {spec} page {page} arguments {arguments} made {made}",
        one.id()
    )
}

/// What an environment says of itself.
fn says(one: &Registration, mut env: BoxEnv) -> String {
    env.reset(1).expect("an episode starts");
    let depths: Vec<u32> = env
        .depth((32, 24))
        .into_iter()
        .flatten()
        .map(f32::to_bits)
        .collect();
    format!(
        "{} {} {} {:?} {:?} {:?} {depths:?}",
        env.describe(),
        env.observation_space(),
        env.action_space(),
        env.metadata(),
        one.page.names.map(|names| names(&env)),
        one.page.keys.map(|keys| keys(&env)),
    )
}
