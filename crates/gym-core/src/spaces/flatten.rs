//! Elements as one row of numbers: Gymnasium's `flatten` and `unflatten`.

use super::batch::{concatenate, iterate};
use super::{MultiBinary, Space};
use crate::value::array::Array;
use crate::value::fault::{Fault, expect_array};
use crate::value::number::{Number, Numeric, collect, with_type};
use crate::value::{GraphInstance, Result, Value};

impl Space {
    /// An element as one row of numbers, in the type of [`flatten_space`](Self::flatten_space).
    ///
    /// Integers become one-hot, members of tuples and dicts follow each other, a text becomes the
    /// numbers of its characters, filled up with the size of the set, and `OneOf` its index, then
    /// the element, filled up with its first number. Of spaces that are not
    /// [flattenable](Self::is_flattenable), each member is flattened.
    ///
    /// ```
    /// use gym_core::{Space, Value, spaces::TupleSpace};
    /// let space = Space::from(TupleSpace::new([Space::discrete(3), Space::boxed([0.0], [1.0])]));
    /// let element = Value::Tuple(vec![Value::Int(1), Value::Array([0.5f32].into())]);
    /// let flat = space.flatten(&element)?;
    /// assert_eq!(flat, Value::Array([0.0, 1.0, 0.0, 0.5].into()));
    /// assert_eq!(space.unflatten(&flat)?, element);
    /// # Ok::<(), gym_core::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::NotInSpace`](crate::Error::NotInSpace) if the value is not an element (numbers of a
    /// `Box` may be out of bounds); [`Error::InvalidSpace`](crate::Error::InvalidSpace) as
    /// `flatten_space`.
    pub fn flatten(&self, value: &Value) -> Result<Value> {
        if !self.is_flattenable() {
            return self.convert(value, self, &self.flatten_space()?, Self::flatten);
        }
        let mut array = Array::zeros(self.flat_dtype()?, [self.flatdim()?])?;
        self.flatten_into(value, &mut array)?;
        Ok(Value::Array(array))
    }

    /// [`flatten`](Self::flatten) into an array of that type and length.
    ///
    /// # Errors
    /// The errors of [`flatten`](Self::flatten).
    pub fn flatten_into(&self, value: &Value, out: &mut Array) -> Result<()> {
        let written = with_type!(out.dtype(), T => {
            self.write_flat(value, out.as_mut_slice::<T>().unwrap_or_default())
        });
        written.map_err(|fault| self.refuse(value, &fault))
    }

    /// Converts a row from [`flatten`](Self::flatten) back to the element, with its types.
    ///
    /// Integers beyond 2^53 that were flattened together with real numbers are rounded.
    ///
    /// # Errors
    /// [`Error::NotInSpace`](crate::Error::NotInSpace) if the length is wrong, or the one-hot part
    /// of an integer has no 1; [`Error::InvalidSpace`](crate::Error::InvalidSpace) as
    /// [`flatten_space`](Self::flatten_space).
    pub fn unflatten(&self, flat: &Value) -> Result<Value> {
        let flat_space = self.flatten_space()?;
        if !self.is_flattenable() {
            return self.convert(flat, &flat_space, self, Self::unflatten);
        }
        let read = || {
            let Value::Array(array) = flat else {
                return Err(Fault::kind("an array", flat));
            };
            let array = expect_array(flat, flat_space.shape().unwrap_or_default(), array.dtype())?;
            with_type!(array.dtype(), T => self.read_flat(array.as_slice::<T>().unwrap_or_default()))
        };
        read().map_err(|fault| flat_space.refuse(flat, &fault))
    }

