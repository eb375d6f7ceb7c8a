//! Wrappers that change observations without reading the world.

use gym_core::registry::WrapperConfig;
use gym_core::spaces::{BoxSpace, DictSpace, MultiDiscrete, array_of};
use gym_core::{BoxEnv, DType, Error, Kwargs, Result, Space, Value};
use gym_wrappers::map::{MapObservation, ObservationMap};

/// The number of kinds, colours and states.
const BITS: [usize; 3] = [11, 6, 3];

/// The characters of missions: letters, space and comma.
const CHARACTERS: usize = 28;

/// The words of minigrid's missions.
const WORDS: &str = "red green blue yellow purple grey unseen empty wall floor box key ball door \
                     goal agent lava pick avoid get find put use open go fetch reach unlock \
                     traverse up the a at , square and then to of rooms near opening must you \
                     matching end hallway object from room maze";

/// Returns the member `key` of a dict observation.
fn member<'a>(observation: &'a Value, key: &str) -> Result<&'a Value> {
    let missing = || Error::Contract(format!("the observation {observation} has no `{key}`"));
    observation.get(key).ok_or_else(missing)
}

fn text(observation: &Value) -> Result<&str> {
    let not_text = || Error::Contract(format!("the mission of {observation} is not a text"));
    member(observation, "mission")?
        .as_text()
        .ok_or_else(not_text)
}

fn cells(observation: &Value) -> Result<&[u8]> {
    let not_cells = || Error::Contract(format!("the image of {observation} is not of uint8"));
    member(observation, "image")?
        .as_slice()
        .ok_or_else(not_cells)
}

/// Returns `space` as the dict space of minigrid's observations, and the space of its image.
fn image_of<C: WrapperConfig>(space: &Space) -> Result<(&DictSpace, &BoxSpace)> {
    if let Space::Dict(dict) = space
        && let Some(Space::Box(image)) = dict.get("image")
    {
        return Ok((dict, image));
    }
    Err(C::refuse(format!(
        "it needs observations with an `image`, and the space is {space}"
    )))
}

/// Returns `dict` with the member `key` replaced or added.
pub(super) fn with_member(dict: &DictSpace, key: &str, space: Space) -> Result<Space> {
    let others = dict
        .spaces()
        .iter()
        .filter(|(name, _)| name != key)
        .cloned();
    DictSpace::new(others.chain([(key.to_owned(), space)])).map(Space::from)
}

/// Copies the members of an observation except `key` to `out`, a dict with the members of `space`.
/// Returns the member `key` of `out`, which the caller writes.
pub(super) fn copy_others<'a>(
    space: &Space,
    observation: &Value,
    key: &str,
    out: &'a mut Value,
) -> Result<&'a mut Value> {
    let Space::Dict(space) = space else {
        return Err(Error::Contract(format!("{space} is not a dict")));
    };
    let keys = || space.spaces().iter().map(|(name, _)| name);
    let fits = |out: &Value| match out {
        Value::Dict(entries) => entries.iter().map(|(name, _)| name).eq(keys()),
        _ => false,
    };
    if !fits(out) {
        *out = Value::Dict(keys().map(|name| (name.clone(), Value::Null)).collect());
    }
    let mut changed = None;
    if let Value::Dict(entries) = out {
        for (name, value) in entries {
            if name == key {
                changed = Some(value);
            } else {
                value.clone_from(member(observation, name)?);
            }
        }
    }
    changed.ok_or_else(|| Error::Contract(format!("there is no `{key}`")))
}

gym_core::arguments! {
    /// The arguments of [`ImgObsWrapper`]: none.
    pub struct Img {}
}

/// Observes the picture of cells alone.
pub type ImgObsWrapper<T = BoxEnv> = MapObservation<T, ImgMap>;

/// The map of [`ImgObsWrapper`].
#[derive(Clone, Copy, Debug)]
pub struct ImgMap;

impl ObservationMap for ImgMap {
    type Config = Img;
    const TAKES_BATCHES: bool = true;

    fn new(_: &Img, inner: &Space) -> Result<(Self, Space)> {
        Ok((Self, image_of::<Img>(inner)?.1.clone().into()))
    }

