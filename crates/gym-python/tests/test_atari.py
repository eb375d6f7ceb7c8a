"""Atari: the attributes and methods of ale-py, other packages' preprocessing, and the preprocessing in Rust."""

from __future__ import annotations

import copy
import itertools
import os
import pickle
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import pytest
from conftest import assert_same

import rustgym

ale_py = pytest.importorskip("ale_py")  # for its ROMs, and to compare with
GAMES = ["Breakout", "Pong", "MsPacman", "Seaquest"]


@pytest.fixture(params=GAMES)
def game(request: pytest.FixtureRequest) -> str:
    return f"ALE/{request.param}-v5"


def both(env_id: str, **kwargs: Any) -> tuple[gymnasium.Env, gymnasium.Env]:
    return rustgym.make(env_id, **kwargs), gymnasium.make(env_id, **kwargs)


def names(actions: Any) -> list[str]:
    return [action.name for action in actions]


def test_what_is_known_of_a_game(game: str) -> None:
    ours, theirs = both(game, full_action_space=True)
    for full in (True, False):
        ours, theirs = both(game, full_action_space=full)
        assert ours.action_space == theirs.action_space and ours.observation_space == theirs.observation_space
        a, b = ours.unwrapped, theirs.unwrapped
        assert a.get_action_meanings() == b.get_action_meanings()
        assert a.get_keys_to_action() == b.get_keys_to_action()
        assert names(a._action_set) == names(b._action_set)
        for name in ("_frameskip", "_game", "_game_mode", "_game_difficulty", "_obs_type", "metadata", "render_mode"):
            assert getattr(a, name) == getattr(b, name), name
    for ask in ("getScreenDims", "getRAMSize", "getAvailableModes", "getAvailableDifficulties"):
        assert getattr(a.ale, ask)() == getattr(b.ale, ask)(), ask
    for ask in ("getLegalActionSet", "getMinimalActionSet"):
        assert names(getattr(a.ale, ask)()) == names(getattr(b.ale, ask)()), ask


@pytest.mark.parametrize("env_id", [env_id for env_id in rustgym.ids() if env_id.startswith("ALE/")])
def test_answers_to_random_calls(env_id: str) -> None:
    """Random calls, such as steps, single frames, reading the game, and saving and restoring states."""
    # these games get more calls: a reset of Qbert and Tetris ends within a frame, and Skiing has no action with FIRE
    calls = 1000 if env_id[4:-3] in [*GAMES, "Qbert", "Skiing", "Tetris"] else 150
    ours, theirs = both(env_id)
    a, b = ours.unwrapped, theirs.unwrapped
    rng = np.random.default_rng(5)
    assert_same(ours.reset(seed=5), theirs.reset(seed=5))
    rows = a.ale.getScreenDims()[0]
    states: list[tuple[Any, Any]] = []
    for call in range(calls):
        what = rng.choice(["step", "act", "look", "buffer", "clone", "restore", "reset"], p=[0.3, 0.3, 0.2, 0.1, 0.05, 0.04, 0.01])
        where = f"{what}, call {call}"
        if what == "step":
            action = int(rng.integers(len(a._action_set)))
            assert_same(a.step(action), b.step(action), where)
        elif what == "act":
            action = int(rng.integers(18))
            assert a.ale.act(action) == b.ale.act(action), where
        elif what == "look":
            for ask in ("lives", "game_over", "game_truncated", "getFrameNumber", "getEpisodeFrameNumber"):
                assert getattr(a.ale, ask)() == getattr(b.ale, ask)(), f"{ask}, call {call}"
            for ask in ("getRAM", "getScreen", "getScreenRGB", "getScreenGrayscale"):
                assert_same(getattr(a.ale, ask)(), getattr(b.ale, ask)(), f"{ask}, call {call}")
        elif what == "buffer":
            for ask, shape in (("getRAM", (128,)), ("getScreenRGB", (rows, 160, 3)), ("getScreenGrayscale", (rows, 160))):
                buffers = np.zeros(shape, np.uint8), np.zeros(shape, np.uint8)
                assert getattr(a.ale, ask)(buffers[0]) is None and getattr(b.ale, ask)(buffers[1]) is None
                assert_same(*buffers, f"{ask}, call {call}")
        elif what == "clone":
            include = bool(rng.integers(2))
            states.append((a.clone_state(include_rng=include), b.clone_state(include_rng=include)))
            for ask in ("getFrameNumber", "getEpisodeFrameNumber", "getCurrentMode", "getDifficulty"):
                assert getattr(states[-1][0], ask)() == getattr(states[-1][1], ask)(), f"{ask}, call {call}"
        elif what == "restore" and states:
            x, y = states[rng.integers(len(states))]
            a.restore_state(x)
            b.restore_state(y)
        elif what == "reset" or a.ale.game_over():
            assert_same(ours.reset(), theirs.reset(), where)