    /// Writes the flat form of `value` to `out`, which has its length.
    fn write_flat<T: Numeric>(&self, value: &Value, mut out: &mut [T]) -> Result<(), Fault> {
        let int = |i: usize| T::cast(Number::Int(i as i128));
        let mut next = |space: &Self| {
            let len = space.flat_len().unwrap_or_default();
            out.split_off_mut(..len).unwrap_or_default()
        };
        match self {
            Self::Box(space) => {
                let array = expect_array(value, space.shape(), space.dtype())?;
                write_numbers(array, next(self));
            }
            Self::MultiBinary(space) => {
                space.check(value)?;
                value
                    .as_array()
                    .into_iter()
                    .for_each(|array| write_numbers(array, next(self)));
            }
            Self::Discrete(space) => {
                space.check(value)?;
                let out = next(self);
                out.fill(int(0));
                out[(value.as_int().unwrap_or_default() - space.start()) as usize] = int(1);
            }
            Self::MultiDiscrete(space) => {
                space.check(value)?;
                let out = next(self);
                out.fill(int(0));
                let numbers = value
                    .as_array()
                    .into_iter()
                    .flat_map(|array| Number::all(array.data()));
                let mut offset = 0;
                for (x, (n, start)) in numbers.zip(space.nvec().iter().zip(space.start())) {
                    let index = x.to_int().unwrap_or_default() - i128::from(*start);
                    out[offset + index as usize] = int(1);
                    offset += *n as usize;
                }
            }
            Self::Text(space) => {
                space.check(value)?;
                let out = next(self);
                out.fill(int(space.charset().len()));
                let indices = value
                    .as_text()
                    .into_iter()
                    .flat_map(str::chars)
                    .filter_map(|c| space.index(c));
                out.iter_mut()
                    .zip(indices)
                    .for_each(|(out, index)| *out = int(index));
            }
            Self::Tuple(space) => {
                space.each(value, |space, member| space.write_flat(member, next(space)))?;
            }
            Self::Dict(space) => {
                space.each(value, |space, member| space.write_flat(member, next(space)))?;
            }
            Self::OneOf(space) => {
                let (index, space, member) = space.chosen(value)?;
                let [first, rest @ ..] = next(self) else {
                    return Ok(());
                };
                *first = int(index);
                let (flat, padding) = rest.split_at_mut(space.flat_len().unwrap_or_default());
                space
                    .write_flat(member, flat)
                    .map_err(|fault| fault.at(1))?;
                // an element without numbers is filled up with zeros, which the flat space includes
                padding.fill(flat.first().copied().unwrap_or(int(0)));
            }
            Self::Sequence(_) | Self::Graph(_) | Self::Mission(_) => {
                return Err(Fault::new("it does not flatten to an array"));
            }
        }
        Ok(())
    }

    /// The element whose flat form is `row`.
    fn read_flat<T: Numeric>(&self, mut flat: &[T]) -> Result<Value, Fault> {
        let array = |shape: &[usize], dtype| {
            let array = Array::new(shape, collect(dtype, flat.iter().map(|x| x.number())));
            array
                .map(Value::Array)
                .map_err(|error| Fault::new(error.to_string()))
        };
        let is_set = |x: &T| x.to_f64() != 0.0;
        match self {
            Self::Box(space) => array(space.shape(), space.dtype()),
            Self::MultiBinary(space) => array(space.shape(), MultiBinary::DTYPE),
            Self::Discrete(space) => match flat.iter().position(is_set) {
                Some(index) => Ok(Value::Int(space.start() + index as i64)),
                None => Err(Fault::new(
                    "exactly one of its numbers must be 1, but none is",
                )),
            },
            Self::MultiDiscrete(space) => {
                let mut numbers = Vec::new();
                for (i, (&n, &start)) in space.nvec().iter().zip(space.start()).enumerate() {
                    let part = flat.split_off(..n as usize).unwrap_or_default();
                    match part.iter().position(is_set) {
                        Some(index) if !part[index + 1..].iter().any(is_set) => {
                            numbers.push(start + index as i64);
                        }
                        _ => {
                            let reason = "exactly one of its numbers must be 1, and the others 0";
                            return Err(Fault::new(reason).at_element(i, space.shape()));
                        }
                    }
                }
                Ok(Value::Array(space.array(&numbers)))
            }
            Self::Text(space) => {
                let end = space.charset().len() as i128;
                let numbers = flat
                    .iter()
                    .map(|x| Number::Float(x.to_f64().trunc()).to_int());
                let characters = numbers.filter(|number| *number != Some(end)).map(|number| {
                    let index = number.and_then(|number| usize::try_from(number).ok());
                    let unknown = || Fault::new(format!("a number is not between 0 and {end}"));
                    index
                        .and_then(|index| space.charset().get(index))
                        .ok_or_else(unknown)
                });
                characters.collect::<Result<_, _>>().map(Value::Text)
            }
            Self::Tuple(space) => {
                let values = space
                    .spaces()
                    .iter()
                    .enumerate()
                    .map(|(i, space)| space.read_next(&mut flat).map_err(|fault| fault.at(i)));
                values.collect::<Result<_, _>>().map(Value::Tuple)
            }
            Self::Dict(space) => {
                let values = space.spaces().iter().map(|(key, space)| {
                    let value = space
                        .read_next(&mut flat)
                        .map_err(|fault| fault.under(key))?;
                    Ok((key.clone(), value))
                });
                values.collect::<Result<_, _>>().map(Value::Dict)
            }
            Self::OneOf(space) => {
                let index = flat.split_off_first().map_or(-1.0, |index| index.to_f64());
                match space.spaces().get(index as usize) {
                    Some(space) if index >= 0.0 => {
                        let value = space.read_next(&mut flat).map_err(|fault| fault.at(1))?;
                        Ok(Value::OneOf(index as usize, Box::new(value)))
                    }
                    _ => Err(Fault::new("the first number is not the index of a space")),
                }
            }
            Self::Sequence(_) | Self::Graph(_) | Self::Mission(_) => {
                Err(Fault::new("it does not flatten to an array"))
            }
        }
    }