    fn map(&self, inner: &Value, out: &mut Value) -> Result<()> {
        out.clone_from(member(inner, "image")?);
        Ok(())
    }
}

gym_core::register_wrapper!(
    "ImgObsWrapper", "observes the `image` alone", Img, env: ImgObsWrapper::new, vector: ImgObsWrapper::new
);

gym_core::arguments! {
    /// The arguments of [`OneHotPartialObsWrapper`].
    pub struct OneHot {
        /// It changes nothing, as in minigrid.
        pub tile_size: u32 = 8,
    }
}

/// Observes 20 zeros and ones for each cell: one of them for kind, colour and state each.
pub type OneHotPartialObsWrapper<T = BoxEnv> = MapObservation<T, OneHotMap>;

/// The map of [`OneHotPartialObsWrapper`].
#[derive(Clone, Debug)]
pub struct OneHotMap {
    space: Space,
    shape: Vec<usize>,
}

impl ObservationMap for OneHotMap {
    type Config = OneHot;

    fn new(_: &OneHot, inner: &Space) -> Result<(Self, Space)> {
        let (dict, image) = image_of::<OneHot>(inner)?;
        let [width, height, 3] = *image.shape() else {
            return Err(OneHot::refuse(format!(
                "it needs images of cells, and the space is {inner}"
            )));
        };
        let shape = vec![width, height, BITS.iter().sum()];
        let bits = BoxSpace::uniform(0.0, 255.0, shape.clone(), DType::U8)?;
        let space = with_member(dict, "image", bits.into())?;
        Ok((
            Self {
                space: space.clone(),
                shape,
            },
            space,
        ))
    }

    fn map(&self, inner: &Value, out: &mut Value) -> Result<()> {
        let cells = cells(inner)?;
        let out = copy_others(&self.space, inner, "image", out)?;
        let bits = array_of(out, DType::U8, &self.shape)
            .as_mut_slice::<u8>()
            .unwrap_or_default();
        bits.fill(0);
        let rows = bits.chunks_exact_mut(BITS.iter().sum());
        for (bits, cell) in rows.zip(cells.chunks_exact(3)) {
            let mut rest = bits;
            for (count, &number) in BITS.into_iter().zip(cell) {
                let (part, others) = rest.split_at_mut(count);
                if let Some(bit) = part.get_mut(usize::from(number)) {
                    *bit = 1;
                }
                rest = others;
            }
        }
        Ok(())
    }
}

gym_core::register_wrapper!(
    "OneHotPartialObsWrapper", "observes zeros and ones for kind, colour and state", OneHot,
    env: OneHotPartialObsWrapper::new, vector: OneHotPartialObsWrapper::new
);

gym_core::arguments! {
    /// The arguments of [`FlatObsWrapper`].
    #[expect(non_snake_case, reason = "the argument has minigrid's name")]
    pub struct Flat {
        /// The length of the longest mission.
        pub maxStrLen: u32 = 96,
    }
}

/// Observes one row of numbers: the cells, then 28 zeros and ones for each character of the
/// mission.
pub type FlatObsWrapper<T = BoxEnv> = MapObservation<T, FlatMap>;

/// The map of [`FlatObsWrapper`].
#[derive(Clone, Copy, Debug)]
pub struct FlatMap {
    longest: usize,
}

impl ObservationMap for FlatMap {
    type Config = Flat;

    fn new(config: &Flat, inner: &Space) -> Result<(Self, Space)> {
        let (_, image) = image_of::<Flat>(inner)?;
        let longest = config.maxStrLen as usize;
        let len = image.shape().iter().product::<usize>() + CHARACTERS * longest;
        let space = BoxSpace::uniform(0.0, 255.0, [len], DType::U8)?;
        Ok((Self { longest }, space.into()))
    }

