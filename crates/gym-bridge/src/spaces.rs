//! Converts the worker's description of Python's spaces.

use gym_core::spaces::{
    BoxSpace, DictSpace, Discrete, GraphSpace, MultiBinary, MultiDiscrete, OneOfSpace,
    SequenceSpace, TextSpace, TupleSpace,
};
use gym_core::{Array, DType, Error, Result, Space, Value};

/// Returns the observation space and the action space.
pub(crate) fn pair(described: &Value) -> Result<(Space, Space)> {
    let named = |name: &str, described: &Value| {
        space(described).map_err(|error| Error::custom(format!("the {name} space: {error}")))
    };
    match described.as_tuple() {
        Some([observation, action]) => {
            Ok((named("observation", observation)?, named("action", action)?))
        }
        _ => Err(malformed()),
    }
}

fn malformed() -> Error {
    Error::custom("the worker described a space in an unknown form")
}

fn space(described: &Value) -> Result<Space> {
    let get = |key: &str| described.get(key).ok_or_else(malformed);
    let int = |key: &str| get(key)?.as_int().ok_or_else(malformed);
    let array = |key: &str| get(key)?.as_array().cloned().ok_or_else(malformed);
    let members = || -> Result<Vec<Space>> {
        get("spaces")?
            .as_tuple()
            .ok_or_else(malformed)?
            .iter()
            .map(space)
            .collect()
    };
    Ok(match get("kind")?.as_text().unwrap_or_default() {
        "Box" => {
            let shape = lengths(get("shape")?)?;
            BoxSpace::new(
                bounds(&array("low")?, &shape)?,
                bounds(&array("high")?, &shape)?,
            )?
            .into()
        }
        "Discrete" => Discrete::new(int("n")?)?.with_start(int("start")?)?.into(),
        "MultiDiscrete" => {
            let dtype = get("dtype")?
                .as_text()
                .and_then(dtype)
                .ok_or_else(malformed)?;
            MultiDiscrete::new(array("nvec")?)?
                .with_start(array("start")?)?
                .with_dtype(dtype)?
                .into()
        }
        "MultiBinary" => MultiBinary::new(lengths(get("shape")?)?)?.into(),
        "Text" => {
            let charset = get("charset")?.as_text().ok_or_else(malformed)?;
            text(length(int("min")?)?, length(int("max")?)?, charset)?
        }
        "AnyText" => any_text()?,
        "Tuple" => TupleSpace::new(members()?).into(),
        "Dict" => {
            let keys = get("keys")?.as_tuple().ok_or_else(malformed)?.iter();
            let keys = keys.map(|key| key.as_text().unwrap_or_default().to_owned());
            DictSpace::in_order(keys.zip(members()?))?.into()
        }
        "Sequence" => {
            let feature = space(get("feature")?)?;
            match get("stack")?.as_bool() {
                Some(true) => SequenceSpace::stacked(feature).into(),
                _ => SequenceSpace::new(feature).into(),
            }
        }
        "Graph" => {
            let edges = match get("edges")? {
                Value::Null => None,
                edges => Some(space(edges)?),
            };
            GraphSpace::new(space(get("nodes")?)?, edges)?.into()
        }
        "OneOf" => OneOfSpace::new(members()?)?.into(),
        _ => return Err(malformed()),
    })
}

/// Returns bounds in the shape of their box; a single number is repeated for all elements.
fn bounds(described: &Array, shape: &[usize]) -> Result<Array> {
    let mut bounds = Array::zeros(described.dtype(), shape)?;
    let bytes = described.to_bytes();
    let is_one = described.shape().is_empty();
    let fits = bounds.fill_bytes(&if is_one {
        bytes.repeat(bounds.len())
    } else {
        bytes
    });
    if fits { Ok(bounds) } else { Err(malformed()) }
}

fn text(min_length: usize, max_length: usize, charset: &str) -> Result<Space> {
    Ok(TextSpace::new(min_length, max_length)?
        .with_charset(charset)?
        .into())
}

/// A text space without a charset, such as minigrid's missions: any printable ASCII text.
fn any_text() -> Result<Space> {
    const LONGEST: usize = 10_000;
    text(0, LONGEST, &(' '..='~').collect::<String>())
}

fn dtype(name: &str) -> Option<DType> {
    let all = [
        DType::I8,
        DType::I16,
        DType::I32,
        DType::I64,
        DType::U8,
        DType::U16,
        DType::U32,
        DType::U64,
    ];
    all.into_iter().find(|dtype| dtype.name() == name)
}

fn length(i: i64) -> Result<usize> {
    usize::try_from(i).map_err(|_| malformed())
}

fn lengths(value: &Value) -> Result<Vec<usize>> {
    let items = value.as_tuple().ok_or_else(malformed)?;
    items
        .iter()
        .map(|item| length(item.as_int().ok_or_else(malformed)?))
        .collect()
}
