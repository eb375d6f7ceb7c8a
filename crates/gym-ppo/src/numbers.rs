//! Tensors as plain numbers, for storage.

use anyhow::{Result, ensure};
use candle_core::{Device, Tensor};

/// The numbers of a tensor, row by row.
pub(crate) type Numbers = Vec<f32>;

/// Returns the numbers of `tensor`.
pub(crate) fn of(tensor: &Tensor) -> candle_core::Result<Numbers> {
    tensor.flatten_all()?.to_vec1()
}

/// Returns a tensor with these numbers and the shape and dtype of `form`.
pub(crate) fn tensor(numbers: &[f32], form: &Tensor) -> Result<Tensor> {
    let (given, needed) = (numbers.len(), form.elem_count());
    ensure!(
        given == needed,
        "{given} numbers are stored where the agent has {needed}"
    );
    Ok(Tensor::from_slice(numbers, form.shape(), &Device::Cpu)?)
}
