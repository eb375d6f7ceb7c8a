//! The networks: from observations to the policy's outputs and to values.

use std::iter::zip;

use anyhow::{bail, ensure};
use candle_core::backprop::GradStore;
use candle_core::{DType, Device, Tensor, Var};
use gym::{Generator, Space};

use crate::convolution::{self, blocks, blocks_of_bytes, convolve, picture};
use crate::numbers::{self, Numbers};

type Result<T> = candle_core::Result<T>;

/// Units of each hidden layer, for observations that are rows of numbers.
const HIDDEN: usize = 64;
/// Images per gradient computation: few enough that the activations fit the CPU's caches.
const PICTURES: usize = 32;

/// The policy and value networks. For observations of numbers, the two networks have equal shapes.
/// For images, both are a linear layer on the features of a shared encoder.
pub(crate) struct Network {
    encoder: Option<Encoder>,
    policy: Layers,
    value: Layers,
}

impl Network {
    /// Returns a network for the space `observation`, whose policy has `outputs` outputs.
    pub(crate) fn new(
        observation: &Space,
        outputs: usize,
        rng: &mut Generator,
    ) -> anyhow::Result<Self> {
        // a small gain makes the initial policy nearly uniform, so the agent explores
        let (policy_gain, value_gain) = (0.01, 1.0);
        match observation {
            Space::Box(space) if space.dtype() == gym::DType::U8 && space.shape().len() == 3 => {
                let encoder =
                    Encoder::new([space.shape()[0], space.shape()[1], space.shape()[2]], rng)?;
                let mut head = |outputs, gain| {
                    Ok::<_, candle_core::Error>(Layers(vec![Layer::orthogonal(
                        FEATURES, outputs, gain, rng,
                    )?]))
                };
                Ok(Self {
                    policy: head(outputs, policy_gain)?,
                    value: head(1, value_gain)?,
                    encoder: Some(encoder),
                })
            }
            Space::Box(space) if space.dtype() == gym::DType::F32 && space.shape().len() == 1 => {
                let width = space.shape()[0];
                let policy = Layers::new([width, HIDDEN, HIDDEN, outputs], policy_gain, rng)?;
                let value = Layers::new([width, HIDDEN, HIDDEN, 1], value_gain, rng)?;
                Ok(Self {
                    encoder: None,
                    policy,
                    value,
                })
            }
            other => bail!(
                "the observations are {other}: this example needs a row of float32 numbers, or bytes in the form \
                 [channels, height, width]"
            ),
        }
    }

    /// Returns the policy's outputs, and the values.
    pub(crate) fn forward(&self, observations: &Tensor) -> Result<(Tensor, Tensor)> {
        self.judge(&self.features(observations)?)
    }

    /// Returns the policy's outputs.
    pub(crate) fn policy(&self, observations: &Tensor) -> Result<Tensor> {
        self.policy.forward(&self.features(observations)?)
    }

    /// Returns the value of each observation.
    pub(crate) fn values(&self, observations: &Tensor) -> Result<Tensor> {
        self.value
            .forward(&self.features(observations)?)?
            .squeeze(1)
    }

    fn features(&self, observations: &Tensor) -> Result<Tensor> {
        match &self.encoder {
            Some(encoder) => Ok(encoder.encode(observations)?.features),
            None => Ok(observations.clone()),
        }
    }

    fn judge(&self, features: &Tensor) -> Result<(Tensor, Tensor)> {
        Ok((
            self.policy.forward(features)?,
            self.value.forward(features)?.squeeze(1)?,
        ))
    }

    /// Returns the gradients of `loss`, a function of the policy's outputs and the values.
    pub(crate) fn gradients(
        &self,
        observations: &Tensor,
        loss: impl FnOnce(&Tensor, &Tensor) -> Result<Tensor>,
    ) -> Result<GradStore> {
        let gradients = |features: &Tensor| {
            let (outputs, values) = self.judge(features)?;
            loss(&outputs, &values)?.backward()
        };
        let Some(encoder) = &self.encoder else {
            return gradients(observations);
        };
        let activations = encoder.encode(observations)?;
        let features = Var::from_tensor(&activations.features)?;
        let mut gradients = gradients(&features)?;
        if let Some(of_features) = gradients.remove(&features) {
            for (variable, gradient) in zip(
                encoder.variables(),
                encoder.gradients(&activations, &of_features)?,
            ) {
                gradients.insert(variable, gradient);
            }
        }
        Ok(gradients)
    }

