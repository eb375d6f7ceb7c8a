//! Conversions between Rust values and Python objects.

use std::ptr::null_mut;

use gym::render::{Depth, Frame, Rendered};
use gym::{Array, DType, Data, GraphInstance, Space, Value, with_type};
use numpy::npyffi::PY_ARRAY_API;
use numpy::{
    Element, IxDyn, PyArray, PyArray1, PyArrayDescrMethods, PyArrayDyn, PyArrayMethods,
    PyUntypedArrayMethods,
};
use pyo3::IntoPyObjectExt;
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{IntoPyDict, PyDict, PyFloat, PyInt, PyList, PyString, PyTuple};

/// A new numpy array of `numbers`.
pub(crate) fn new_array<'py, T: Element + Copy>(
    py: Python<'py>,
    shape: &[usize],
    numbers: &[T],
) -> Bound<'py, PyAny> {
    if let [_] = shape {
        return PyArray1::from_slice(py, numbers).into_any();
    }
    // SAFETY: the array was just allocated for that many numbers, and no other code has a reference
    // to it.
    unsafe {
        let array = PyArray::<T, IxDyn>::new(py, shape, false);
        array
            .as_slice_mut()
            .expect("a new array is contiguous")
            .copy_from_slice(numbers);
        array.into_any()
    }
}

/// Converts a number to a numpy scalar, such as `numpy.float64`.
pub(crate) fn scalar<T: Element + Copy>(
    py: Python<'_>,
    mut number: T,
) -> PyResult<Bound<'_, PyAny>> {
    let (data, dtype) = ((&raw mut number).cast(), numpy::dtype::<T>(py));
    // SAFETY: numpy reads a number of the type `T` at `data`, and returns a new reference, or null
    // with an exception set.
    unsafe {
        let made = PY_ARRAY_API.PyArray_Scalar(py, data, dtype.as_dtype_ptr(), null_mut());
        Bound::from_owned_ptr_or_err(py, made)
    }
}

/// A new numpy array.
pub(crate) fn array<'py>(py: Python<'py>, array: &Array) -> Bound<'py, PyAny> {
    with_type!(array.dtype(), T => new_array(py, array.shape(), array.as_slice::<T>().unwrap_or_default()))
}

/// A value in the form that Gymnasium's spaces and infos have.
pub(crate) fn to_python<'py>(py: Python<'py>, value: &Value) -> PyResult<Bound<'py, PyAny>> {
    Ok(match value {
        Value::Null => py.None().into_bound(py),
        Value::Bool(flag) => flag.into_bound_py_any(py)?,
        Value::Int(i) => i.into_bound_py_any(py)?,
        Value::Float(x) => x.into_bound_py_any(py)?,
        Value::Text(text) => PyString::new(py, text).into_any(),
        Value::Array(numbers) => array(py, numbers),
        Value::Tuple(items) => {
            let items = items
                .iter()
                .map(|item| to_python(py, item))
                .collect::<PyResult<Vec<_>>>()?;
            PyTuple::new(py, items)?.into_any()
        }
        Value::Dict(entries) => {
            let dict = PyDict::new(py);
            for (key, value) in entries {
                dict.set_item(key, to_python(py, value)?)?;
            }
            dict.into_any()
        }
        Value::Graph(graph) => {
            let edges = graph.edges.as_ref().map(|edges| to_python(py, edges));
            let links = graph.edge_links.as_ref().map(|links| array(py, links));
            let fields = (to_python(py, &graph.nodes)?, edges.transpose()?, links);
            py.import("gymnasium.spaces")?
                .getattr("GraphInstance")?
                .call1(fields)?
        }
        Value::OneOf(index, value) => (
            numpy(py)?.getattr("int64")?.call1((*index,))?,
            to_python(py, value)?,
        )
            .into_bound_py_any(py)?,
    })
}

/// Writes a value to the arrays of `old`, a value from an earlier call. Replaces arrays of another
/// type or shape.
pub(crate) fn refill<'py>(
    py: Python<'py>,
    value: &Value,
    old: Option<Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyAny>> {
    if let (Value::Array(numbers), Some(old)) = (value, old) {
        let reused = with_type!(numbers.dtype(), T => {
            let target = old.cast::<PyArrayDyn<T>>().ok().filter(|array| array.shape() == numbers.shape());
            match target.map(PyArrayMethods::try_readwrite) {
                Some(Ok(mut array)) => {
                    array.as_slice_mut()?.copy_from_slice(numbers.as_slice::<T>().unwrap_or_default());
                    true
                }
                _ => false,
            }
        });
        if reused {
            return Ok(old);
        }
    }
    to_python(py, value)
}

