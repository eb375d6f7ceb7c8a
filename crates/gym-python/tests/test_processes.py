"""Threads and forks cause no crash, no wrong number and no hang."""

from __future__ import annotations

import multiprocessing
import os
import re
import signal
import sys
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import gymnasium
import numpy as np
import pytest

import rustgym

needs_fork = pytest.mark.skipif(not hasattr(os, "fork"), reason="there is no fork here")


@pytest.mark.parametrize("env_id", ["CartPole-v1", "LunarLander-v3", "CarRacing-v3"])
def test_one_environment_and_many_threads(env_id: str) -> None:
    arguments = {"continuous": False} if "CarRacing" in env_id else {}
    env = rustgym.Env(env_id, render_mode="rgb_array", **arguments)
    env.reset(seed=0)

    def use(i: int) -> int:
        for step in range(10):
            env.step(0) if step % 5 or i % 2 else env.reset(seed=i)
            if step == 3:
                assert env.render().any()
        return i

    with ThreadPoolExecutor(8) as threads:
        assert sorted(threads.map(use, range(8))) == list(range(8))
    env.reset(seed=5)
    twin = rustgym.Env(env_id, **arguments)
    assert np.array_equal(twin.reset(seed=5)[0], env.reset(seed=5)[0])


@pytest.mark.skipif(not hasattr(os, "sched_setaffinity"), reason="threads are not bound to cores here")
def test_a_pool_has_the_cores_of_who_made_it() -> None:
    folder = Path("/proc/self/task")
    cores, before = os.sched_getaffinity(0), set(folder.iterdir())
    one = max(cores)
    os.sched_setaffinity(0, {one})
    try:
        envs = rustgym.make_vec("CartPole-v1", num_envs=8, kind="async")
        envs.reset(seed=0)
        envs.step([0] * 8)
    finally:
        os.sched_setaffinity(0, cores)
    found = [re.findall(r"Cpus_allowed_list:\s*(\S+)", (task / "status").read_text()) for task in set(folder.iterdir()) - before]
    assert found == [[str(one)]]
    envs.close()


def test_a_vector_lets_other_threads_run() -> None:
    envs = rustgym.VectorEnv("CarRacing-v3", 8, kind="sync")
    envs.reset(seed=0)
    ticks, stop = [], threading.Event()

    def tick() -> None:
        while not stop.is_set():
            ticks.append(time.monotonic())
            time.sleep(0.0005)

    thread = threading.Thread(target=tick)
    thread.start()
    start = time.monotonic()
    envs.step(envs.action_space.sample())
    took = time.monotonic() - start
    stop.set()
    thread.join()
    during = sum(start <= t <= start + took for t in ticks)
    assert during >= 2, f"the other thread ran {during} times while a step took {took} s"


def in_child(work: str) -> int:
    """Forks, lets the child run a function of this module, and returns its exit status; ends it after 30 s."""
    pid = os.fork()
    if pid == 0:
        status = 1
        try:
            globals()[work]()
            status = 0
        except BaseException as error:  # noqa: BLE001 - after any error, the child process must not continue the tests
            print(repr(error), file=sys.stderr)
        finally:
            os._exit(status)
    deadline = time.monotonic() + 30
    while time.monotonic() < deadline:
        ended, status = os.waitpid(pid, os.WNOHANG)
        if ended:
            return os.waitstatus_to_exitcode(status)
        time.sleep(0.01)
    os.kill(pid, signal.SIGKILL)
    os.waitpid(pid, 0)
    pytest.fail("the child hangs")


held: list[object] = []


def use_the_parents_environments() -> None:
    env, sync = held[0], held[1]
    env.step(0)
    sync.step([0] * 3)
    rustgym.make_vec("CartPole-v1", 3, kind="async").reset(seed=0)


def use_the_parents_threads() -> None:
    envs = held[2]
    for call in (lambda: envs.reset(seed=0), lambda: envs.step([0] * 3), envs.close, lambda: envs.get_attr("state")):
        try:
            call()
        except RuntimeError as error:
            assert "fork" in str(error)
        else:
            raise AssertionError("no error")
    held.clear()  # dropping the vector must not wait for its threads, which do not exist after a fork


def use_what_a_thread_of_the_parent_holds() -> None:
    try:
        held[3].step(0)
    except RuntimeError as error:
        assert "fork" in str(error)


@needs_fork
@pytest.mark.filterwarnings("ignore:.*multi-threaded.*:DeprecationWarning")
def test_forks() -> None:
    held[:] = [rustgym.Env("LunarLander-v3"), *(rustgym.VectorEnv("CartPole-v1", 3, kind=k) for k in ("sync", "async"))]
    for thing in held:
        thing.reset(seed=0)
    assert in_child("use_the_parents_environments") == 0
    assert in_child("use_the_parents_threads") == 0
    held[2].step([0] * 3)
    held.clear()


@needs_fork
@pytest.mark.filterwarnings("ignore:.*multi-threaded.*:DeprecationWarning")
def test_a_fork_while_a_thread_steps() -> None:
    car = rustgym.Env("CarRacing-v3", continuous=False)
    car.reset(seed=0)
    held[:] = [None, None, None, car]
    stop = threading.Event()

    def drive() -> None:
        while not stop.is_set():
            car.step(3)

    thread = threading.Thread(target=drive)
    thread.start()
    try:
        for _ in range(10):
            assert in_child("use_what_a_thread_of_the_parent_holds") == 0
    finally:
        stop.set()
        thread.join()
        held.clear()


@pytest.mark.parametrize("context", multiprocessing.get_all_start_methods())
def test_gymnasiums_worker_processes(context: str) -> None:
    envs = gymnasium.vector.AsyncVectorEnv(
        [lambda: gymnasium.make("rustgym:rustgym/LunarLander-v3")] * 2, context=context
    )
    try:
        first, _ = envs.reset(seed=0)
        for _ in range(20):
            envs.step(envs.action_space.sample())
        assert np.array_equal(first[1], rustgym.Env("LunarLander-v3").reset(seed=1)[0])
    finally:
        envs.close()


def test_memory_does_not_grow() -> None:
    resource = pytest.importorskip("resource")
    envs = rustgym.VectorEnv("CartPole-v1", 64)
    env = rustgym.Env("Taxi-v4")
    envs.reset(seed=0), env.reset(seed=0)
    actions = envs.action_space.sample()

    def work(steps: int) -> int:
        for _ in range(steps):
            envs.step(actions)
            if env.step(0)[2]:
                env.reset()
        return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss

    before = work(2_000)
    grown = work(20_000) - before
    assert grown < 4_000, f"20000 steps took {grown} KiB"