    /// Iterates over the policy's variables.
    pub(crate) fn policy_variables(&self) -> impl Iterator<Item = &Var> {
        self.encoder
            .iter()
            .flat_map(Encoder::variables)
            .chain(self.policy.variables())
    }

    /// Iterates over all variables, the policy's first.
    pub(crate) fn variables(&self) -> impl Iterator<Item = &Var> {
        self.policy_variables().chain(self.value.variables())
    }

    /// Replaces the policy's variables by `network`.
    pub(crate) fn set_policy(&self, network: &[Numbers]) -> anyhow::Result<()> {
        let (given, needed) = (network.len(), self.policy_variables().count());
        ensure!(
            given == needed,
            "the policy has {given} lists of numbers, and the network {needed}"
        );
        for (variable, numbers) in zip(self.policy_variables(), network) {
            variable.set(&numbers::tensor(numbers, variable)?)?;
        }
        Ok(())
    }

    /// Returns the number of observations whose gradients are best computed at once; `None` for the
    /// whole batch.
    pub(crate) fn portion(&self) -> Option<usize> {
        self.encoder.is_some().then_some(PICTURES)
    }
}

/// A linear layer.
struct Layer {
    /// `[inputs, outputs]`.
    weights: Var,
    bias: Var,
}

impl Layer {
    fn new(weights: Vec<f32>, inputs: usize, outputs: usize) -> Result<Self> {
        let weights = Tensor::from_vec(weights, (inputs, outputs), &Device::Cpu)?;
        let bias = Var::zeros(outputs, DType::F32, &Device::Cpu)?;
        Ok(Self {
            weights: Var::from_tensor(&weights)?,
            bias,
        })
    }

    /// Returns a layer with normally distributed weights.
    fn normal(inputs: usize, outputs: usize, gain: f64, rng: &mut Generator) -> Result<Self> {
        let scale = gain / (inputs as f64).sqrt();
        Self::new(
            (0..inputs * outputs)
                .map(|_| rng.normal(0.0, scale) as f32)
                .collect(),
            inputs,
            outputs,
        )
    }

    /// Returns a layer with orthogonal weights (Saxe et al., 2014).
    fn orthogonal(inputs: usize, outputs: usize, gain: f64, rng: &mut Generator) -> Result<Self> {
        let columns = orthogonal(outputs, inputs, gain, rng);
        let weights = (0..inputs).flat_map(|input| columns.iter().map(move |column| column[input]));
        Self::new(weights.collect(), inputs, outputs)
    }

    fn forward(&self, x: &Tensor) -> Result<Tensor> {
        x.matmul(self.weights.as_tensor())?
            .broadcast_add(self.bias.as_tensor())
    }

    fn variables(&self) -> [&Var; 2] {
        [&self.weights, &self.bias]
    }
}

/// Linear layers with tanh between them.
struct Layers(Vec<Layer>);

impl Layers {
    fn new(sizes: [usize; 4], last_gain: f64, rng: &mut Generator) -> Result<Self> {
        let gains = [2f64.sqrt(), 2f64.sqrt(), last_gain];
        let layers = zip(sizes.windows(2), gains);
        Ok(Self(
            layers
                .map(|(sizes, gain)| Layer::normal(sizes[0], sizes[1], gain, rng))
                .collect::<Result<_>>()?,
        ))
    }

    fn forward(&self, x: &Tensor) -> Result<Tensor> {
        let mut x = x.clone();
        for (i, layer) in self.0.iter().enumerate() {
            x = layer.forward(&if i == 0 { x } else { x.tanh()? })?;
        }
        Ok(x)
    }