def test_states_are_stored(game: str) -> None:
    # without sticky actions: a state does not contain the last action, as in ale-py
    env = rustgym.make(game, repeat_action_probability=0.0).unwrapped
    env.reset(seed=1)
    state = env.clone_state(include_rng=True)
    again = pickle.loads(pickle.dumps(state))
    assert again == state and again.equals(state) and again.serialize() == state.serialize()
    first = [env.step(a % 3)[0].tobytes() for a in range(20)]
    assert env.clone_state(include_rng=True) != state
    env.restore_state(again)
    assert [env.step(a % 3)[0].tobytes() for a in range(20)] == first
    twin = copy.deepcopy(env)
    assert twin.ale is not env.ale and twin.ale.getFrameNumber() == env.ale.getFrameNumber()
    twin.step(0)
    assert twin.ale.getFrameNumber() == env.ale.getFrameNumber() + 4


def test_seeding_loading_and_settings(game: str) -> None:
    kwargs = {"difficulty": 0, "max_num_frames_per_episode": 300}
    ours, theirs = (env.unwrapped for env in both(game, **kwargs))
    mode = ours.ale.getAvailableModes()[-1]
    answers = []
    for env in (ours, theirs):
        env.reset(seed=1)
        env.ale.setMode(mode)
        answer = [env.reset(), env.reset(seed=2), env.seed_game(3), env.load_game()]
        # `load_game` has started an episode in the default mode
        answer += [[env.ale.act(action % 18) for action in range(50)], env.ale.getRAM(), env.ale.getScreen(), env.ale.lives()]
        answer += [env.reset(), env.np_random.integers(1000)]
        env.ale.reset_game()
        rewards = [env.ale.act(action % 18) for action in range(320)]
        answer += [rewards, env.ale.getRAM(), env.ale.game_over(), env.ale.game_over(False), env.ale.getEpisodeFrameNumber()]
        answer += [env.ale.getInt(name) for name in ("random_seed", "max_num_frames_per_episode", "nothing")]
        answers.append([*answer, env.ale.getFloat("repeat_action_probability"), env.ale.getFloat("nothing")])
    assert_same(*answers)
    ours.seed_game(3)
    ours.load_game()
    assert_same(ours.reset()[0], rustgym.make(game, **kwargs).reset(seed=3)[0])


def public(thing: object) -> set[str]:
    return {name for name in dir(thing) if not name.startswith("_")}


def test_all_that_is_public_is_there(tmp_path: Path) -> None:
    ours, theirs = (env.unwrapped for env in both("ALE/SpaceInvaders-v5", repeat_action_probability=0.5))
    for env in (ours, theirs):
        env.reset(seed=1)
        env.ale.setMode(3)
    assert public(theirs) - public(ours) == set()
    assert public(theirs.ale) - public(ours.ale) == set()
    assert public(theirs.clone_state()) - public(ours.clone_state()) == set()
    for sides in itertools.product((-1, 0, 1), (-1, 0, 1), (False, True)):
        assert ours.map_action_idx(*sides).name == theirs.map_action_idx(*sides).name
    settings = """random_seed max_num_frames_per_episode repeat_action_probability frame_skip reward_max sound record_screen_dir
        rom_file system_random_seed cpu none"""
    for ask, name in itertools.product(("getInt", "getFloat", "getBool", "getString"), settings.split()):
        assert_same(getattr(ours.ale, ask)(name), getattr(theirs.ale, ask)(name), f"{ask}({name!r})")
    rom = ours.ale.getString("rom_file")
    for path, result in ((rom, "space_invaders"), (Path(rom), "space_invaders"), (__file__, None)):
        assert ours.ale.isSupportedROM(path) == theirs.ale.isSupportedROM(path) == result
    for path in ("/nowhere", "/"):
        for env in (ours, theirs):
            with pytest.raises(RuntimeError):
                env.ale.isSupportedROM(path)
    os.mkfifo(tmp_path / "pipe")  # which nobody writes
    with pytest.raises(RuntimeError, match="not a regular file"):
        ours.ale.isSupportedROM(tmp_path / "pipe")
    states = [env.clone_state() for env in (ours, theirs)]
    assert pickle.loads(pickle.dumps(states[0])).getCurrentMode() == 3
    answers = []
    for env, state in zip((ours, theirs), states, strict=True):
        env.ale.setMode(0)
        env.restore_state(state)
        env.ale.reset_game()  # plays in the mode of the restored state
        answers.append((env.ale.cloneState().getCurrentMode(), env.ale.getRAM(), env.ale.getAudioSize()))
    assert_same(*answers)
    for path, env in (("ours", ours), ("theirs", theirs)):
        env.ale.saveScreenPNG(f"{tmp_path}/{path}.png")
    cv2 = pytest.importorskip("cv2")
    assert_same(*(cv2.imread(f"{tmp_path}/{path}.png") for path in ("ours", "theirs")))


