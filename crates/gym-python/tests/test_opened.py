"""Environments that continue as their package's own."""

from __future__ import annotations

import copy
import pickle
import sys
import warnings
from typing import Any

import gymnasium
import numpy as np
import pytest
from conftest import assert_same, go_on

import rustgym


def make(module: Any, env_id: str, seed: int | None = 3, **kwargs: Any) -> Any:
    env = module.make(env_id, disable_env_checker=True, **kwargs)
    if seed is not None:
        env.reset(seed=seed)
    return env


def both(env_id: str, use: Any, **kwargs: Any) -> None:
    """Compares what ``use`` returns for our environment and the package's."""
    assert_same(use(make(rustgym, env_id, **kwargs)), use(make(gymnasium, env_id, **kwargs)), env_id)


@pytest.fixture
def minigrid() -> Any:
    return pytest.importorskip("minigrid")


@pytest.fixture
def suite(monkeypatch: pytest.MonkeyPatch) -> Any:
    monkeypatch.setenv("MUJOCO_GL", "disabled")
    pytest.importorskip("dm_control")
    return pytest.importorskip("shimmy")


def test_a_grid_is_the_world(minigrid: Any) -> None:
    from minigrid.core.world_object import Lava
    from minigrid.minigrid_env import MiniGridEnv

    def use(env: Any) -> Any:
        first = go_on(env, [2, 1, 2])
        env.unwrapped.put_obj(Lava(), *env.unwrapped.front_pos)
        key = next(cell for cell in env.unwrapped.grid.grid if cell is not None and cell.type == "key")
        key.color = "purple"
        assert isinstance(env.unwrapped, MiniGridEnv)
        return first, env.unwrapped.gen_obs(), go_on(env, [0, 2, 5, 3, 4] * 6), env.unwrapped.hash()

    both("MiniGrid-DoorKey-6x6-v0", use)


@pytest.mark.parametrize("env_id", ["MiniGrid-FourRooms-v0", "BabyAI-PutNextLocal-v0", "MiniGrid-Dynamic-Obstacles-6x6-v0"])
def test_what_stays_closed_is_read_alike(minigrid: Any, env_id: str) -> None:
    from minigrid.minigrid_env import MiniGridEnv

    env = make(rustgym, env_id)
    assert env.unwrapped.agent_dir in range(4) and env.unwrapped.step_count == 0
    assert not isinstance(env.unwrapped, MiniGridEnv)

    def use(env: Any) -> Any:
        u = env.unwrapped
        return u.agent_pos, u.agent_dir, u.mission, u.front_pos, u.actions.toggle, u.max_steps, go_on(env, [2, 2, 1, 2])

    both(env_id, use)
    early = make(rustgym, env_id, seed=None).unwrapped
    assert early.agent_pos is None and early.agent_dir is None


@pytest.mark.parametrize("env_id", ["MiniGrid-Empty-8x8-v0", "MiniGrid-DoorKey-5x5-v0", "MiniGrid-MemoryS7-v0", "BabyAI-GoToLocal-v0"])
def test_types_of_minigrid(minigrid: Any, env_id: str) -> None:
    def types(env: Any) -> Any:
        observation, _ = env.reset(seed=1)
        _, reward, *_ = env.step(1)
        return [*observation], type(observation["direction"]).__name__, type(reward).__name__

    assert types(make(rustgym, env_id)) == types(make(gymnasium, env_id))


@pytest.mark.parametrize("env_id", ["BabyAI-GoToLocal-v0", "BabyAI-PutNextLocal-v0", "BabyAI-UnlockPickup-v0", "BabyAI-GoToSeq-v0"])
def test_a_bot_plays_alike(minigrid: Any, env_id: str) -> None:
    from minigrid.utils.baby_ai_bot import BabyAIBot

    def use(env: Any) -> Any:
        bot, last, results = BabyAIBot(env), None, []
        for _ in range(60):
            last = bot.replan(last)
            results.append((int(last), env.step(last)))
            if results[-1][1][2] or results[-1][1][3]:
                break
        return results

    both(env_id, use)