    fn variables(&self) -> impl Iterator<Item = &Var> {
        self.0.iter().flat_map(Layer::variables)
    }
}

/// The outputs of the dense layer of [`Encoder`].
const FEATURES: usize = 256;
/// For each convolution: its stride, which is half the width of its kernel, and its channels.
const CONVOLUTIONS: [(usize, usize); 2] = [(4, 16), (2, 32)];

/// Two convolutions and a dense layer: the network of Mnih et al., "Playing Atari with Deep
/// Reinforcement Learning" (2013).
struct Encoder {
    /// The weights of the convolutions have the layout that [`convolve`] takes.
    convolutions: [Layer; 2],
    dense: Layer,
}

impl Encoder {
    /// Returns an encoder for images with `channels`, `height` and `width`.
    fn new([channels, height, width]: [usize; 3], rng: &mut Generator) -> anyhow::Result<Self> {
        let [(side, first), (second_side, second)] = CONVOLUTIONS;
        let size = |pixels: usize| {
            ((pixels / side).checked_sub(1)? / second_side)
                .checked_sub(1)
                .filter(|n| *n > 0)
        };
        let (Some(rows), Some(columns)) = (size(height), size(width)) else {
            bail!("images of {height}x{width} are too small for the convolutions");
        };
        let gain = 2f64.sqrt();
        let mut convolution = |size: usize, outputs: usize| {
            // a kernel is a column of weights, made of its four quarters one after another
            let kernels = orthogonal(outputs, 4 * size, gain, rng);
            let weights = (0..size).flat_map(|i| {
                let kernels = &kernels;
                (0..4).flat_map(move |quarter| {
                    kernels.iter().map(move |kernel| kernel[quarter * size + i])
                })
            });
            let weights = Tensor::from_vec(weights.collect(), (size, 4 * outputs), &Device::Cpu)?;
            let bias = Var::zeros(outputs, DType::F32, &Device::Cpu)?;
            Ok::<_, candle_core::Error>(Layer {
                weights: Var::from_tensor(&weights)?,
                bias,
            })
        };
        let convolutions = [
            convolution(channels * side * side, first)?,
            convolution(first * second_side * second_side, second)?,
        ];
        let dense = Layer::orthogonal(rows * columns * second, FEATURES, gain, rng)?;
        Ok(Self {
            convolutions,
            dense,
        })
    }

    fn encode(&self, pictures: &Tensor) -> Result<Activations> {
        let [(side, _), (second_side, _)] = CONVOLUTIONS;
        let [
            (first, first_bias),
            (second, second_bias),
            (dense, dense_bias),
        ] = self.tensors();
        let first_blocks = blocks_of_bytes(pictures, side)?;
        let first = convolve(&first_blocks, &first, &first_bias)?;
        let second_blocks = blocks(&first, second_side)?;
        let second = convolve(&second_blocks, &second, &second_bias)?;
        let features = second
            .flatten_from(1)?
            .matmul(&dense)?
            .broadcast_add(&dense_bias)?
            .relu()?;
        Ok(Activations {
            first_blocks,
            first,
            second_blocks,
            second,
            features,
        })
    }

    /// Returns the gradients of the variables, computed from the features' gradients. candle's own
    /// backward pass is slower, because it adds each gradient to a tensor of zeros, and also
    /// computes gradients of the images.
    fn gradients(&self, activations: &Activations, of_features: &Tensor) -> Result<[Tensor; 6]> {
        let [_, (second_side, _)] = CONVOLUTIONS;
        let [_, (second, _), (dense, _)] = self.tensors();
        let of_features = (of_features * activations.features.gt(0f32)?.to_dtype(DType::F32)?)?;
        let of_dense = activations
            .second
            .flatten_from(1)?
            .t()?
            .matmul(&of_features)?;
        let of_second = of_features
            .matmul(&dense.t()?)?
            .reshape(activations.second.shape())?;
        let of_second = convolution::Gradients::new(
            &activations.second_blocks,
            &activations.second,
            &of_second,
        )?;
        let of_first = picture(
            &of_second.blocks(&second)?,
            second_side,
            activations.first.shape(),
        )?;
        let of_first =
            convolution::Gradients::new(&activations.first_blocks, &activations.first, &of_first)?;
        let of_dense_bias = of_features.sum(0)?;
        Ok([
            of_first.weights,
            of_first.bias,
            of_second.weights,
            of_second.bias,
            of_dense,
            of_dense_bias,
        ])
    }

