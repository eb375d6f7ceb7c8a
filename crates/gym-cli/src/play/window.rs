//! Playing in a window.

use std::time::Instant;

use gym::render::Window;

use super::*;

/// Plays until the window is closed.
pub(super) fn play(session: &mut Session, keys: &Keys, arguments: &Arguments) -> Result<()> {
    let period = session.period(arguments);
    let size = (session.frame.width(), session.frame.height());
    let mut window = Window::open(&session.status(), size)?;
    let mut last = None;
    let mut down = Vec::new();
    let mut due = Instant::now() + period;
    while window.is_open() {
        window.show(&session.frame);
        window.set_title(&session.status());
        let before = std::mem::replace(&mut down, window.keys());
        let is_new = |key: &String| !before.contains(key);
        if down.iter().any(|key| key == "Escape") {
            return Ok(());
        }
        if down.iter().any(|key| {
            key == "R" && is_new(key) && keys::action(keys, std::slice::from_ref(key)).is_none()
        }) {
            session.reset(Reset::default())?;
            continue;
        }
        let action = if keys.idle == Idle::Wait {
            let new: Vec<_> = down.iter().filter(|key| is_new(key)).cloned().collect();
            keys::action(keys, &new)
        } else if Instant::now() < due {
            None
        } else {
            due = (due + period).max(Instant::now());
            keys::action(keys, &down).or_else(|| match &keys.idle {
                Idle::Action(action) => Some(action.clone()),
                _ => last.clone(),
            })
        };
        let Some(action) = action else { continue };
        let done = session.step(&action)?;
        last = Some(action);
        if done {
            let end = Instant::now() + PAUSE;
            while window.is_open() && Instant::now() < end {
                window.show(&session.frame);
                window.set_title(&session.status());
            }
            if session.is_last() {
                return Ok(());
            }
            session.reset(Reset::default())?;
            (last, due) = (None, Instant::now() + period);
        }
    }
    Ok(())
}