def test_bad_input() -> None:
    env = rustgym.make("ALE/Breakout-v5").unwrapped
    ale = env.ale
    for call in (
        lambda: ale.setRAM(128, 0),
        lambda: ale.setRAM(-1, 0),
        lambda: ale.setRAM(0, 256),
        lambda: ale.setMode(99),
        lambda: ale.setMode(-1),
        lambda: ale.setDifficulty(9),
        lambda: ale.setDifficulty("easy"),
        lambda: ale.getScreenRGB(np.zeros((3, 3), np.uint8)),
    ):
        with pytest.raises(RuntimeError):
            call()
    with pytest.raises(TypeError):
        ale.getRAM(np.zeros(128, np.int8))
    with pytest.raises(TypeError, match="clip_reward is 'x'"):
        rustgym.make("ALE/Pong-v5", preprocessing={"clip_reward": "x"})
    assert ale.act(ale_py.Action.NOOP) == ale.act(rustgym.envs.atari.Action.NOOP) == 0
    for action in (18, -1):
        with pytest.raises(ValueError, match="not an action"):
            ale.act(action)
    with pytest.raises(gymnasium.error.Error, match="sound"):
        ale.getAudio()
    for call in (lambda: ale.setFloat("repeat_action_probability", 0.0), lambda: ale.loadROM("/nowhere")):
        with pytest.raises(gymnasium.error.Error, match=r"rustgym\.make"):
            call()
    with pytest.raises(ValueError, match="/nowhere"):
        rustgym.make("ALE/Pong-v5", rom_dir="/nowhere")
    with pytest.raises(TypeError, match="preprocessing has no 'stack'"):
        rustgym.make("ALE/Pong-v5", preprocessing={"stack": 4})
    with pytest.raises(TypeError, match="CartPole-v1 is not one"):
        rustgym.make_vec("CartPole-v1", 2, preprocessing=True)


@pytest.mark.parametrize("lives", [False, True])
def test_gymnasiums_preprocessing(game: str, lives: bool) -> None:
    """The preprocessing in Rust gives the same pictures and rewards as Gymnasium's wrappers around our and ale-py's games."""
    pytest.importorskip("cv2")
    from gymnasium.wrappers import AtariPreprocessing, FrameStackObservation

    def wrapped(env: gymnasium.Env) -> gymnasium.Env:
        return FrameStackObservation(AtariPreprocessing(env, terminal_on_life_loss=lives), 4)

    kwargs = {"frameskip": 1, "repeat_action_probability": 0.25}
    ours, theirs = (wrapped(env) for env in both(game, **kwargs))
    rust = rustgym.make(game, preprocessing={"terminal_on_life_loss": lives})
    vector = rustgym.make_vec(game, 1, kind="async", preprocessing={"terminal_on_life_loss": lives})
    assert rust.observation_space == theirs.observation_space
    expected = theirs.reset(seed=4)
    assert_same(ours.reset(seed=4), expected)
    assert_same(rust.reset(seed=4), expected)
    assert_same(vector.reset(seed=4)[0][0], expected[0])
    rng = np.random.default_rng(1)
    for _ in range(500):
        action = int(rng.integers(theirs.action_space.n))
        expected = theirs.step(action)
        assert_same(ours.step(action), expected)
        assert_same(rust.step(action), expected)
        observation, reward, terminated, truncated, _ = vector.step(np.array([action]))
        assert_same((observation[0], reward[0], terminated[0], truncated[0]), expected[:4])
        if expected[2] or expected[3]:
            expected = theirs.reset()
            assert_same(ours.reset(), expected)
            assert_same(rust.reset(), expected)
            assert_same(vector.step(np.array([action]))[0][0], expected[0])