    /// Returns weights and bias of each layer, detached, so that candle computes no gradients.
    fn tensors(&self) -> [(Tensor, Tensor); 3] {
        let [first, second] = &self.convolutions;
        [first, second, &self.dense].map(|layer| (layer.weights.detach(), layer.bias.detach()))
    }

    fn variables(&self) -> impl Iterator<Item = &Var> {
        self.convolutions
            .iter()
            .chain([&self.dense])
            .flat_map(Layer::variables)
    }
}

/// The activations of the layers for a batch of images.
struct Activations {
    first_blocks: Tensor,
    first: Tensor,
    second_blocks: Tensor,
    second: Tensor,
    features: Tensor,
}

/// Returns `count` vectors of `length` numbers. The vectors are orthogonal if `count <= length`.
/// Otherwise the columns are orthogonal; a column has the same component of every vector.
fn orthogonal(count: usize, length: usize, gain: f64, rng: &mut Generator) -> Vec<Vec<f32>> {
    if count > length {
        let components = orthogonal(length, count, gain, rng);
        return (0..count)
            .map(|i| components.iter().map(|component| component[i]).collect())
            .collect();
    }
    let mut vectors: Vec<Vec<f64>> = Vec::with_capacity(count);
    for _ in 0..count {
        let mut vector: Vec<f64> = (0..length).map(|_| rng.standard_normal()).collect();
        let dot = |a: &[f64], b: &[f64]| zip(a, b).map(|(a, b)| a * b).sum::<f64>();
        for other in &vectors {
            let along = dot(&vector, other);
            zip(&mut vector, other).for_each(|(x, other)| *x -= along * other);
        }
        let norm = dot(&vector, &vector).sqrt();
        vector.iter_mut().for_each(|x| *x /= norm);
        vectors.push(vector);
    }
    vectors
        .iter()
        .map(|vector| vector.iter().map(|x| (gain * x) as f32).collect())
        .collect()
}

#[cfg(test)]
mod tests {
    use gym::spaces::BoxSpace;

    use super::*;

    fn pictures(rng: &mut Generator) -> Tensor {
        // sizes that leave a remainder of pixels in both directions, and in one direction in the
        // second convolution
        let bytes: Vec<u8> = (0..3 * 2 * 34 * 37)
            .map(|_| rng.integers(0, 256) as u8)
            .collect();
        Tensor::from_vec(bytes, (3, 2, 34, 37), &Device::Cpu).unwrap()
    }

    fn network(rng: &mut Generator) -> Network {
        let space = BoxSpace::uniform(0.0, 255.0, [2, 34, 37], gym::DType::U8).unwrap();
        Network::new(&Space::Box(space), 3, rng).unwrap()
    }

    /// The result of [`Encoder::encode`], computed with candle's own convolution.
    fn encode(encoder: &Encoder, pictures: &Tensor) -> Result<Tensor> {
        let mut x = (pictures.to_dtype(DType::F32)? / 255.0)?;
        // the positions of channel, row and column in a block's layout
        let orders = [[0, 1, 2], [2, 0, 1]];
        for ((layer, (side, outputs)), [channel, row, column]) in
            encoder.convolutions.iter().zip(CONVOLUTIONS).zip(orders)
        {
            let (_, channels, height, width) = x.dims4()?;
            // candle cannot differentiate a convolution that leaves a remainder of pixels
            let x_used = x
                .narrow(2, 0, height / side * side)?
                .narrow(3, 0, width / side * side)?;
            let mut sizes = [0; 3];
            (sizes[channel], sizes[row], sizes[column]) = (channels, side, side);
            // [.., .., .., down, right, output] to [output, channel, down, y, right, x]
            let kernels = layer
                .weights
                .reshape((sizes[0], sizes[1], sizes[2], 2, 2, outputs))?;
            let kernels = kernels.permute([5, channel, 3, row, 4, column])?;
            let kernels = kernels.reshape((outputs, channels, 2 * side, 2 * side))?;
            let bias = layer.bias.reshape((1, outputs, 1, 1))?;
            x = x_used
                .conv2d(&kernels, 0, side, 1, 1)?
                .broadcast_add(&bias)?
                .relu()?;
        }
        encoder
            .dense
            .forward(&x.permute([0, 2, 3, 1])?.flatten_from(1)?)?
            .relu()
    }