    fn map(&self, inner: &Value, out: &mut Value) -> Result<()> {
        let (cells, mission) = (cells(inner)?, text(inner)?);
        if mission.len() > self.longest {
            return Err(Flat::refuse(format!(
                "the mission {mission:?} has {} characters: `maxStrLen` is {}",
                mission.len(),
                self.longest
            )));
        }
        let len = cells.len() + CHARACTERS * self.longest;
        let out = array_of(out, DType::U8, &[len])
            .as_mut_slice::<u8>()
            .unwrap_or_default();
        let (image, characters) = out.split_at_mut(cells.len());
        image.copy_from_slice(cells);
        characters.fill(0);
        for (row, character) in characters.chunks_exact_mut(CHARACTERS).zip(mission.chars()) {
            let number = match character.to_ascii_lowercase() {
                letter @ 'a'..='z' => letter as usize - 'a' as usize,
                ' ' => 26,
                ',' => 27,
                other => {
                    return Err(Flat::refuse(format!(
                        "the mission {mission:?} has {other:?}"
                    )));
                }
            };
            row[number] = 1;
        }
        Ok(())
    }
}

gym_core::register_wrapper!(
    "FlatObsWrapper", "observes cells and mission as one row of numbers", Flat,
    env: FlatObsWrapper::new, vector: FlatObsWrapper::new
);

gym_core::arguments! {
    /// The arguments of [`DictObservationSpaceWrapper`].
    pub struct Words {
        /// One more than the number of words of the longest mission.
        pub max_words_in_mission: u32 = 50,
        /// The number of each word, from 0 on; minigrid's words if null.
        pub word_dict: Option<Kwargs>,
    }
}

/// Observes the mission as word numbers, padded with zeros.
pub type DictObservationSpaceWrapper<T = BoxEnv> = MapObservation<T, WordsMap>;

/// The map of [`DictObservationSpaceWrapper`].
#[derive(Clone, Debug)]
pub struct WordsMap {
    space: Space,
    words: Vec<(String, i64)>,
    length: usize,
}

impl ObservationMap for WordsMap {
    type Config = Words;

    fn new(config: &Words, inner: &Space) -> Result<(Self, Space)> {
        let (dict, _) = image_of::<Words>(inner)?;
        let words: Vec<(String, i64)> = match &config.word_dict {
            None => WORDS
                .split_whitespace()
                .map(str::to_owned)
                .zip(0..)
                .collect(),
            Some(words) => {
                let number = |(word, number): (&String, &serde_json::Value)| {
                    let number = number
                        .as_i64()
                        .filter(|n| (0..words.len() as i64).contains(n));
                    let refuse = || {
                        Words::refuse(format!(
                            "the number of {word:?} in `word_dict` is not one of the first {}",
                            words.len()
                        ))
                    };
                    Ok((word.clone(), number.ok_or_else(refuse)?))
                };
                words.iter().map(number).collect::<Result<_>>()?
            }
        };
        let length = config.max_words_in_mission as usize;
        let mission = MultiDiscrete::new(vec![words.len() as i64 + 1; length])?;
        let space = with_member(dict, "mission", mission.into())?;
        Ok((
            Self {
                space: space.clone(),
                words,
                length,
            },
            space,
        ))
    }

    fn map(&self, inner: &Value, out: &mut Value) -> Result<()> {
        let mission = text(inner)?;
        let out = copy_others(&self.space, inner, "mission", out)?;
        let out = array_of(out, DType::I64, &[self.length])
            .as_mut_slice::<i64>()
            .unwrap_or_default();
        out.fill(0);
        let mut count = 0;
        for part in mission.split_inclusive([' ', ',']) {
            let (word, comma) = match part.strip_suffix(',') {
                Some(word) => (word, Some(",")),
                None => (part, None),
            };
            for word in [Some(word.trim()), comma]
                .into_iter()
                .flatten()
                .filter(|word| !word.is_empty())
            {
                let known = self.words.iter().find(|(known, _)| known == word);
                let (_, number) = known.ok_or_else(|| {
                    Words::refuse(format!("the word {word:?} is not in `word_dict`"))
                })?;
                if count + 1 >= self.length {
                    return Err(Words::refuse(format!(
                        "the mission {mission:?} is longer than `max_words_in_mission`"
                    )));
                }
                out[count] = number + 1;
                count += 1;
            }
        }
        Ok(())
    }
}

gym_core::register_wrapper!(
    "DictObservationSpaceWrapper", "observes the mission as numbers of words", Words,
    env: DictObservationSpaceWrapper::new, vector: DictObservationSpaceWrapper::new
);
