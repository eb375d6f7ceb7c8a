//! Checks of the observation and the action space.

use crate::subject::{STEPS, Subject, tour};
use crate::verdict::{Trouble, Verdict, broken};
use gym_core::{BoxEnv, Env, Space};

/// The largest bound of an action that counts as normalised.
const NORMAL: f64 = 1.0;

/// Calls `visit` with each space and inner space, and a description of its place.
fn each(subject: &Subject<'_>, mut visit: impl FnMut(&str, &Space) -> Verdict) -> Verdict {
    let env = subject.make()?;
    within(
        "the observation space",
        &env.observation_space(),
        &mut visit,
    )?;
    within("the action space", &env.action_space(), &mut visit)
}

fn within(place: &str, space: &Space, visit: &mut dyn FnMut(&str, &Space) -> Verdict) -> Verdict {
    visit(place, space)?;
    match space {
        Space::Tuple(space) => space
            .spaces()
            .iter()
            .enumerate()
            .try_for_each(|(i, space)| within(&format!("{place}[{i}]"), space, visit)),
        Space::Dict(space) => space
            .spaces()
            .iter()
            .try_for_each(|(key, space)| within(&format!("{place}[{key:?}]"), space, visit)),
        Space::OneOf(space) => space
            .spaces()
            .iter()
            .enumerate()
            .try_for_each(|(i, space)| within(&format!("{place}[{i}]"), space, visit)),
        Space::Sequence(space) => within(
            &format!("each item of {place}"),
            space.feature_space(),
            visit,
        ),
        Space::Graph(space) => {
            within(&format!("each node of {place}"), space.node_space(), visit)?;
            space.edge_space().map_or(Ok(()), |edge| {
                within(&format!("each edge of {place}"), edge, visit)
            })
        }
        _ => Ok(()),
    }
}

pub(crate) fn not_empty(subject: &Subject<'_>) -> Verdict {
    each(subject, |place, space| {
        let is_empty = match space {
            Space::Tuple(space) => space.spaces().is_empty(),
            Space::Dict(space) => space.spaces().is_empty(),
            Space::Text(space) => space.max_length() == 0,
            _ => space.shape().is_some_and(|shape| shape.contains(&0)),
        };
        if is_empty {
            broken(format!("{place} is {space}, which has no elements"))
        } else {
            Ok(())
        }
    })
}

pub(crate) fn width(subject: &Subject<'_>) -> Verdict {
    each(subject, |place, space| {
        let Space::Box(space) = space else {
            return Ok(());
        };
        let mut bounds = space.low().iter_f64().zip(space.high().iter_f64());
        match bounds.position(|(low, high)| low == high) {
            Some(i) => broken(format!("element {i} of {place}, {space}, has equal bounds")),
            None => Ok(()),
        }
    })
}

pub(crate) fn bounded(subject: &Subject<'_>) -> Verdict {
    each(subject, |place, space| match space {
        Space::Box(space) if !space.is_bounded() => {
            broken(format!("{place}, {space}, has infinite bounds"))
        }
        _ => Ok(()),
    })
}

/// Checks bounds of action spaces with one axis, as Gymnasium does.
pub(crate) fn action_normalised(subject: &Subject<'_>) -> Verdict {
    let Space::Box(space) = subject.make()?.action_space() else {
        return Ok(());
    };
    let mut bounds = space.low().iter_f64().zip(space.high().iter_f64());
    let is_normal = |(low, high): (f64, f64)| -low == high && high <= NORMAL;
    if space.shape().len() == 1 && !bounds.all(is_normal) {
        return broken(format!(
            "the action space, {space}, is not symmetric or goes beyond -1 and 1"
        ));
    }
    Ok(())
}

pub(crate) fn constant(subject: &Subject<'_>) -> Verdict {
    let spaces = |env: &BoxEnv| [env.observation_space(), env.action_space()];
    let mut env = subject.make()?;
    let first = spaces(&env);
    let verdict = tour(&mut env, 0, STEPS, |env, step| {
        let parts = ["the observation space", "the action space"];
        for ((part, before), now) in parts.into_iter().zip(&first).zip(spaces(env)) {
            if *before != now {
                return broken(format!(
                    "{part} is {before} at first and {now} after step {step}"
                ));
            }
        }
        Ok(())
    });
    match verdict {
        // another check reports failing steps
        Ok(()) | Err(Trouble::Error(_)) => (),
        verdict => return verdict,
    }
    let others = [(); 3].map(|()| subject.make().map(|env| spaces(&env)));
    let late = subject.late_spaces().cloned();
    let others = others
        .into_iter()
        .map(|spaces| ("in another environment", spaces));
    for (place, now) in others.chain(late.map(|late| ("after a long run", Ok(late)))) {
        let parts = ["the observation space", "the action space"];
        for ((part, before), now) in parts.into_iter().zip(&first).zip(now?) {
            if *before != now {
                return broken(format!("{part} is {before} at first and {now} {place}"));
            }
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use gym_core::spaces::{DictSpace, GraphSpace, OneOfSpace, SequenceSpace, TupleSpace};

    use super::*;

    #[test]
    fn every_space_within_is_visited() {
        let two = || Space::discrete(2);
        let line = || Space::boxed([0.0], [1.0]);
        let graph = GraphSpace::new(line(), Some(two())).unwrap();
        let dict = DictSpace::new([
            ("a", two()),
            ("b", OneOfSpace::new([two(), line()]).unwrap().into()),
        ])
        .unwrap();
        let tuple = TupleSpace::new([two(), SequenceSpace::new(dict).into(), graph.into()]);
        let mut places = Vec::new();
        let visited = within("it", &tuple.into(), &mut |place, _| {
            places.push(place.to_owned());
            Ok(())
        });
        assert!(visited.is_ok());
        let item = "each item of it[1]";
        let expected = [
            "it".to_owned(),
            "it[0]".to_owned(),
            "it[1]".to_owned(),
            item.to_owned(),
            format!("{item}[\"a\"]"),
            format!("{item}[\"b\"]"),
            format!("{item}[\"b\"][0]"),
            format!("{item}[\"b\"][1]"),
            "it[2]".to_owned(),
            "each node of it[2]".to_owned(),
            "each edge of it[2]".to_owned(),
        ];
        assert_eq!(places, expected);
    }
}
