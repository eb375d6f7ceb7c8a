#!/usr/bin/env python3
"""Ranks of any launcher: SLURM, MPI, torchrun. A seed gives the same samples, and a run the same policy, for any number of ranks.

    pip install ./crates/gym-python torch
    srun --ntasks 4 python launched_ranks.py --out FOLDER                   # SLURM; FOLDER is one that all nodes see
    torchrun --nproc-per-node 2 launched_ranks.py --out FOLDER              # or mpirun -n 2 python launched_ranks.py --out FOLDER
    python launched_ranks.py --ranks 1 2 4 --out FOLDER                     # without a launcher: starts them here, and compares

Rank `i` of `n` plays the seeds `seeds[i::n]` and writes a file. Then the ranks train a policy by an evolution strategy: each
plays its share of the candidates, the returns go round by torch.distributed (gloo), and every rank takes the same step.
"""

import argparse
import hashlib
import json
import os
import subprocess
import sys
import time
from pathlib import Path

os.environ.setdefault("OMP_NUM_THREADS", "1")

import numpy as np

import rustgym

parser = argparse.ArgumentParser()
parser.add_argument("--out", type=Path, required=True, help="a folder that all ranks see; it must not hold another run's files")
parser.add_argument("--env", default="HalfCheetah-v5")
parser.add_argument("--seeds", type=int, default=64, help="how many episodes are played")
parser.add_argument("--steps", type=int, default=500, help="the steps of each")
parser.add_argument("--generations", type=int, default=10)
parser.add_argument("--ranks", type=int, nargs="+", help="starts so many ranks on this machine, one number after the other")
arguments = parser.parse_args()


def variable(*names):
    """The first variable that a launcher has set: torchrun's, SLURM's, Open MPI's, MPICH's."""
    return next(int(os.environ[name]) for name in names if name in os.environ)


def play(seeds, weights):
    """The digest of the samples and the return of each seed, under linear policies with the `weights` of each."""
    envs = rustgym.make_vec(arguments.env, num_envs=len(seeds), max_episode_steps=-1)
    low, high = envs.single_action_space.low, envs.single_action_space.high
    digests, returns = [hashlib.sha256() for _ in seeds], np.zeros(len(seeds))
    observations, _ = envs.reset(seed=seeds)
    running = np.ones(len(seeds), bool)
    for _ in range(arguments.steps):
        # not `@`, whose last bit depends on the number of rows
        actions = np.tanh((weights * observations[:, None, :]).sum(axis=2)) * high
        observations, rewards, terminated, truncated, _ = envs.step(np.clip(actions, low, high).astype(np.float32))
        returns += rewards * running
        running &= ~terminated & ~truncated
        for i, digest in enumerate(digests):
            digest.update(observations[i].tobytes() + rewards[i].tobytes() + terminated[i].tobytes())
    envs.close()
    return [digest.hexdigest() for digest in digests], returns


def gather(mine, rank, count, total):
    """All values, of which this rank has `[rank::count]`."""
    import torch

    parts = [torch.zeros(len(range(i, total, count)), dtype=torch.float64) for i in range(count)]
    longest = max(map(len, parts))
    padded = torch.zeros(longest, dtype=torch.float64)
    padded[: len(mine)] = torch.as_tensor(mine)
    received = [torch.zeros(longest, dtype=torch.float64) for _ in parts]
    torch.distributed.all_gather(received, padded)
    values = np.empty(total)
    for i, part in enumerate(received):
        values[i::count] = part[: len(parts[i])].numpy()
    return values


def train(shape, rank, count, candidates=32, width=0.1, rate=0.05):
    """An evolution strategy with pairs of candidates. Every rank draws the same noise, and holds the same mean."""
    mean, generator = np.zeros(shape), np.random.default_rng(0)
    for generation in range(arguments.generations):
        noise = generator.normal(size=(candidates // 2, *shape))
        noise = np.concatenate([noise, -noise])
        mine = range(rank, candidates, count)
        _, returns = play([1000 + generation] * len(mine), mean + width * noise[mine])
        returns = gather(returns, rank, count, candidates)
        ranks = returns.argsort().argsort() / (candidates - 1) - 0.5
        mean = mean + rate / width * (ranks[:, None, None] * noise).mean(axis=0)
        if rank == 0:
            print(f"generation {generation + 1}: mean return {returns.mean():.1f}", flush=True)
    return mean


def main(rank, count):
    """What one rank does."""
    import torch.distributed

    seeds = list(range(arguments.seeds))[rank::count]
    space = rustgym.make(arguments.env)
    shape = (*space.action_space.shape, *space.observation_space.shape)
    weights = np.array([np.random.default_rng(seed).normal(size=shape) for seed in seeds])
    # the file is how the ranks find each other: no address or port is to be agreed on
    torch.distributed.init_process_group("gloo", init_method=f"file://{arguments.out.resolve()}/meeting", rank=rank, world_size=count)
    torch.distributed.barrier()
    start = time.perf_counter()
    digests, returns = play(seeds, weights)
    torch.distributed.barrier()
    seconds = time.perf_counter() - start
    mean = train(shape, rank, count)
    torch.distributed.destroy_process_group()
    result = {
        "seeds": {seed: [digest, value.item()] for seed, digest, value in zip(seeds, digests, returns, strict=True)},
        "policy": hashlib.sha256(mean.tobytes()).hexdigest(),
        "samples per second of all ranks": round(arguments.seeds * arguments.steps / seconds),
    }
    (arguments.out / f"rank-{rank}-of-{count}.json").write_text(json.dumps(result, indent=1))


def start_here(count):
    """Starts ranks as a launcher does; the digests of what they have in common."""
    out = arguments.out / f"{count}-ranks"
    out.mkdir(parents=True)
    command = [sys.executable, __file__, *sys.argv[1:], "--out", str(out)]
    variables = {**os.environ, "WORLD_SIZE": str(count)}
    started = [subprocess.Popen(command, env={**variables, "RANK": str(rank)}) for rank in range(count)]
    if failed := [rank for rank, process in enumerate(started) if process.wait() != 0]:
        sys.exit(f"ranks {failed} failed")
    results = [json.loads((out / f"rank-{rank}-of-{count}.json").read_text()) for rank in range(count)]
    seeds = {int(seed): value for result in results for seed, value in result["seeds"].items()}
    assert sorted(seeds) == list(range(arguments.seeds))
    assert len({result["policy"] for result in results}) == 1, "the ranks have come to different policies"
    print(f"{count} ranks: {results[0]['samples per second of all ranks']} samples per second", flush=True)
    return seeds, results[0]["policy"]


if __name__ == "__main__":
    if arguments.ranks and "RANK" not in os.environ:
        found = [start_here(count) for count in arguments.ranks]
        assert all(other == found[0] for other in found), "the samples or the policy depend on the number of ranks"
        print("the samples of each seed and the policy are the same")
    else:
        main(
            variable("RANK", "SLURM_PROCID", "OMPI_COMM_WORLD_RANK", "PMI_RANK"),
            variable("WORLD_SIZE", "SLURM_NTASKS", "OMPI_COMM_WORLD_SIZE", "PMI_SIZE"),
        )
