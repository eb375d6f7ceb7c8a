"""A window of pygame, which opens where the package's own cannot, shows the same episode; pictures have what Gymnasium's have."""

from __future__ import annotations

import sys
from typing import Any

import gymnasium
import numpy as np
import pytest
from conftest import assert_same

import rustgym


@pytest.mark.parametrize(
    ("env_id", "kwargs"),
    [
        ("CartPole-v1", {"gravity": 3.0}),
        ("FrozenLake-v1", {"map_name": "8x8", "is_slippery": False}),
        ("Pendulum-v1", {"g": 2.0}),
        ("LunarLander-v3", {"continuous": True}),
        ("MiniGrid-Empty-5x5-v0", {"agent_view_size": 3}),
    ],
)
def test_the_episode_in_a_window_is_the_one_without(env_id: str, kwargs: dict[str, Any], monkeypatch: pytest.MonkeyPatch) -> None:
    pygame = pytest.importorskip("pygame")
    monkeypatch.setenv("SDL_VIDEODRIVER", "dummy")
    monkeypatch.delenv("DISPLAY", raising=False)
    shown, plain = (rustgym.Env(env_id, render_mode=mode, **kwargs) for mode in ("human", "rgb_array"))
    assert_same(shown.reset(seed=4), plain.reset(seed=4), env_id)
    plain.render()
    plain.action_space.seed(1)
    for _ in range(5):
        action = plain.action_space.sample()
        assert_same(shown.step(action)[:4], plain.step(action)[:4], env_id)
        drawn = plain.render()
        assert shown.render() is None
    assert shown.get_state() == plain.get_state() and shown.arguments == plain.arguments
    if pygame.display.get_surface() is not None:
        assert pygame.display.get_caption()[0] == env_id
        picture = pygame.surfarray.array3d(pygame.display.get_surface()).swapaxes(0, 1)
        assert np.array_equal(picture, drawn)
    shown.close()


#: What Gymnasium's environments remember of their pictures.
OF_PICTURES = {
    "Taxi-v4": ["taxi_orientation", "cell_size", "window_size"],
    "CliffWalking-v1": ["cell_size", "window_size"],
    "FrozenLake-v1": ["cell_size", "window_size"],
}


@pytest.mark.parametrize("mode", ["rgb_array", "ansi"])
@pytest.mark.parametrize("env_id", OF_PICTURES)
@pytest.mark.parametrize("draws", [False, True])
def test_a_picture_leaves_what_gymnasiums_leaves(env_id: str, mode: str, draws: bool) -> None:
    def use(env: Any) -> list[Any]:
        env.reset(seed=2)
        seen = []
        for action in (1, 0, 2, 3, 3, 1):
            env.step(action)
            if draws:
                env.render()
            seen += [getattr(env.unwrapped, name, "none") for name in OF_PICTURES[env_id]]
        return seen

    ours, theirs = (module.make(env_id, render_mode=mode, disable_env_checker=True) for module in (rustgym, gymnasium))
    assert_same(use(ours), use(theirs), env_id)


DRAWN = ["CartPole-v1", "Acrobot-v1", "MountainCar-v0", "MountainCarContinuous-v0", "Pendulum-v1", "LunarLander-v3", "BipedalWalker-v3"]


@pytest.mark.parametrize("draws", [False, True])
@pytest.mark.parametrize("mode", ["rgb_array", "human", None])
@pytest.mark.parametrize("env_id", [*DRAWN, *OF_PICTURES])
def test_objects_of_pygame_are_missed_from_the_first_picture_on(env_id: str, mode: str | None, draws: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("pygame")
    monkeypatch.setenv("SDL_VIDEODRIVER", "dummy")
    monkeypatch.delenv("DISPLAY", raising=False)
    if env_id in ("LunarLander-v3", "BipedalWalker-v3"):
        pytest.importorskip("Box2D")
    ours, theirs = (module.make(env_id, render_mode=mode, disable_env_checker=True).unwrapped for module in (rustgym, gymnasium))

    def compared(phase: str) -> None:
        for name in ("screen", "clock", "isopen", "window_surface", "surf"):
            missing = object()
            found, expected = getattr(ours, name, missing), getattr(theirs, name, missing)
            if expected is None or isinstance(expected, bool):
                assert found is expected or (found is missing and name == "surf"), (phase, name, found, expected)
            else:
                assert found is missing, (phase, name, found, expected)

    compared("made")
    for env in (ours, theirs):
        env.reset(seed=1)
    compared("reset")
    if draws and mode is not None:
        for env in (ours, theirs):
            env.render()
        compared("drawn")
    for env in (ours, theirs):
        env.step(env.action_space.sample())
    compared("stepped")
    for env in (ours, theirs):
        env.close()
    compared("closed")


def test_a_window_of_pygame_shows_the_frame_under_its_title(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SDL_VIDEODRIVER", "dummy")
    pygame = pytest.importorskip("pygame")
    from rustgym._window import Window

    window = Window("two by three", 1000, "a reason")
    window.close()  # nothing is open yet
    ticks: list[int] = []
    for step in range(2):
        frame = np.arange(18, dtype=np.uint8).reshape(2, 3, 3) + step
        window.show(frame)
        if not step:
            window._clock = type("Clock", (), {"tick": lambda self, fps: ticks.append(fps)})()
        assert pygame.display.get_caption()[0] == "two by three"
        assert np.array_equal(pygame.surfarray.array3d(pygame.display.get_surface()).swapaxes(0, 1), frame)
    assert ticks == [1000]
    window.close()
    assert not pygame.display.get_init()
    window.show(frame)
    assert pygame.display.get_init()
    window.close()


def test_without_pygame_a_window_says_why_and_what_to_do(monkeypatch: pytest.MonkeyPatch) -> None:
    from rustgym._window import Window

    monkeypatch.setitem(sys.modules, "pygame", None)
    with pytest.raises(gymnasium.error.DependencyNotInstalled) as raised:
        Window("a title", 30, "no display was found")
    assert str(raised.value) == (
        "no display was found, and pygame is not installed: run `pip install pygame`, "
        'or use render_mode="rgb_array", which needs no window'
    )