    fn largest(x: &Tensor) -> f32 {
        x.abs()
            .unwrap()
            .flatten_all()
            .unwrap()
            .max(0)
            .unwrap()
            .to_scalar()
            .unwrap()
    }

    #[test]
    fn values_and_gradients_are_those_of_candles_convolutions() {
        let mut rng = Generator::from(7);
        let (network, pictures) = (network(&mut rng), pictures(&mut rng));
        for variable in network.variables().filter(|variable| variable.rank() == 1) {
            let bias = (0..variable.elem_count()).map(|_| rng.normal(0.0, 0.1) as f32);
            variable
                .set(&Tensor::from_iter(bias, &Device::Cpu).unwrap())
                .unwrap();
        }
        let loss = |outputs: &Tensor, values: &Tensor| {
            (outputs.sqr()? * 1e4)?.sum_all()? + values.sqr()?.sum_all()?
        };
        let gradients = network.gradients(&pictures, loss).unwrap();

        let features = encode(network.encoder.as_ref().unwrap(), &pictures).unwrap();
        let (outputs, values) = network.judge(&features).unwrap();
        let (our_outputs, our_values) = network.forward(&pictures).unwrap();
        assert!(largest(&(&our_outputs - &outputs).unwrap()) < 1e-4 * largest(&outputs));
        assert!(largest(&(&our_values - &values).unwrap()) < 1e-4 * largest(&values));
        let expected = loss(&outputs, &values).unwrap().backward().unwrap();
        for variable in network.variables() {
            let (ours, candles) = (
                gradients.get(variable).unwrap(),
                expected.get(variable).unwrap(),
            );
            assert!(largest(candles) > 0.0);
            assert!(
                largest(&(ours - candles).unwrap()) < 1e-4 * largest(candles),
                "{:?}",
                variable.shape()
            );
        }
    }

    #[test]
    fn orthogonal_vectors_are() {
        for (count, length) in [(5, 9), (9, 5), (4, 4)] {
            let vectors = orthogonal(count, length, 3.0, &mut Generator::from(1));
            assert_eq!((vectors.len(), vectors[0].len()), (count, length));
            let small = count.min(length);
            let component = |i: usize, j: usize| {
                if count < length {
                    vectors[i][j]
                } else {
                    vectors[j][i]
                }
            };
            for (i, j) in (0..small).flat_map(|i| (0..small).map(move |j| (i, j))) {
                let dot: f32 = (0..count.max(length))
                    .map(|k| component(i, k) * component(j, k))
                    .sum();
                assert!(
                    (dot - if i == j { 9.0 } else { 0.0 }).abs() < 1e-4,
                    "{i} {j}: {dot}"
                );
            }
        }
    }

    #[test]
    fn other_observations_are_refused() {
        for (shape, dtype, message) in [
            (vec![1, 8, 40], gym::DType::U8, "8x40 are too small"),
            (vec![40, 40], gym::DType::U8, "this example needs"),
            (vec![3], gym::DType::F64, "this example needs"),
        ] {
            let space = Space::Box(BoxSpace::uniform(0.0, 1.0, shape, dtype).unwrap());
            let error = Network::new(&space, 2, &mut Generator::from(0))
                .err()
                .unwrap()
                .to_string();
            assert!(error.contains(message), "{error}");
        }
    }
}