def test_preprocessing_is_stored() -> None:
    env = rustgym.make("ALE/Breakout-v5", preprocessing={"clip_reward": True, "screen_size": (60, 84)})
    assert env.observation_space.shape == (4, 84, 60)
    env.reset(seed=1)
    twin = pickle.loads(pickle.dumps(env))
    for _ in range(20):
        assert_same(twin.step(1), env.step(1))
    vector = rustgym.make_vec("ALE/Breakout-v5", 2, kind="sync", preprocessing={"frame_stack": 0})
    vector.reset(seed=1)
    assert vector.single_observation_space.shape == (84, 84)
    assert vector.call("get_action_meanings") == (["NOOP", "FIRE", "RIGHT", "LEFT"],) * 2


def test_stable_baselines3() -> None:
    pytest.importorskip("stable_baselines3")
    pytest.importorskip("cv2")
    from stable_baselines3.common.atari_wrappers import AtariWrapper

    ours, theirs = (AtariWrapper(env) for env in both("BreakoutNoFrameskip-v4", frameskip=1))
    for wrapped in (ours, theirs):
        wrapped.action_space.seed(0)
    # the wrapper draws its number of no-ops from `np_random`, which both environments seed alike
    assert_same(ours.reset(seed=3), theirs.reset(seed=3))
    for _ in range(300):
        action = ours.action_space.sample()
        result, expected = ours.step(action), theirs.step(action)
        assert_same(result, expected)
        if result[2] or result[3]:
            assert_same(ours.reset(), theirs.reset())


@pytest.mark.parametrize("name", ["BreakoutNoFrameskip-v4", "PongNoFrameskip-v4"])
def test_make_atari_env(name: str) -> None:
    """Stable-Baselines3's ``make_atari_env`` with our id and with ale-py's id."""
    pytest.importorskip("stable_baselines3")
    pytest.importorskip("cv2")
    from stable_baselines3.common.env_util import make_atari_env

    ours, theirs = (make_atari_env(env_id, n_envs=2, seed=1) for env_id in (f"rustgym/{name}", name))
    rng = np.random.default_rng(2)
    assert_same(ours.reset(), theirs.reset())
    for _ in range(200):
        actions = rng.integers(4, size=2)
        assert_same(ours.step(actions)[:3], theirs.step(actions)[:3])


def test_the_wrappers_of_single_files() -> None:
    """The wrappers of CleanRL's `ppo_atari.py`, which come from Stable-Baselines3 and Gymnasium."""
    wrappers = pytest.importorskip("stable_baselines3.common.atari_wrappers")
    pytest.importorskip("cv2")

    def wrapped(env_id: str) -> gymnasium.Env:
        env = gymnasium.wrappers.RecordEpisodeStatistics(gymnasium.make(env_id))
        env = wrappers.EpisodicLifeEnv(wrappers.MaxAndSkipEnv(wrappers.NoopResetEnv(env, noop_max=30), skip=4))
        if "FIRE" in env.unwrapped.get_action_meanings():
            env = wrappers.FireResetEnv(env)
        env = gymnasium.wrappers.ResizeObservation(wrappers.ClipRewardEnv(env), (84, 84))
        return gymnasium.wrappers.FrameStackObservation(gymnasium.wrappers.GrayscaleObservation(env), 4)

    name = "BreakoutNoFrameskip-v4"
    ours, theirs = (gymnasium.vector.SyncVectorEnv([lambda e=e: wrapped(e)] * 2) for e in (f"rustgym/{name}", name))
    rng = np.random.default_rng(2)
    assert_same(ours.reset(seed=1)[0], theirs.reset(seed=1)[0])
    for _ in range(200):
        actions = rng.integers(4, size=2)
        assert_same(ours.step(actions)[:4], theirs.step(actions)[:4])


@pytest.mark.parametrize(
    ("setting", "kind"),
    [
        ({"obs_type": "foo"}, ValueError),
        ({"frameskip": 0}, ValueError),
        ({"frameskip": (5, 2)}, ValueError),
        ({"mode": 77}, RuntimeError),
        ({"difficulty": 9}, RuntimeError),
    ],
)
def test_bad_settings_raise_what_ale_py_raises(setting: dict[str, object], kind: type[Exception]) -> None:
    for expected in (gymnasium.error.Error, kind):
        with pytest.raises(expected, match=next(iter(setting))):
            rustgym.make("ALE/Pong-v5", **setting)
