"""Plays games with ale-py 0.12.1 as `gym_atari::check` does, and writes `src/recorded.txt`.

    pip install ale-py==0.12.1
    python recorded.py GAME... > ../src/recorded.txt
"""

import struct
import sys
import zlib

import ale_py

FRAMES, MODE_FRAMES = 1000, 60


class Run:
    def __init__(self, game, seed, stickiness, mode=None, difficulty=None):
        self.ale = ale_py.ALEInterface()
        self.ale.setFloat("repeat_action_probability", stickiness)
        self.ale.setInt("random_seed", seed)
        self.ale.loadROM(str(ale_py.roms.get_rom_path(game)))
        if mode is not None:
            self.ale.setMode(mode)
            self.ale.setDifficulty(difficulty)
        self.sum, self.random = 0, seed
        self.reset()

    def below(self, n):
        self.random = (self.random * 1664525 + 1013904223) % 2**32
        return (self.random >> 16) % n

    def reset(self):
        self.ale.reset_game()
        self.add(0)

    def play(self, frames, actions):
        held = 0
        for _ in range(frames):
            if held == 0:
                action = actions[self.below(len(actions))]
                held = 1 + self.below(16)
            held -= 1
            was_over = self.ale.game_over()
            self.add(int(self.ale.act(action)))
            if was_over:
                self.reset()

    def add(self, reward):
        ale = self.ale
        numbers = (reward, ale.lives(), ale.game_over(), ale.getEpisodeFrameNumber(), ale.getFrameNumber())
        for part in (ale.getRAM(), ale.getScreen(), struct.pack("<ii?II", *numbers)):
            self.sum = zlib.crc32(bytes(part), self.sum)


def sums(game):
    plain = Run(game, 1, 0.0)
    minimal, every = plain.ale.getMinimalActionSet(), plain.ale.getLegalActionSet()
    plain.play(FRAMES, minimal)
    sticky = Run(game, 2, 0.25)
    sticky.play(FRAMES, every)
    modes = 0
    for mode in plain.ale.getAvailableModes():
        for difficulty in plain.ale.getAvailableDifficulties():
            run = Run(game, 3, 0.0, mode, difficulty)
            run.play(MODE_FRAMES, minimal)
            run.reset()
            run.play(MODE_FRAMES, minimal)
            modes = zlib.crc32(struct.pack("<I", run.sum), modes)
    return plain.sum, sticky.sum, modes


ale_py.ALEInterface.setLoggerMode(ale_py.LoggerMode.Error)
for name in sys.argv[1:]:
    print(name, *(f"{sum:08x}" for sum in sums(name)), flush=True)
