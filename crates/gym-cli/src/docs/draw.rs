//! The images of the pages: a GIF of the good policy, small and short.

use std::path::PathBuf;

use gym::Result;

use super::Document;
use super::page::Page;
use crate::film::Film;
use crate::policy::Policy;

/// Returns the GIF of a page, if a registration has a clip.
pub(super) fn gif(page: &Page) -> Result<Option<Document>> {
    let Some(clip) = &page.shown().page.clip else {
        return Ok(None);
    };
    let (mut env, mut film) = Film::open(page.shown().spec()?, clip)?;
    let policy = Policy::best(&env)?;
    for seed in clip.seeds.clone() {
        policy.play(&mut env, seed, |env| film.watch(env))?;
    }
    let path = PathBuf::from(format!("docs/environments/images/{}.gif", page.name));
    Ok(Some((path, film.finish()?)))
}