    /// Removes the numbers of one element from the start of a row, and returns the element.
    fn read_next<T: Numeric>(&self, flat: &mut &[T]) -> Result<Value, Fault> {
        let len = self.flat_len().unwrap_or_default();
        self.read_flat(flat.split_off(..len).unwrap_or_default())
    }

    /// Converts an element of `from` to an element of `to`, for spaces whose flat form is not an
    /// array. `map` flattens or unflattens a member with the member's space.
    fn convert(
        &self,
        value: &Value,
        from: &Self,
        to: &Self,
        map: fn(&Self, &Value) -> Result<Value>,
    ) -> Result<Value> {
        let refuse = |fault: Fault| from.refuse(value, &fault);
        match (self, from, to) {
            (Self::Tuple(space), ..) => {
                let values = space
                    .members(value)
                    .map_err(refuse)?
                    .map(|(space, value)| map(space, value));
                values.collect::<Result<_>>().map(Value::Tuple)
            }
            (Self::Dict(space), ..) => {
                let members = space.members(value).map_err(refuse)?;
                let entries = space.spaces().iter().zip(members);
                let entries =
                    entries.map(|((key, _), (space, value))| Ok((key.clone(), map(space, value)?)));
                entries.collect::<Result<_>>().map(Value::Dict)
            }
            (Self::Sequence(space), Self::Sequence(from), Self::Sequence(to)) => {
                let items = from.items(value).map_err(refuse)?;
                let items = items.iter().map(|item| map(space.feature_space(), item));
                to.collect(items.collect::<Result<_>>()?).map_err(refuse)
            }
            (Self::Graph(space), Self::Graph(from), Self::Graph(to)) => {
                let Value::Graph(graph) = value else {
                    return Err(refuse(Fault::kind("a graph", value)));
                };
                let rows = |space: &Self, from: &Self, to: &Self, rows: &Value| -> Result<Value> {
                    let rows = iterate(from, rows).map_err(refuse)?;
                    let rows = rows
                        .iter()
                        .map(|row| map(space, row))
                        .collect::<Result<Vec<_>>>()?;
                    concatenate(to, &rows.iter().collect::<Vec<_>>()).map_err(refuse)
                };
                let nodes = rows(
                    space.node_space(),
                    from.node_space(),
                    to.node_space(),
                    &graph.nodes,
                )?;
                let edge_spaces = (space.edge_space(), from.edge_space(), to.edge_space());
                let edges = match (edge_spaces, &graph.edges) {
                    (_, None) => None,
                    ((Some(space), Some(from), Some(to)), Some(edges)) => {
                        Some(rows(space, from, to, edges)?)
                    }
                    _ => {
                        return Err(refuse(Fault::new(
                            "there are edges, but the space has none",
                        )));
                    }
                };
                let edge_links = graph.edge_links.clone();
                Ok(Value::Graph(Box::new(GraphInstance {
                    nodes,
                    edges,
                    edge_links,
                })))
            }
            _ => Err(refuse(Fault::new(
                "it contains a space that does not flatten to an array",
            ))),
        }
    }
}

fn write_numbers<T: Numeric>(array: &Array, out: &mut [T]) {
    match array.as_slice::<T>() {
        Some(numbers) => out.copy_from_slice(numbers),
        None => out
            .iter_mut()
            .zip(Number::all(array.data()))
            .for_each(|(out, x)| *out = T::cast(x)),
    }
}
