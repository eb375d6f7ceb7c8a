//! `cargo xtask demo`: plays the linked environments, and shows them on one page.

mod page;

use std::fs;
use std::iter;
use std::panic::resume_unwind;
use std::path::PathBuf;
use std::sync::{Mutex, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use gym::registry::{self, Clip};
use gym::render::file;
use gym::{BoxEnv, Env, EnvSpec, Error, Registration, Result, Space};
use indicatif::{ProgressBar, ProgressStyle};

use self::page::{Card, Section};
use crate::film::Film;
use crate::inputs;
use crate::output::say;
use crate::policy::Policy;
use crate::run::summary;
use crate::workspace::Workspace;

#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Episodes of each environment, with the seeds from 0 on.
    #[arg(long, default_value_t = 10, allow_negative_numbers = true, value_parser = inputs::parse_count)]
    episodes: u64,
    /// The folder for the page, index.html.
    #[arg(long, default_value = "target/demo")]
    out: PathBuf,
    /// The largest number of frames in a moving picture.
    #[arg(long, default_value_t = 200, allow_negative_numbers = true, value_parser = inputs::parse_count)]
    max_frames: u64,
    /// Every id, instead of one for each page of the book.
    #[arg(long)]
    all: bool,
}

/// The largest number of steps in an episode of an environment without a time limit.
const STEP_LIMIT: u32 = 10_000;

/// The frames of a moving picture, and the largest side of its frames in pixels, for an environment
/// without a clip of its own.
const FRAMES: u32 = 100;
const SIDE: u32 = 240;

/// The time between two versions of the page while environments are played.
const PATIENCE: Duration = Duration::from_secs(2);

/// Plays the environments. Writes the page at the end and, with what is there, every few seconds.
pub(crate) fn demo(arguments: &Arguments, workspace: &Workspace) -> Result<()> {
    fs::create_dir_all(&arguments.out).map_err(|error| Error::io(&arguments.out, error))?;
    let path = arguments.out.join("index.html");
    inputs::check_writable(&path)?;
    let (mut sections, mut jobs) = (Vec::new(), Vec::new());
    for (family, registrations) in registry::by_family(workspace.all()?) {
        let mut section = Section::new(family.name);
        let (chosen, missing) = choose(registrations, arguments.all);
        section.missing = missing;
        section.cards.resize_with(chosen.len(), || None);
        let family = sections.len();
        jobs.extend(
            chosen
                .into_iter()
                .enumerate()
                .map(|(card, entry)| (family, card, entry)),
        );
        sections.push(section);
    }
    let bar = ProgressBar::new((jobs.len() as u64).saturating_mul(arguments.episodes)).with_style(
        ProgressStyle::with_template("{bar:40} {pos}/{len} episodes  {msg}")
            .unwrap_or_else(|_| ProgressStyle::default_bar()),
    );
    let workers = thread::available_parallelism().map_or(1, usize::from);
    // each thread takes the next environment when it is free, because some environments take a
    // hundred times as long as others
    let waiting = Mutex::new(jobs.into_iter());
    let board = Mutex::new((sections, None::<Instant>));
    let work = || -> Result<()> {
        let next = || {
            let mut waiting = waiting.lock().unwrap_or_else(PoisonError::into_inner);
            waiting.next()
        };
        for (family, card, registration) in iter::from_fn(next) {
            let played = play(&registration, arguments, &bar)?;
            let mut board = board.lock().unwrap_or_else(PoisonError::into_inner);
            let (sections, written) = &mut *board;
            sections[family].cards[card] = Some(played);
            if written.is_none_or(|written| written.elapsed() > PATIENCE) {
                file::write(&path, page::html(sections).as_bytes())?;
                if written.is_none() {
                    let place = path.display();
                    bar.suspend(|| say(format_args!("{place} has the first picture")))?;
                }
                *written = Some(Instant::now());
            }
        }
        Ok(())
    };
    thread::scope(|scope| {
        let handles: Vec<_> = (0..workers).map(|_| scope.spawn(work)).collect();
        handles
            .into_iter()
            .try_for_each(|handle| handle.join().unwrap_or_else(|panic| resume_unwind(panic)))
    })?;
    bar.finish_and_clear();
    let (sections, _) = board.into_inner().unwrap_or_else(PoisonError::into_inner);
    file::write(&path, page::html(&sections).as_bytes())?;
    say(format_args!(
        "{} episodes each, by the good policy or at random: mean [min, max]",
        arguments.episodes
    ))?;
    for section in &sections {
        for card in section.cards.iter().flatten() {
            say(format_args!("{:28} {}", card.id, summary(&card.episodes)))?;
        }
        if let Some(missing) = &section.missing {
            say(format_args!("{}: {missing}", section.name))?;
        }
    }
    say(format_args!("\nAll on one page: {}", path.display()))
}