/// The result of `render`.
pub(crate) fn rendered<'py>(py: Python<'py>, rendered: &Rendered) -> PyResult<Bound<'py, PyAny>> {
    let frame = |frame: &Frame| {
        new_array(
            py,
            &[frame.height() as usize, frame.width() as usize, 3],
            frame.pixels(),
        )
    };
    let depth = |depth: &Depth| {
        let shape = [depth.height as usize, depth.width as usize];
        new_array(py, &shape, &depth.metres)
    };
    match rendered {
        Rendered::Shown => Ok(py.None().into_bound(py)),
        Rendered::Frame(picture) => Ok(frame(picture)),
        Rendered::Frames(pictures) => pictures
            .iter()
            .map(frame)
            .collect::<Vec<_>>()
            .into_bound_py_any(py),
        Rendered::Text(text) => text.into_bound_py_any(py),
        Rendered::Depth(metres) => Ok(depth(metres)),
        Rendered::Rgbd(picture, metres) => (frame(picture), depth(metres)).into_bound_py_any(py),
        Rendered::Texts(texts) => texts.into_bound_py_any(py),
    }
}

/// Converts a Python object to an action, or with `n` to a batch of `n` actions. Unlike in
/// [`from_python`], floats keep their precision, because Gymnasium computes in the precision of the
/// action.
pub(crate) fn action_from_python(
    space: &Space,
    batch: Option<(usize, &Space)>,
    object: &Bound<'_, PyAny>,
) -> PyResult<Value> {
    let inner = match space {
        Space::Box(inner) if inner.dtype().is_float() => inner,
        _ => return from_python(batch.map_or(space, |(_, batch)| batch), object),
    };
    let n = batch.map(|(n, _)| n);
    let shape: Vec<usize> = n.into_iter().chain(inner.shape().iter().copied()).collect();
    if let Ok(array) = object.cast::<PyArrayDyn<f32>>()
        && array.is_c_contiguous()
    {
        return read_array(object, DType::F32, Some(&shape)).map(Value::Array);
    }
    let array = numpy(object.py())?.call_method1("asarray", (object,))?;
    let single = ["f", "e"].contains(
        &array
            .getattr("dtype")?
            .getattr("char")?
            .extract::<String>()?
            .as_str(),
    );
    let dtype = if single { DType::F32 } else { DType::F64 };
    let numbers = read_array(&array, dtype, Some(&shape))?;
    if dtype == DType::F32 || !is_list_of_numbers(object)? {
        return Ok(Value::Array(numbers));
    }
    // numpy computes with a Python number in the precision of the other operand
    let row = inner.shape().iter().product::<usize>().max(1);
    let numbers: Vec<Value> = numbers.iter_f64().map(Value::Float).collect();
    Ok(Value::Tuple(match n {
        None => numbers,
        Some(_) => numbers
            .chunks(row)
            .map(|row| Value::Tuple(row.to_vec()))
            .collect(),
    }))
}

/// Whether an object is a list or tuple, possibly nested, whose first number is a Python `int` or
/// `float`.
fn is_list_of_numbers(object: &Bound<'_, PyAny>) -> PyResult<bool> {
    if object.is_instance_of::<PyList>() || object.is_instance_of::<PyTuple>() {
        return if object.len()? == 0 {
            Ok(false)
        } else {
            is_list_of_numbers(&object.get_item(0)?)
        };
    }
    Ok(object.is_exact_instance_of::<PyFloat>() || object.is_exact_instance_of::<PyInt>())
}

/// A Python object as an element of a space, by kind, type and shape. Bounds are not checked.
///
/// Numbers may be Python's, numpy's or lists, of any type that numpy's `same_kind` rule casts to
/// the space's type.
pub(crate) fn from_python(space: &Space, object: &Bound<'_, PyAny>) -> PyResult<Value> {
    let numbers = |dtype, shape: &[usize]| read_array(object, dtype, Some(shape)).map(Value::Array);
    match space {
        Space::Discrete(_) => object.extract().map(Value::Int),
        Space::Box(space) => numbers(space.dtype(), space.shape()),
        Space::MultiDiscrete(space) => numbers(space.dtype(), space.shape()),
        Space::MultiBinary(space) => numbers(DType::I8, space.shape()),
        Space::Text(_) | Space::Mission(_) => object.extract().map(Value::Text),
        Space::Tuple(space) => {
            let items = members(object, space.spaces().len())?;
            let items = space
                .spaces()
                .iter()
                .zip(&items)
                .map(|(space, item)| from_python(space, item));
            items.collect::<PyResult<_>>().map(Value::Tuple)
        }
        Space::Dict(space) => {
            let entries = space
                .spaces()
                .iter()
                .map(|(key, space)| Ok((key.clone(), from_python(space, &object.get_item(key)?)?)));
            entries.collect::<PyResult<_>>().map(Value::Dict)
        }
        Space::Sequence(space) => {
            let items = object
                .try_iter()?
                .map(|item| from_python(space.feature_space(), &item?));
            items.collect::<PyResult<_>>().map(Value::Tuple)
        }
        Space::Graph(space) => {
            let part = |name: &str| {
                object
                    .getattr(name)
                    .map(|part| (!part.is_none()).then_some(part))
            };
            let nodes =
                part("nodes")?.ok_or_else(|| PyTypeError::new_err("a graph needs nodes"))?;
            let edges = match (part("edges")?, space.edge_space()) {
                (Some(edges), Some(space)) => Some(batch_from_python(space, &edges)?),
                _ => None,
            };
            let links = part("edge_links")?.map(|links| read_array(&links, DType::I32, None));
            Ok(Value::Graph(Box::new(GraphInstance {
                nodes: batch_from_python(space.node_space(), &nodes)?,
                edges,
                edge_links: links.transpose()?,
            })))
        }
        Space::OneOf(space) => {
            let items = members(object, 2)?;
            let index: usize = items[0].extract()?;
            let chosen = space.spaces().get(index).ok_or_else(|| {
                PyValueError::new_err(format!(
                    "{index} is not the index of one of {} spaces",
                    space.spaces().len()
                ))
            })?;
            Ok(Value::OneOf(
                index,
                Box::new(from_python(chosen, &items[1])?),
            ))
        }
    }
}