def test_without_minigrid_a_grid_is_read_only(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(rustgym.envs.minigrid, "package_of", lambda env_id: None)
    monkeypatch.setattr(rustgym._class_env, "package_of", lambda env_id: None)
    env = make(rustgym, "MiniGrid-DoorKey-5x5-v0").unwrapped
    door = next(cell for cell in env.grid.grid if cell is not None and cell.type == "door")
    with pytest.raises(AttributeError):
        door.state = 0
    with pytest.raises(gymnasium.error.DependencyNotInstalled, match="pip install minigrid"):
        env.grid.set(1, 1, None)
    with pytest.raises(gymnasium.error.DependencyNotInstalled, match="agent_pos can be set"):
        env.agent_pos = (1, 1)
    with pytest.raises(gymnasium.error.DependencyNotInstalled, match="_reward, which minigrid calls"):

        class Mine(type(env)):  # type: ignore[misc]
            def _reward(self) -> float:
                return 1.0


def test_classes_keep_their_methods_and_gain_the_packages() -> None:
    calls = []

    class Mine(rustgym.envs.CartPole_v1):  # type: ignore[misc,name-defined]
        def __init__(self, bonus: float = 0.5, **kwargs: Any) -> None:
            super().__init__(**kwargs)
            self.bonus = bonus

        def step(self, action: Any) -> Any:
            observation, reward, *rest = super().step(action)
            return observation, reward + self.bonus, *rest

    class Opened(Mine):
        def render(self) -> Any:
            return "mine"

        def _get_obs(self) -> Any:
            calls.append("never: CartPole has no such method")

    for made in (Mine(bonus=1.0), Opened(bonus=1.0)):
        made.reset(seed=1)
        assert made.step(0)[1] == 2.0 and type(made) in (Mine, Opened)

    class Swing(rustgym.envs.Acrobot_v1):  # type: ignore[misc,name-defined]
        def _terminal(self) -> bool:
            return super()._terminal() or self.state[0] > 0.0

    from gymnasium.envs.classic_control.acrobot import AcrobotEnv

    swing = Swing()
    swing.reset(seed=1)
    assert isinstance(swing, Swing) and isinstance(swing, AcrobotEnv) and swing.env_id == "Acrobot-v1"
    assert any(swing.step(2)[2] for _ in range(10)) and not calls


def test_a_method_of_an_instance() -> None:
    def use(env: Any) -> Any:
        go_on(env, [1, 2])
        env.unwrapped._terminal = lambda: True
        return env.step(1)[:4]

    both("Acrobot-v1", use)


#: What Gymnasium's classes keep of an episode.
HANDED = {
    "Blackjack-v1": ("player", "dealer", "dealer_top_card_suit", "dealer_top_card_value_str", "natural", "sab"),
    "Taxi-v4": ("s", "lastaction", "fickle_step", "taxi_orientation"),
    "CartPole-v1": ("state", "steps_beyond_terminated", "gravity", "tau"),
    "Acrobot-v1": ("state", "book_or_nips"),
}


@pytest.mark.parametrize(
    ("env_id", "method", "value"),
    [
        ("Blackjack-v1", "_get_obs", (1, 2, 3)),
        ("Taxi-v4", "action_mask", np.zeros(6, np.int8)),
        ("CartPole-v1", "render", "drawn"),
        ("Acrobot-v1", "_get_ob", np.zeros(6, np.float32)),
    ],
)
def test_what_an_episode_has_is_handed_over(env_id: str, method: str, value: Any) -> None:
    def use(env: Any) -> Any:
        seen = env.reset(seed=4)
        if env_id != "Blackjack-v1":
            go_on(env, [0, 1, 0])
        own = env.unwrapped
        setattr(own, method, lambda *_: value)
        theirs = [name for name in HANDED[env_id] if hasattr(own, name)]
        return seen, env.step(1)[:4], {name: getattr(own, name) for name in theirs}, getattr(own, method)(0)

    both(env_id, use)


def test_the_generator_and_the_users_attributes_stay(minigrid: Any) -> None:
    def use(env: Any) -> Any:
        generator = env.unwrapped.np_random
        drawn = generator.random()
        first = go_on(env, [2, 1, 2])
        env.unwrapped.mark = "mine"
        env.unwrapped.place_agent()
        assert env.unwrapped.np_random is generator and env.unwrapped.mark == "mine"
        return drawn, first, generator.random(), go_on(env, [2, 1, 2]), env.reset(), env.unwrapped.np_random.random()

    both("MiniGrid-Dynamic-Obstacles-6x6-v0", use)


@pytest.mark.parametrize("way", [copy.copy, copy.deepcopy, lambda env: pickle.loads(pickle.dumps(env))])
def test_copies_are_opened_and_open(minigrid: Any, way: Any) -> None:
    env = make(rustgym, "MiniGrid-DoorKey-5x5-v0").unwrapped
    go_on(env, [2, 1])
    early = way(env)
    env.grid.set(1, 1, None)
    late = way(env)
    assert_same(early.gen_obs()["direction"], late.gen_obs()["direction"])
    late.carrying = next(cell for cell in late.grid.grid if cell is not None and cell.type == "key")
    assert env.carrying is None
    assert_same(env.step(2)[:4], way(early).step(2)[:4])


def test_what_cannot_be_opened_says_so(minigrid: Any) -> None:
    envs = rustgym.VectorEnv("MiniGrid-DoorKey-5x5-v0", 2, kind="sync")
    envs.reset(seed=0)
    with pytest.raises(gymnasium.error.Error, match="SyncVectorEnv"):
        _ = envs.envs[0].grid
    env = make(rustgym, "MiniGrid-DoorKey-5x5-v0").unwrapped
    state = env.get_state()
    env.set_state(state)
    with pytest.raises(gymnasium.error.Error, match="reset first"):
        _ = env.grid
    assert env.step(2)[1] == 0  # it is as it was
    env.reset(seed=1)
    _ = env.grid
    with pytest.raises(gymnasium.error.Error, match=r"copy\.deepcopy"):
        env.get_state()


def test_what_could_not_be_opened_is_as_it_was(minigrid: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    env, twin = (make(rustgym, "MiniGrid-DoorKey-5x5-v0").unwrapped for _ in range(2))
    before, mine = dict(env.__dict__), type(env)

    def fail(self: Any, *args: Any, **kwargs: Any) -> None:
        self.agent_pos = self.of_nobody = (9, 9)
        raise MemoryError("in the middle")

    with monkeypatch.context() as patch:
        patch.setattr(type(make(gymnasium, "MiniGrid-DoorKey-5x5-v0").unwrapped), "__init__", fail)
        with pytest.raises(MemoryError, match="in the middle"):
            _ = env.grid
    assert type(env) is mine and env.__dict__.keys() == before.keys()
    assert_same(go_on(env, [2, 1, 2]), go_on(twin, [2, 1, 2]), "the episode goes on")
    assert env.grid is not None


def test_box2d_repeats_its_episode() -> None:
    pytest.importorskip("Box2D")

    class Mine:
        def __call__(self, module: Any) -> Any:
            class Flat(type(make(module, "BipedalWalker-v3", seed=None).unwrapped)):  # type: ignore[misc]
                def _generate_terrain(self, hardcore: bool) -> None:
                    super()._generate_terrain(True)

            env = Flat()
            return env.reset(seed=2)[0], [env.step(np.full(4, 0.5, np.float32))[:4] for _ in range(8)]

    assert_same(Mine()(rustgym), Mine()(gymnasium), "a subclass")

    def use(env: Any) -> Any:
        go_on(env, [2, 1, 0, 2])
        return [tuple(v) for v in env.unwrapped.moon.fixtures[0].shape.vertices], go_on(env, [2, 2, 3])

    both("LunarLander-v3", use)


def test_the_suites_infos_and_rewards(suite: Any) -> None:
    for env_id in ("dm_control/cartpole-swingup-v0", "dm_control/reacher-easy-v0", "dm_control/acrobot-swingup-v0"):
        ours, theirs = make(rustgym, env_id, mujoco="3.12"), make(gymnasium, env_id)
        for env in (ours, theirs):
            env.action_space.seed(1)
        assert_same(ours.reset(seed=2)[1], theirs.reset(seed=2)[1], env_id)
        for _ in range(5):
            a, b = (env.step(env.action_space.sample()) for env in (ours, theirs))
            assert (a[1], type(a[1]), a[4]) == (b[1], type(b[1]), b[4])


def test_physics_is_dm_controls(suite: Any) -> None:
    zero = np.zeros(1)

    def use(env: Any) -> Any:
        # thirds are no numbers of fewer bits
        first = [env.step(zero + n / 3)[:2] for n in range(3)] + [env.reset(), env.step(zero + 1 / 3)[:2]]
        physics = env.unwrapped.physics
        physics.named.data.qpos["hinge_1"] = 0.5
        with physics.reset_context():
            physics.named.data.qvel["slider"] = 0.25
        return first, np.array(physics.data.qpos), env.unwrapped.dt, [env.step(zero)[:2] for _ in range(3)], env.reset()

    ours, theirs = (make(m, "dm_control/cartpole-swingup-v0", **k) for m, k in ((rustgym, {"mujoco": "3.12"}), (gymnasium, {})))
    assert_same(use(ours), use(theirs))
    with pytest.raises(AttributeError, match="is installed"):
        _ = make(rustgym, "dm_control/cartpole-swingup-v0", mujoco="4.0").unwrapped.physics


@pytest.mark.parametrize(
    "kwargs",
    [
        {"task_kwargs": {"random": 3, "time_limit": 0.05}},
        {"environment_kwargs": {"flat_observation": True}},
        {"environment_kwargs": {"n_sub_steps": 2}},
        {"environment_kwargs": {"control_timestep": 0.02}},
        {"visualize_reward": True},
        {"render_kwargs": {"width": 32}},
    ],
)
def test_arguments_of_dm_control(suite: Any, kwargs: Any) -> None:
    def use(env: Any) -> Any:
        return env.reset(), env.unwrapped.dt, [env.step(np.array([0.1]))[:4] for _ in range(5)]

    kwargs = {**kwargs, "task_kwargs": {"random": 1, **kwargs.get("task_kwargs", {})}}
    ours = make(rustgym, "dm_control/cartpole-swingup-v0", seed=None, **copy.deepcopy(kwargs))
    assert_same(use(ours), use(make(gymnasium, "dm_control/cartpole-swingup-v0", seed=None, **copy.deepcopy(kwargs))))


def test_a_vector_warns_of_what_it_does_not_know() -> None:
    gymnasium.logger.min_level = gymnasium.logger.WARN
    try:
        envs = rustgym.make_vec("CartPole-v1", num_envs=2)
        with pytest.warns(UserWarning, match="has no wind"):
            envs.wind = 3
        envs = rustgym.VectorEnv("CartPole-v1", 2, kind="sync")
        envs.reset(seed=0)
        envs.gravity = 3.0
        assert envs.get_attr("gravity") == (3.0, 3.0)
        envs.gravity = 4.0
        assert envs.get_attr("gravity") == (4.0, 4.0)
    finally:
        gymnasium.logger.min_level = gymnasium.logger.ERROR


def test_a_game_gives_ale_pys_vector() -> None:
    pytest.importorskip("ale_py")
    envs = rustgym.make_vec("ALE/Pong-v5", 2, vectorization_mode="vector_entry_point")
    assert envs.single_observation_space.shape == (4, 84, 84)
    assert rustgym.spec("ALE/Pong-v5").kwargs == gymnasium.spec("ALE/Pong-v5").kwargs
    assert rustgym.registry["Pong-v4"].kwargs["frameskip"] == (2, 5)


@pytest.mark.parametrize("mode", ["NextStep", "SameStep", "Disabled"])
@pytest.mark.parametrize("limit", [None, 4])
def test_time_steps_of_vectors(suite: Any, mode: str, limit: int | None) -> None:
    env_id = "dm_control/point_mass-easy-v0"
    given = {"time_limit": 0.12}  # six steps

    def theirs() -> Any:
        env = gymnasium.make(env_id, task_kwargs=given, disable_env_checker=True)
        return env if limit is None else gymnasium.wrappers.TimeLimit(env, limit)

    def use(envs: Any) -> Any:
        results = [envs.reset(seed=[5, 6])[1]]
        for k in range(14):
            *_, ended, cut, infos = envs.step(np.full((2, 2), 0.1))
            results += [(ended, cut, infos)]
            if mode == "Disabled" and (ended | cut).any():
                results += [envs.reset(options={"reset_mask": ended | cut})[1]]
            if k == 2:
                results += [envs.reset(seed=9, options={"reset_mask": np.array([True, False])})[1]]
        return results

    expected = use(gymnasium.vector.SyncVectorEnv([theirs] * 2, autoreset_mode=gymnasium.vector.AutoresetMode(mode)))
    for kind in ("sync", "native", "async"):
        envs = rustgym.VectorEnv(env_id, 2, kind=kind, autoreset_mode=mode, max_episode_steps=limit, mujoco="3.12", **given)
        results = use(envs)
        assert_same(results, expected, kind)
        assert type(results[1][2]["timestep.step_type"][0]) is type(expected[1][2]["timestep.step_type"][0])
    # the steps of some environments
    envs = rustgym.VectorEnv(env_id, 2, kind="async", autoreset_mode=mode, mujoco="3.12")
    envs.reset(seed=5)
    envs.send(np.full((1, 2), 0.1), [1])
    infos = envs.recv(1)[4]
    assert infos["_timestep.step_type"].tolist() == [False, True] and infos["timestep.discount"][1] == 1.0


def test_a_class_of_ones_own_is_warned_of_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys.modules["rustgym.envs.mujoco"], "_installed", lambda: None)  # another version is told of

    class Mine(rustgym.VectorEnv):
        pass

    class Walker(rustgym.envs.Hopper_v5):  # type: ignore[misc,name-defined]
        metadata = {"render_modes": ["rgb_array"], "render_fps": 125}

        def step(self, action: Any) -> Any:
            return super().step(action)

        def reset(self, **kwargs: Any) -> Any:
            return super().reset(**kwargs)

        def render(self) -> Any:
            return "mine"

        def close(self) -> None:
            super().close()

    gymnasium.logger.min_level = gymnasium.logger.WARN
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            envs: Any = Mine("CartPole-v1", 2)
            envs.mark = 3
            walker: Any = Walker()
            walker.mark = 3
            walker.reset(seed=1)
            walker.step(np.zeros(3, np.float32))
            assert walker.render() == "mine" and walker.metadata["render_fps"] == 125 and envs.mark == walker.mark == 3
            assert not walker._is_handed
    finally:
        gymnasium.logger.min_level = gymnasium.logger.ERROR


def test_opened_environments_of_a_class_are_of_one_class(minigrid: Any) -> None:
    first, second = (make(rustgym, "MiniGrid-DoorKey-5x5-v0").unwrapped for _ in range(2))
    for env in (first, second):
        _ = env.grid
        env.place_agent()
    twin = copy.deepcopy(first)
    assert type(first) is type(second) is type(twin) is type(pickle.loads(pickle.dumps(second)))


@pytest.mark.parametrize("others", [(), ("helper",), ("helper", "another")])
def test_a_method_that_the_package_calls_is_called_beside_others(others: tuple[str, ...]) -> None:
    methods: dict[str, Any] = dict.fromkeys(others, lambda self: None)
    mine = type("Mine", (rustgym.envs.Acrobot_v1,), {**methods, "_terminal": lambda self: True})
    env = mine()
    env.reset(seed=1)
    assert env.step(1)[2] is True