/// Returns the environments of a family to play: all, or one for each page. If one cannot be made
/// because of an external requirement, the second part says what to do.
fn choose(registrations: Vec<Registration>, all: bool) -> (Vec<Registration>, Option<String>) {
    let mut missing = None;
    let mut is_unmet = false;
    // a requirement may be met for some environments only, such as games
    let mut can_make = |registration: &Registration| match registration.needs {
        None => true,
        Some(_) if is_unmet => false,
        Some(need) => match gym::make(registration.id()) {
            Ok(_) => true,
            Err(error) => {
                missing.get_or_insert_with(|| error.to_string());
                is_unmet = !need.is_met();
                false
            }
        },
    };
    if all {
        let made = registrations.into_iter().filter(&mut can_make).collect();
        return (made, missing);
    }
    // environments with a requirement have no pages: one of them is enough
    let mut has_needy = false;
    let mut chosen = Vec::new();
    for page in registry::by_page(registrations) {
        let Some(shown) = registry::shown(&page) else {
            continue;
        };
        let is_needy = shown.needs.is_some();
        if !is_needy || (!has_needy && can_make(shown)) {
            has_needy |= is_needy;
            chosen.push(shown.clone());
        }
    }
    // what some ids of a family need is no news if others are played
    let missing = missing.filter(|_| chosen.is_empty());
    (chosen, missing)
}

/// Plays the episodes of one environment, and records the first frames.
fn play(registration: &Registration, arguments: &Arguments, bar: &ProgressBar) -> Result<Card> {
    let spec = registration.spec()?;
    bar.set_message(spec.id.clone());
    let spec = EnvSpec {
        max_episode_steps: spec.max_episode_steps.or(Some(STEP_LIMIT)),
        ..spec
    };
    let mut clip = match &registration.page.clip {
        Some(clip) => clip.clone(),
        None => own_clip(&spec)?,
    };
    let most = u32::try_from(arguments.max_frames).unwrap_or(u32::MAX);
    clip.frames = clip.frames.min(most);
    let (mut env, mut film) = Film::open(spec, &clip)?;
    let policy = Policy::best(&env)?;
    let episodes = (0..arguments.episodes)
        .map(|seed| {
            bar.inc(1);
            policy.play(&mut env, seed, |env| film.watch(env))
        })
        .collect::<Result<_>>()?;
    Ok(Card {
        id: registration.id().to_owned(),
        description: registration.description,
        policy: match (policy, registration.page.policy) {
            (Policy::Good, Some(good)) => Some(good.description),
            _ => None,
        },
        spaces: [env.observation_space(), env.action_space()].map(|space| space.to_string()),
        has_keys: registration.page.keys.is_some()
            || matches!(env.action_space(), Space::Discrete(_)),
        picture: film.finish()?,
        episodes,
    })
}

/// Returns the clip of an environment whose registration has none.
fn own_clip(spec: &EnvSpec) -> Result<Clip> {
    let (width, height) = BoxEnv::metadata(&spec.make()?).render_size;
    let scale = |side: u32| (side * SIDE / width.max(height).max(1)).clamp(1, SIDE);
    Ok(Clip {
        seeds: 0..1,
        every: 1,
        frames: FRAMES,
        size: (scale(width), scale(height)),
    })
}
