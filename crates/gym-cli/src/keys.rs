//! The keys of `cargo xtask play`.

use gym::keys::{Idle, Keys};
use gym::{BoxEnv, Env, Error, Result, Space, registry};
use serde_json::{Value as Json, json};

/// Returns the keys of an environment: the registration's keys or, if it has none and the actions
/// are discrete, the digits.
pub(crate) fn of(id: &str, env: &BoxEnv) -> Result<Keys> {
    let registered = registry::find(id)?.page.keys;
    Ok(registered.map_or_else(|| Keys::new(digits(&env.action_space())), |keys| keys(env)))
}

/// Sets the action of a key.
pub(crate) fn set(keys: &mut Keys, key: &str, action: Json) {
    keys.actions
        .retain(|(name, _)| !name.eq_ignore_ascii_case(key));
    keys.actions.push((key.to_owned(), action));
}

/// Returns an error if an action is not in `space`.
pub(crate) fn check(keys: &Keys, space: &Space) -> Result<()> {
    if keys.actions.is_empty() {
        let reason = format!("there are no default keys for {space}: add `--key NAME=ACTION`");
        return Err(Error::argument("play", reason));
    }
    let idle = match &keys.idle {
        Idle::Action(action) => Some(action),
        Idle::Wait | Idle::Repeat => None,
    };
    keys.actions
        .iter()
        .map(|(_, action)| action)
        .chain(idle)
        .try_for_each(|action| {
            let action = space.from_json(action)?;
            if space.contains(&action) {
                return Ok(());
            }
            Err(Error::argument(
                "play",
                format!("a key has the action {action}, which is not in {space}"),
            ))
        })
}

/// Returns the action of the pressed keys `down`, if one of them has an action.
#[cfg_attr(
    not(any(feature = "human", test)),
    expect(dead_code, reason = "for windows")
)]
pub(crate) fn action(keys: &Keys, down: &[String]) -> Option<Json> {
    let is_down = |name: &str| down.iter().any(|key| key.eq_ignore_ascii_case(name));
    let mut actions = keys
        .actions
        .iter()
        .filter(|(name, _)| is_down(name))
        .map(|(_, action)| action);
    let first = actions.next()?.clone();
    Some(actions.fold(first, |sum, action| add(&sum, action).unwrap_or(sum)))
}

/// Returns a description of the keys and their actions.
pub(crate) fn describe(keys: &Keys) -> String {
    let keys: Vec<_> = keys
        .actions
        .iter()
        .map(|(name, action)| format!("{name} = {action}"))
        .collect();
    keys.join(", ")
}

/// Returns the keys `0` to `9` for the first actions of a discrete space.
fn digits(space: &Space) -> Json {
    let Space::Discrete(space) = space else {
        return json!({});
    };
    (0..space.n().min(10))
        .map(|i| (i.to_string(), json!(space.start() + i)))
        .collect()
}

/// Returns the sum of two vectors of equal length; `None` for other actions.
fn add(a: &Json, b: &Json) -> Option<Json> {
    let (a, b) = (a.as_array()?, b.as_array()?);
    if a.len() != b.len() {
        return None;
    }
    let sum = a
        .iter()
        .zip(b)
        .map(|(a, b)| Some(json!(a.as_f64()? + b.as_f64()?)));
    sum.collect::<Option<Vec<_>>>().map(Json::Array)
}

#[cfg(test)]
mod tests {
    use gym::spaces::Discrete;

    use super::*;

    #[test]
    fn every_registered_key_has_an_action_of_the_space() {
        let mut played = 0;
        for registration in gym::registry::self_contained() {
            let env = gym::make(registration.id()).unwrap();
            if registration.page.keys.is_some() {
                check(&of(registration.id(), &env).unwrap(), &env.action_space()).unwrap();
                played += 1;
            }
        }
        assert!(played > 20, "only {played} have keys");
    }

    #[test]
    fn keys_choose_actions() {
        let of = |id: &str| of(id, &gym::make(id).unwrap()).unwrap();
        let down = |keys: &[&str]| keys.iter().map(|&key| key.to_owned()).collect::<Vec<_>>();
        let racing = of("CarRacing-v3");
        assert_eq!(
            action(&racing, &down(&["Left", "Up", "Q"])),
            Some(json!([-1.0, 1.0, 0.0]))
        );
        assert_eq!(action(&racing, &down(&["Q"])), None);
        let mut lake = of("FrozenLake-v1");
        assert_eq!(action(&lake, &down(&["Right"])), Some(json!(2)));
        set(&mut lake, "right", json!(9));
        assert_eq!(action(&lake, &down(&["Right"])), Some(json!(9)));
        assert!(check(&lake, &Space::discrete(4)).is_err());
        let error = check(&Keys::new(json!({})), &Space::discrete(4))
            .unwrap_err()
            .to_string();
        assert!(
            error.contains("there are no default keys for Discrete(4): add `--key NAME=ACTION`"),
            "{error}"
        );
        let digits = Keys::new(digits(&Space::discrete(3)));
        assert_eq!(action(&digits, &down(&["2"])), Some(json!(2)));
    }

    /// Actions of pressed keys are added if they are vectors of equal length. Otherwise the first
    /// action counts.
    #[test]
    fn actions_that_cannot_be_added_leave_the_first() {
        let actions = json!({"a": [1.0, 0.0], "b": [0.5, -1.0], "c": [1.0], "d": 3, "e": ["x", 0]});
        let keys = Keys::new(actions);
        for (pressed, expected) in [
            (["a", "b"], json!([1.5, -1.0])),
            (["a", "c"], json!([1.0, 0.0])),
            (["b", "c"], json!([0.5, -1.0])),
            (["c", "d"], json!([1.0])),
            (["d", "e"], json!(3)),
            (["a", "e"], json!([1.0, 0.0])),
        ] {
            let pressed = pressed.map(str::to_owned);
            assert_eq!(action(&keys, &pressed), Some(expected), "{pressed:?}");
        }
    }

    /// The digit 0 is the first action of the space.
    #[test]
    fn digits_begin_at_the_first_action() {
        let of = |n: i64, start: i64| {
            let space = Discrete::new(n).unwrap().with_start(start).unwrap();
            digits(&space.into())
        };
        assert_eq!(of(3, 0), json!({"0": 0, "1": 1, "2": 2}));
        assert_eq!(of(3, -1), json!({"0": -1, "1": 0, "2": 1}));
        assert_eq!(of(10, 5), of(99, 5));
        assert_eq!(of(99, 5)["9"], 14);
        assert_eq!(digits(&Space::boxed([0.0], [1.0])), json!({}));
    }

    #[test]
    fn the_action_without_a_key_is_checked_too() {
        let keys = |idle| Keys {
            idle,
            ..Keys::new(json!({"A": 1}))
        };
        let space = Space::discrete(3);
        for idle in [Idle::Wait, Idle::Repeat, Idle::Action(json!(2))] {
            check(&keys(idle), &space).unwrap();
        }
        let error = check(&keys(Idle::Action(json!(3))), &space).unwrap_err();
        let words = "a key has the action 3, which is not in Discrete(3)";
        assert!(error.to_string().contains(words), "{error}");
    }

    #[test]
    fn descriptions_have_every_key_in_its_order() {
        let keys = Keys::new(json!({"Left": 0, "Right": [1.5]}));
        assert_eq!(describe(&keys), "Left = 0, Right = [1.5]");
    }
}