/// Converts a Python object to a batch of elements of a space, such as the nodes of a graph.
fn batch_from_python(space: &Space, object: &Bound<'_, PyAny>) -> PyResult<Value> {
    match space {
        Space::Tuple(space) => {
            let items = members(object, space.spaces().len())?;
            let items = space.spaces().iter().zip(&items);
            let items = items.map(|(space, item)| batch_from_python(space, item));
            items.collect::<PyResult<_>>().map(Value::Tuple)
        }
        Space::Dict(space) => {
            let entries = space.spaces().iter().map(|(key, space)| {
                Ok((
                    key.clone(),
                    batch_from_python(space, &object.get_item(key)?)?,
                ))
            });
            entries.collect::<PyResult<_>>().map(Value::Dict)
        }
        _ => match space.dtype() {
            Some(dtype) => read_array(object, dtype, None).map(Value::Array),
            None => {
                let items = object.try_iter()?.map(|item| from_python(space, &item?));
                items.collect::<PyResult<_>>().map(Value::Tuple)
            }
        },
    }
}

/// Returns the members of a Python sequence; an error unless the sequence has `n` members.
fn members<'py>(object: &Bound<'py, PyAny>, n: usize) -> PyResult<Vec<Bound<'py, PyAny>>> {
    let items: Vec<_> = object.try_iter()?.collect::<PyResult<_>>()?;
    if items.len() == n {
        return Ok(items);
    }
    Err(PyValueError::new_err(format!(
        "{} members were given and {n} are needed",
        items.len()
    )))
}

/// The numbers of a Python array, list or number.
fn read_array(object: &Bound<'_, PyAny>, dtype: DType, shape: Option<&[usize]>) -> PyResult<Array> {
    with_type!(dtype, T => {
        let fits = |array: &Bound<'_, PyArrayDyn<T>>| shape.is_none_or(|shape| array.shape() == shape);
        let converted;
        let array = match object.cast::<PyArrayDyn<T>>() {
            Ok(array) if array.is_c_contiguous() => array,
            _ => {
                converted = convert(object, dtype)?;
                converted.cast::<PyArrayDyn<T>>()?
            }
        };
        if !fits(array) {
            let (found, needed) = (array.shape(), shape.unwrap_or_default());
            return Err(PyValueError::new_err(format!("its shape is {found:?} and should be {needed:?}")));
        }
        let numbers = array.try_readonly()?.as_slice()?.to_vec();
        Array::new(array.shape(), wrap(numbers)).map_err(|error| PyValueError::new_err(error.to_string()))
    })
}

fn wrap<T: gym::array::Scalar>(numbers: Vec<T>) -> Data {
    T::into_data(numbers)
}

/// `numpy.asarray(object).astype(dtype, order="C", casting="same_kind")`.
fn convert<'py>(object: &Bound<'py, PyAny>, dtype: DType) -> PyResult<Bound<'py, PyAny>> {
    let py = object.py();
    let options = [("order", "C"), ("casting", "same_kind")].into_py_dict(py)?;
    numpy(py)?.call_method1("asarray", (object,))?.call_method(
        "astype",
        (dtype.name(),),
        Some(&options),
    )
}

/// The module numpy.
pub(crate) fn numpy(py: Python<'_>) -> PyResult<&Bound<'_, PyModule>> {
    static NUMPY: PyOnceLock<Py<PyModule>> = PyOnceLock::new();
    Ok(NUMPY
        .get_or_try_init(py, || py.import("numpy").map(Bound::unbind))?
        .bind(py))
}
