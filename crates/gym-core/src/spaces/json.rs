//! Elements as JSON and back.

use serde_json::{Map, Value as Json, json};

use crate::value::number::Number;
use crate::value::stored::plain::{
    check_length, list, read_array, read_number, rows, write_number,
};
use crate::value::{DType, GraphInstance, Result, Value};

use super::batch::{concatenate, iterate};
use super::{DictSpace, MultiBinary, Space, TupleSpace};
use crate::value::fault::{Fault, expect_array};

impl Space {
    /// An element as JSON: arrays as nested lists, tuples and sequences as lists, dicts as objects,
    /// `OneOf` as `[index, value]`, graphs as an object of `nodes`, `edges` and `edge_links`.
    /// Infinities and NaN are written as `"inf"`, `"-inf"` and `"NaN"`.
    ///
    /// ```
    /// use gym_core::{Space, Value};
    /// let space = Space::boxed([0.0, 0.0], [1.0, 1.0]);
    /// let json = space.to_json(&Value::Array([0.5f32, 1.0].into()))?;
    /// assert_eq!(json, serde_json::json!([0.5, 1.0]));
    /// assert_eq!(space.from_json(&json)?, Value::Array([0.5f32, 1.0].into()));
    /// # Ok::<(), gym_core::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::NotInSpace`](crate::Error::NotInSpace) if the value is not of the kind, type and
    /// shape of the space's elements. It may be out of bounds.
    pub fn to_json(&self, value: &Value) -> Result<Json> {
        self.check_form(value)
            .map_err(|fault| self.refuse(value, &fault))?;
        Ok(value.to_json())
    }

    /// The element that [`to_json`](Self::to_json) wrote. Numbers are rounded to the precision of
    /// the space.
    ///
    /// # Errors
    /// [`Error::NotInSpace`](crate::Error::NotInSpace) if the JSON does not have the form of the
    /// space's elements, or has a number that does not fit their type, such as 1.5 for an integer.
    /// The value may be out of bounds: check [`contains`](Self::contains).
    pub fn from_json(&self, json: &Json) -> Result<Value> {
        self.read(json).map_err(|fault| self.refuse(json, &fault))
    }

    /// Whether a value is of the kind, type and shape of the elements.
    fn check_form(&self, value: &Value) -> Result<(), Fault> {
        match self {
            Self::Box(space) => expect_array(value, space.shape(), space.dtype()).map(|_| ()),
            Self::MultiDiscrete(space) => {
                expect_array(value, space.shape(), space.dtype()).map(|_| ())
            }
            Self::MultiBinary(space) => space.expect_array(value).map(|_| ()),
            Self::Discrete(_) => match value {
                Value::Int(_) => Ok(()),
                _ => Err(Fault::kind("a whole number", value)),
            },
            Self::Text(_) | Self::Mission(_) => match value {
                Value::Text(_) => Ok(()),
                _ => Err(Fault::kind("a text", value)),
            },
            Self::Tuple(space) => space.each(value, Self::check_form),
            Self::Dict(space) => space.each(value, Self::check_form),
            Self::Sequence(space) => {
                space
                    .items(value)?
                    .iter()
                    .enumerate()
                    .try_for_each(|(i, item)| {
                        space
                            .feature_space()
                            .check_form(item)
                            .map_err(|fault| fault.at(i))
                    })
            }
            Self::Graph(space) => {
                let Value::Graph(graph) = value else {
                    return Err(Fault::kind("a graph", value));
                };
                iterate(space.node_space(), &graph.nodes)
                    .map_err(|fault| fault.within(".nodes"))?;
                match (space.edge_space(), &graph.edges) {
                    (Some(space), Some(edges)) => iterate(space, edges)
                        .map(|_| ())
                        .map_err(|fault| fault.within(".edges")),
                    (None, Some(_)) => Err(Fault::new("there are edges, but the space has none")),
                    (_, None) => Ok(()),
                }
            }
            Self::OneOf(space) => {
                let (_, space, member) = space.chosen(value)?;
                space.check_form(member).map_err(|fault| fault.at(1))
            }
        }
    }

