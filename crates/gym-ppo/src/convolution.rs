//! Convolutions of images with kernels that are twice as wide as their stride.
//!
//! A kernel covers two by two blocks of the image, each as wide as the stride. So the image is cut
//! into blocks, one matrix product computes the parts that each block contributes to the four
//! outputs that overlap the block, and [`Overlap`] sums these parts. This avoids a copy of each
//! block per kernel. candle cannot differentiate these operations: [`Gradients`] holds their
//! gradients.

use std::iter::zip;

use candle_core::{CpuStorage, CustomOp1, CustomOp2, Device, Layout, Shape, Storage, Tensor, bail};

type Result<T> = candle_core::Result<T>;

/// Cuts images of bytes, `[n, channels, height, width]`, into blocks of numbers from 0 to 1, `[n,
/// height / side, width / side, channels * side * side]`. Remaining pixels at the right and at the
/// bottom are dropped.
pub(crate) fn blocks_of_bytes(pictures: &Tensor, side: usize) -> Result<Tensor> {
    pictures.apply_op1_no_bwd(&BlocksOfBytes { side })
}

/// Cuts images of numbers, `[n, height, width, channels]`, into blocks, `[n, height / side, width /
/// side, side * side * channels]`. Remaining pixels at the right and at the bottom are dropped.
pub(crate) fn blocks(x: &Tensor, side: usize) -> Result<Tensor> {
    let (n, height, width, channels) = x.dims4()?;
    let (rows, columns) = (height / side, width / side);
    let x = x
        .narrow(1, 0, rows * side)?
        .narrow(2, 0, columns * side)?
        .contiguous()?;
    let x = x
        .reshape((n, rows, side, columns, side * channels))?
        .transpose(2, 3)?;
    x.reshape((n, rows, columns, side * side * channels))
}

/// The inverse of [`blocks`]: assembles blocks to images of `shape`. The pixels that [`blocks`]
/// drops are zero.
pub(crate) fn picture(blocks: &Tensor, side: usize, shape: &Shape) -> Result<Tensor> {
    let (n, height, width, channels) = shape.dims4()?;
    let (rows, columns) = (height / side, width / side);
    let x = blocks
        .reshape((n, rows, columns, side, side * channels))?
        .transpose(2, 3)?;
    let x = x.reshape((n, rows * side, columns * side, channels))?;
    x.pad_with_zeros(1, 0, height - rows * side)?
        .pad_with_zeros(2, 0, width - columns * side)
}

/// Convolves blocks, `[n, rows, columns, size]`, adds `bias` and applies ReLU. The result is `[n,
/// rows - 1, columns - 1, channels]`.
///
/// `weights` is `[size, 4 * channels]`: for the block at the top left of each kernel, then the top
/// right, the bottom left and the bottom right. `bias` is `[channels]`.
pub(crate) fn convolve(blocks: &Tensor, weights: &Tensor, bias: &Tensor) -> Result<Tensor> {
    let (n, rows, columns, size) = blocks.dims4()?;
    let parts = blocks
        .reshape((n * rows * columns, size))?
        .matmul(weights)?;
    parts
        .reshape((n, rows, columns, weights.dim(1)?))?
        .apply_op2_no_bwd(bias, &Overlap)
}

/// The gradients of the arguments of [`convolve`], computed from the gradient of its result.
pub(crate) struct Gradients {
    /// The gradients of the blocks' parts, one row per block.
    parts: Tensor,
    pub(crate) weights: Tensor,
    pub(crate) bias: Tensor,
}

impl Gradients {
    pub(crate) fn new(blocks: &Tensor, result: &Tensor, gradient: &Tensor) -> Result<Self> {
        let (n, rows, columns, size) = blocks.dims4()?;
        let (parts, bias) = spread(rows, columns, result, &gradient.contiguous()?)?;
        let weights = blocks
            .reshape((n * rows * columns, size))?
            .t()?
            .matmul(&parts)?;
        Ok(Self {
            parts,
            weights,
            bias,
        })
    }

    /// Returns the gradients of the blocks.
    pub(crate) fn blocks(&self, weights: &Tensor) -> Result<Tensor> {
        self.parts.matmul(&weights.t()?)
    }
}

struct BlocksOfBytes {
    side: usize,
}

