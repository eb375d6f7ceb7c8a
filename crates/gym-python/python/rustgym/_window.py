"""A window made by pygame, for systems where the package's own window cannot be opened."""

from __future__ import annotations

from typing import Any

import gymnasium
import numpy as np
import numpy.typing as npt

__all__ = ["Window"]


class Window:
    """A window that shows at most ``fps`` pictures per second.

    Raises:
        gymnasium.error.DependencyNotInstalled: if pygame is not installed; the message contains ``reason``.
    """

    def __init__(self, title: str, fps: int, reason: str) -> None:
        try:
            import pygame
        except ImportError as error:
            raise gymnasium.error.DependencyNotInstalled(
                f"{reason}, and pygame is not installed: run `pip install pygame`, "
                'or use render_mode="rgb_array", which needs no window'
            ) from error
        self._pygame = pygame
        self._title = title
        self._fps = fps
        self._surface: Any = None
        self._clock: Any = None

    def show(self, frame: npt.NDArray[np.uint8]) -> None:
        """Shows a picture of shape ``(height, width, 3)``."""
        pygame = self._pygame
        if self._surface is None:
            pygame.display.init()
            self._surface = pygame.display.set_mode((frame.shape[1], frame.shape[0]))
            pygame.display.set_caption(self._title)
            self._clock = pygame.time.Clock()
        self._surface.blit(pygame.surfarray.make_surface(frame.swapaxes(0, 1)), (0, 0))
        pygame.event.pump()
        self._clock.tick(self._fps)
        pygame.display.flip()

    def close(self) -> None:
        """Closes the window."""
        if self._surface is not None:
            self._pygame.display.quit()
            self._surface = None