    fn read(&self, json: &Json) -> Result<Value, Fault> {
        match self {
            Self::Box(space) => read_array(json, space.shape(), space.dtype()).map(Value::Array),
            Self::MultiDiscrete(space) => {
                read_array(json, space.shape(), space.dtype()).map(Value::Array)
            }
            Self::MultiBinary(space) => {
                read_array(json, space.shape(), MultiBinary::DTYPE).map(Value::Array)
            }
            Self::Discrete(space) => {
                let number = read_number(json, space.dtype())?;
                let too_large = || Fault::new(format!("{number} does not fit int64"));
                number.to_i64().map(Value::Int).ok_or_else(too_large)
            }
            Self::Text(_) | Self::Mission(_) => match json {
                Json::String(text) => Ok(Value::Text(text.clone())),
                _ => Err(Fault::new("expected a string")),
            },
            Self::Tuple(space) => read_tuple(space, json, Self::read),
            Self::Dict(space) => read_dict(space, json, Self::read),
            Self::Sequence(space) if space.is_stacked() => space.feature_space().read_stacked(json),
            Self::Sequence(space) => space.feature_space().read_list(json).map(Value::Tuple),
            Self::Graph(space) => {
                let json = object(json)?;
                let part = |key: &str| json.get(key).filter(|part| !part.is_null());
                let rows = |space: &Self, key: &str| {
                    let read = |json| space.read_stacked(json).map_err(|fault| fault.under(key));
                    part(key).map(read).transpose()
                };
                let Some(nodes) = rows(space.node_space(), "nodes")? else {
                    return Err(Fault::new("the key \"nodes\" is missing"));
                };
                let edges = space
                    .edge_space()
                    .map(|space| rows(space, "edges"))
                    .transpose()?
                    .flatten();
                let links = part("edge_links").map(|links| {
                    let shape = [list(links)?.len(), 2];
                    read_array(links, &shape, DType::I32)
                });
                let edge_links = links
                    .transpose()
                    .map_err(|fault| fault.under("edge_links"))?;
                Ok(Value::Graph(Box::new(GraphInstance {
                    nodes,
                    edges,
                    edge_links,
                })))
            }
            Self::OneOf(space) => match list(json)?.as_slice() {
                [index, value] => {
                    let index = index.as_u64().and_then(|index| usize::try_from(index).ok());
                    let Some((index, space)) =
                        index.and_then(|i| Some((i, space.spaces().get(i)?)))
                    else {
                        return Err(Fault::new("there is no space of this index").at(0));
                    };
                    let value = space.read(value).map_err(|fault| fault.at(1))?;
                    Ok(Value::OneOf(index, Box::new(value)))
                }
                _ => Err(Fault::new("expected a list of an index and a value")),
            },
        }
    }

    /// Reads elements that are stacked as in a sequence.
    fn read_stacked(&self, json: &Json) -> Result<Value, Fault> {
        match self {
            Self::Tuple(space) => read_tuple(space, json, Self::read_stacked),
            Self::Dict(space) => read_dict(space, json, Self::read_stacked),
            _ => concatenate(self, &self.read_list(json)?.iter().collect::<Vec<_>>()),
        }
    }

    /// Reads a list of elements.
    fn read_list(&self, json: &Json) -> Result<Vec<Value>, Fault> {
        let items = list(json)?.iter().enumerate();
        items
            .map(|(i, item)| self.read(item).map_err(|fault| fault.at(i)))
            .collect()
    }
}

type Read = fn(&Space, &Json) -> Result<Value, Fault>;

fn read_tuple(space: &TupleSpace, json: &Json, read: Read) -> Result<Value, Fault> {
    let (items, spaces) = (list(json)?, space.spaces());
    check_length(items, spaces.len())?;
    let items = spaces.iter().zip(items).enumerate();
    let items = items.map(|(i, (space, item))| read(space, item).map_err(|fault| fault.at(i)));
    items.collect::<Result<_, _>>().map(Value::Tuple)
}

fn read_dict(space: &DictSpace, json: &Json, read: Read) -> Result<Value, Fault> {
    let entries = object(json)?;
    if let Some(key) = entries.keys().find(|key| space.get(key).is_none()) {
        return Err(Fault::new(format!("the space has no key {key:?}")));
    }
    let entries = space
        .spaces()
        .iter()
        .map(|(key, space)| match entries.get(key) {
            Some(entry) => Ok((
                key.clone(),
                read(space, entry).map_err(|fault| fault.under(key))?,
            )),
            None => Err(Fault::new(format!("the key {key:?} is missing"))),
        });
    entries.collect::<Result<_, _>>().map(Value::Dict)
}