impl CustomOp1 for BlocksOfBytes {
    fn name(&self) -> &'static str {
        "blocks-of-bytes"
    }

    fn cpu_fwd(&self, storage: &CpuStorage, layout: &Layout) -> Result<(CpuStorage, Shape)> {
        let (n, channels, height, width) = layout.shape().dims4()?;
        let CpuStorage::U8(bytes) = storage else {
            bail!("the images are not bytes")
        };
        let Some((start, end)) = layout.contiguous_offsets() else {
            bail!("the images are not contiguous")
        };
        let side = self.side;
        let (rows, columns) = (height / side, width / side);
        let size = channels * side * side;
        let mut all = vec![0f32; n * rows * columns * size];
        let lines = bytes[start..end].chunks_exact(width).enumerate();
        for (line, pixels) in lines {
            let (picture, y) = (line / height, line % height);
            let (n, channel) = (picture / channels, picture % channels);
            if y / side == rows {
                continue;
            }
            let first = (n * rows + y / side) * columns * size + (channel * side + y % side) * side;
            for (column, pixels) in pixels.chunks_exact(side).enumerate() {
                let numbers = &mut all[first + column * size..][..side];
                for (number, pixel) in zip(numbers, pixels) {
                    *number = f32::from(*pixel) * (1.0 / 255.0);
                }
            }
        }
        Ok((CpuStorage::F32(all), (n, rows, columns, size).into()))
    }
}

/// For each output: sums the parts of its four overlapping blocks, adds the bias, applies ReLU. The
/// parts are `[n, rows, columns, 4 * channels]`, the bias `[channels]`.
struct Overlap;

/// The row and column of each quarter of a kernel, relative to its block at the top left.
const QUARTERS: [(usize, usize); 4] = [(0, 0), (0, 1), (1, 0), (1, 1)];

impl CustomOp2 for Overlap {
    fn name(&self) -> &'static str {
        "overlap"
    }

    fn cpu_fwd(
        &self,
        parts: &CpuStorage,
        parts_layout: &Layout,
        bias: &CpuStorage,
        bias_layout: &Layout,
    ) -> Result<(CpuStorage, Shape)> {
        let (n, rows, columns, size) = parts_layout.shape().dims4()?;
        let (parts, bias) = (slice(parts, parts_layout)?, slice(bias, bias_layout)?);
        let channels = bias.len();
        let mut sums = Vec::with_capacity(n * (rows - 1) * (columns - 1) * channels);
        for picture in parts.chunks_exact(rows * columns * size) {
            for (y, x) in outputs(rows, columns) {
                let [a, b, c, d] = [0, 1, 2, 3].map(|quarter| {
                    let (down, right) = QUARTERS[quarter];
                    &picture[((y + down) * columns + x + right) * size + quarter * channels..]
                        [..channels]
                });
                sums.extend((0..channels).map(|i| (bias[i] + a[i] + b[i] + c[i] + d[i]).max(0.0)));
            }
        }
        Ok((
            CpuStorage::F32(sums),
            (n, rows - 1, columns - 1, channels).into(),
        ))
    }
}

/// The backward pass of [`Overlap`]: returns the gradients of its parts (one row per block) and of
/// its bias, from its result `sums` and the gradient of the result.
fn spread(
    rows: usize,
    columns: usize,
    sums: &Tensor,
    gradient: &Tensor,
) -> Result<(Tensor, Tensor)> {
    let (n, _, _, channels) = sums.dims4()?;
    let size = 4 * channels;
    let (gradient, gradient_layout) = gradient.storage_and_layout();
    let (sums, sums_layout) = sums.storage_and_layout();
    let (Storage::Cpu(gradient), Storage::Cpu(sums)) = (&*gradient, &*sums) else {
        bail!("a gradient is not on the CPU")
    };
    let (gradient, sums) = (slice(gradient, gradient_layout)?, slice(sums, sums_layout)?);

    let mut of_parts = vec![0f32; n * rows * columns * size];
    let mut of_bias = vec![0f32; channels];
    let mut of_sum = vec![0f32; channels];
    let mut sums = zip(gradient.chunks_exact(channels), sums.chunks_exact(channels));
    for picture in of_parts.chunks_exact_mut(rows * columns * size) {
        for ((y, x), (gradient, sum)) in zip(outputs(rows, columns), &mut sums) {
            for i in 0..channels {
                of_sum[i] = if sum[i] > 0.0 { gradient[i] } else { 0.0 };
                of_bias[i] += of_sum[i];
            }
            for (quarter, (down, right)) in QUARTERS.into_iter().enumerate() {
                let start = ((y + down) * columns + x + right) * size + quarter * channels;
                picture[start..start + channels].copy_from_slice(&of_sum);
            }
        }
    }
    let of_parts = Tensor::from_vec(of_parts, (n * rows * columns, size), &Device::Cpu)?;
    Ok((of_parts, Tensor::new(of_bias, &Device::Cpu)?))
}

/// Iterates over the row and column of each output of an image with `rows` by `columns` blocks.
fn outputs(rows: usize, columns: usize) -> impl Iterator<Item = (usize, usize)> {
    (0..rows - 1).flat_map(move |y| (0..columns - 1).map(move |x| (y, x)))
}

fn slice<'a>(storage: &'a CpuStorage, layout: &Layout) -> Result<&'a [f32]> {
    match (storage, layout.contiguous_offsets()) {
        (CpuStorage::F32(numbers), Some((start, end))) => Ok(&numbers[start..end]),
        _ => bail!("the numbers are not contiguous float32"),
    }
}
