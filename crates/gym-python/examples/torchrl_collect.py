#!/usr/bin/env python3
"""TorchRL: an environment by name, a vector as a batch, and collectors on the nodes of Ray.

    pip install ./crates/gym-python torchrl "ray[default]"    # on each node
    python torchrl_collect.py                     # two nodes on this machine
    python torchrl_collect.py --address auto      # the nodes of a cluster that runs

Collects the same episodes in this process and by one, two and four of Ray's collectors, which share the seeds, and compares them.
"""

import argparse
import hashlib
import os
import time

os.environ.setdefault("OMP_NUM_THREADS", "1")

import ray
import torch
from ray.cluster_utils import Cluster
from tensordict.nn import TensorDictModule
from torchrl.collectors import Collector
from torchrl.collectors.distributed import RayCollector
from torchrl.envs import GymEnv, GymWrapper

parser = argparse.ArgumentParser()
parser.add_argument("--address", help="of a cluster that runs; without it two nodes are started here")
parser.add_argument("--env", default="HalfCheetah-v5")
parser.add_argument("--envs", type=int, default=16, help="how many environments there are in all")
parser.add_argument("--steps", type=int, default=200, help="the steps of each in a batch")
parser.add_argument("--batches", type=int, default=5)
parser.add_argument("--collectors", type=int, nargs="+", default=[1, 2, 4], help="how many of Ray's share the seeds, one number after the other")
arguments = parser.parse_args()
SEED = 100


class Batch:
    """Makes a vector of environments with seeds from `seed` on; the import happens in the process that makes it."""

    def __init__(self, env, seed, count):
        self.env, self.seed, self.count = env, seed, count

    def __call__(self):
        import rustgym

        # TorchRL resets the environments itself
        env = GymWrapper(rustgym.make_vec(self.env, num_envs=self.count, autoreset_mode="Disabled"))
        env.set_seed(self.seed)
        return env


class Act(torch.nn.Module):
    """A policy that depends only on the observation of each environment."""

    def __init__(self, actions):
        super().__init__()
        self.actions = actions

    def forward(self, observation):
        return torch.tanh(observation[..., -self.actions :]).to(torch.float32)


def digests(batch):
    """The digest of each environment's samples; Ray's collectors give batches of shape (collectors, environments, steps)."""
    keys = ["observation", "action", ("next", "observation"), ("next", "reward"), ("next", "done")]
    rows = [b"".join(row[key].contiguous().numpy().tobytes() for key in keys) for row in batch.flatten(0, -2).unbind(0)]
    return sorted(hashlib.sha256(row).hexdigest() for row in rows)


def collected(collector):
    """The digests of all batches, and the samples per second after the first batch, which starts everything."""
    found, start, samples = [], None, 0
    for batch in collector:
        if start is None:
            start = time.perf_counter()
        else:
            samples += batch.numel()  # of all environments
        found.append(digests(batch))
    return found, samples / (time.perf_counter() - start)


def sample(count, policy):
    """Collects by `count` of Ray's collectors, each with its share of the seeds; in this process with none."""
    size = arguments.envs // max(count, 1)
    makers = [Batch(arguments.env, SEED + i * size, size) for i in range(max(count, 1))]
    frames = arguments.envs * arguments.steps
    given = {"frames_per_batch": frames, "total_frames": arguments.batches * frames}
    if count == 0:
        collector = Collector(makers[0], policy, **given)
    else:
        resources = {"num_cpus": 1, "num_gpus": 0, "memory": 256 * 1024**2, "scheduling_strategy": "SPREAD"}
        collector = RayCollector(
            makers, policy, num_collectors=count, sync=True, remote_configs=resources,
            ray_init_config={"address": arguments.address, "ignore_reinit_error": True}, **given,
        )
    found, rate = collected(collector)
    collector.shutdown(shutdown_ray=False) if count else collector.shutdown()
    return found, rate


if __name__ == "__main__":
    cluster = None
    if arguments.address is None:
        cluster = Cluster(initialize_head=True, head_node_args={"num_cpus": 2, "include_dashboard": False})
        cluster.add_node(num_cpus=2)
        arguments.address = cluster.address
    ray.init(address=arguments.address)

    single = GymEnv(f"rustgym:rustgym/{arguments.env}")
    print("by name, 20 steps:", single.rollout(20).shape)
    policy = TensorDictModule(Act(single.action_spec.shape[-1]), in_keys=["observation"], out_keys=["action"])
    expected, rate = sample(0, policy)
    print(f"in this process: {rate:.0f} samples per second")
    for count in arguments.collectors:
        found, rate = sample(count, policy)
        assert found == expected, "a seed gave other samples"
        print(f"{count} collectors: {rate:.0f} samples per second, the samples of each seed are the same")
    ray.shutdown()
    if cluster is not None:
        cluster.shutdown()