fn object(json: &Json) -> Result<&Map<String, Json>, Fault> {
    json.as_object()
        .ok_or_else(|| Fault::new("expected an object"))
}

impl Value {
    /// Plain JSON, without the types in the [stored form](Self#impl-Serialize-for-Value): arrays as
    /// nested lists, tuples as lists, dicts as objects, `OneOf` as `[index, value]`, infinities and
    /// NaN as `"inf"`, `"-inf"` and `"NaN"`. [`Space::from_json`] reads it again.
    pub fn to_json(&self) -> Json {
        match self {
            Self::Null => Json::Null,
            Self::Bool(b) => Json::from(*b),
            Self::Int(i) => Json::from(*i),
            Self::Float(x) => write_number(Number::Float(*x)),
            Self::Text(text) => Json::from(text.as_str()),
            Self::Array(array) => rows(array),
            Self::Tuple(items) => items.iter().map(Self::to_json).collect(),
            Self::Dict(entries) => entries
                .iter()
                .map(|(key, value)| (key.clone(), value.to_json()))
                .collect(),
            Self::Graph(graph) => {
                let edges = graph.edges.as_ref().map(Self::to_json);
                let links = graph.edge_links.as_ref().map(rows);
                json!({ "nodes": graph.nodes.to_json(), "edges": edges, "edge_links": links })
            }
            Self::OneOf(index, value) => json!([index, value.to_json()]),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::borrow::Borrow;

    use super::*;
    use crate::spaces::{
        BoxSpace, Discrete, GraphSpace, MultiDiscrete, OneOfSpace, SequenceSpace, TextSpace,
    };

    fn refused(space: impl Into<Space>, json: impl Borrow<Json>) -> String {
        space
            .into()
            .from_json(json.borrow())
            .unwrap_err()
            .to_string()
    }

    #[test]
    fn forms_are_plain() {
        let pair = || TupleSpace::new([Space::discrete(3), Space::boxed([0.0, 0.0], [1.0, 1.0])]);
        let dict = DictSpace::in_order([
            ("b", pair().into()),
            ("a", TextSpace::new(0, 3).unwrap().into()),
        ]);
        let one_of = OneOfSpace::new([Space::discrete(3), pair().into()]).unwrap();
        let graph = GraphSpace::new(Space::discrete(3), Some(Space::discrete(2))).unwrap();
        for (space, json) in [
            (Space::discrete(3), json!(2)),
            (pair().into(), json!([1, [0.0, 0.5]])),
            (
                dict.unwrap().into(),
                json!({"a": "x1", "b": [2, [1.0, 0.25]]}),
            ),
            (
                SequenceSpace::new(pair()).into(),
                json!([[1, [0.0, 0.5]], [0, [1.0, 0.0]]]),
            ),
            (
                SequenceSpace::stacked(pair()).into(),
                json!([[1, 0], [[0.0, 0.5], [1.0, 0.0]]]),
            ),
            (one_of.into(), json!([1, [2, [0.5, 0.5]]])),
            (
                graph.clone().into(),
                json!({"nodes": [0, 2], "edges": [1], "edge_links": [[1, 0]]}),
            ),
            (
                graph.into(),
                json!({"nodes": [0, 2], "edges": null, "edge_links": null}),
            ),
            (MultiDiscrete::new([3, 4]).unwrap().into(), json!([2, 3])),
            (MultiBinary::new([2, 1]).unwrap().into(), json!([[0], [1]])),
        ] {
            let value = space.from_json(&json).unwrap();
            assert!(space.contains(&value), "{value}");
            assert_eq!(space.to_json(&value).unwrap(), json);
            assert_eq!(value.to_json(), json);
        }
    }

    #[test]
    fn numbers_are_checked_and_rounded() {
        let float = || BoxSpace::uniform(-1.0, 1.0, [1], DType::F32).unwrap();
        let rounded = Space::from(float()).from_json(&json!([0.1])).unwrap();
        assert_eq!(rounded, Value::Array([0.1f32].into()));
        assert!(Space::from(float()).from_json(&json!([7])).is_ok());
        assert!(
            refused(float(), json!([1e39]))
                .starts_with("[0]: 1e39 is not a number of type float32")
        );
        assert!(refused(float(), json!([null])).contains("expected a number"));
        assert!(
            refused(float(), json!([0.0, 0.0]))
                .starts_with("the list has 2 items and should have 1")
        );
        assert!(refused(float(), json!(0.0)).starts_with("expected a list"));

        let whole = || BoxSpace::uniform(0.0, 9.0, [], DType::U8).unwrap();
        assert!(refused(whole(), json!(1.5)).starts_with("1.5 is not a number of type uint8"));
        assert!(refused(whole(), json!(256)).starts_with("256 is not a number of type uint8"));
        assert!(Space::from(whole()).from_json(&json!(3.0)).is_ok());
        let largest = BoxSpace::new([0], [u64::MAX]).unwrap();
        let json = json!([u64::MAX]);
        let value = Space::from(largest.clone()).from_json(&json).unwrap();
        assert_eq!(value, Value::Array([u64::MAX].into()));
        assert_eq!(Space::from(largest).to_json(&value).unwrap(), json);

        assert!(
            refused(Space::discrete(3), json!(1.5))
                .starts_with("1.5 is not a number of type int64")
        );
        assert_eq!(
            Space::discrete(3).from_json(&json!(7)).unwrap(),
            Value::Int(7)
        );
        assert!(
            refused(
                Discrete::new(3).unwrap().with_dtype(DType::I8).unwrap(),
                json!(200)
            )
            .contains("int8")
        );
    }

    #[test]
    fn infinity_and_nan_survive() {
        let space = Space::from(
            BoxSpace::uniform(f64::NEG_INFINITY, f64::INFINITY, [2], DType::F32).unwrap(),
        );
        let value = Value::Array([f32::INFINITY, f32::NEG_INFINITY].into());
        let json = space.to_json(&value).unwrap();
        assert_eq!(json, json!(["inf", "-inf"]));
        assert_eq!(space.from_json(&json).unwrap(), value);
        let json = space
            .to_json(&Value::Array([-0.0, f32::NAN].into()))
            .unwrap();
        assert_eq!(json.to_string(), r#"[-0.0,"NaN"]"#);
        assert_eq!(
            format!("{:?}", space.from_json(&json).unwrap().as_slice::<f32>()),
            "Some([-0.0, NaN])"
        );
        let whole = BoxSpace::uniform(0.0, 9.0, [1], DType::U8).unwrap();
        assert!(refused(whole, json!(["NaN"])).contains("is not a number of type uint8"));
    }

    #[test]
    fn other_forms_are_refused() {
        let pair = || TupleSpace::new([Space::discrete(3), TextSpace::new(0, 3).unwrap().into()]);
        assert!(refused(pair(), json!([1])).starts_with("the list has 1 items and should have 2"));
        assert!(refused(pair(), json!([1, 2])).starts_with("[1]: expected a string"));
        let either =
            || OneOfSpace::new([Space::discrete(3), TextSpace::new(0, 3).unwrap().into()]).unwrap();
        assert!(refused(either(), json!([1, 2])).starts_with("[1]: expected a string"));
        assert!(
            refused(either(), json!([2, 2])).starts_with("[0]: there is no space of this index")
        );
        let dict = || DictSpace::new([("a", pair().into())]).unwrap();
        assert!(refused(dict(), json!({})).starts_with("the key \"a\" is missing"));
        assert!(
            refused(dict(), json!({"a": [1, ""], "b": 1}))
                .starts_with("the space has no key \"b\"")
        );
        assert!(refused(dict(), json!([])).starts_with("expected an object"));
        let one_of = || OneOfSpace::new([Space::discrete(3)]).unwrap();
        assert!(
            refused(one_of(), json!([1, 0])).starts_with("[0]: there is no space of this index")
        );
        assert!(
            refused(one_of(), json!([0])).starts_with("expected a list of an index and a value")
        );
        let graph = GraphSpace::new(Space::discrete(3), None).unwrap();
        assert!(refused(graph, json!({})).starts_with("the key \"nodes\" is missing"));
        assert!(Space::from(pair()).to_json(&Value::Tuple(vec![])).is_err());
        assert!(Space::discrete(3).to_json(&Value::Null).is_err());
        assert!(Space::discrete(3).to_json(&Value::Int(7)).is_ok());
    }
}
