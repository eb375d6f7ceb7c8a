// The controls of time: pause, single steps, restart, and speed.
import { h, icon, iconButton } from "./dom.js";

const SPEEDS = [0.1, 0.25, 0.5, 1, 2, 4, 16, 64];

// Returns the element, and the functions `pause(is)`, `seek(step)`, `stepOn()` and `update(state)`.
export function makeTransport(game) {
  const { asked, engine } = game;
  const playButton = iconButton("pause", "Pause", () => pause(!asked.paused), { class: "icon-button primary" });
  function pause(paused) {
    asked.paused = paused;
    playButton.replaceChildren(icon(paused ? "play" : "pause"));
    playButton.title = paused ? "Play" : "Pause";
    playButton.setAttribute("aria-label", playButton.title);
    game.set({ paused });
  }
  const seek = makeSeek(game, pause);
  const back = iconButton("back", "One step back", () => seek(game.state.steps - 1));
  const on = iconButton("step", "One step", () => {
    pause(true);
    engine.handle("step", { env: game.env.env }).catch(game.report);
  });
  const restart = iconButton("reset", "Restart this episode", () => game.reset());
  const scrubber = h("input", { type: "range", class: "scrubber", min: "0", max: "0", value: "0", "aria-label": "Step of the episode" });
  scrubber.addEventListener("input", () => seek(Number(scrubber.value)));
  const steps = h("output", { class: "steps" });
  const element = h("div", { class: "transport" }, restart, back, playButton, on, scrubber, steps, speedMenu(game));
  const update = (state) => {
    scrubber.max = String(state.known);
    scrubber.value = steps.textContent = String(state.steps);
    back.disabled = state.steps === 0;
    on.disabled = game.ended;
  };
  return { element, pause, seek, stepOn: () => on.click(), update };
}

// Returns a function that goes to a step. Only one request is sent at a time; of the steps requested meanwhile, only
// the last one counts.
function makeSeek(game, pause) {
  let seeking = null;
  return function seek(step) {
    pause(true);
    if (seeking !== null) {
      seeking = step;
      return;
    }
    seeking = step;
    game.engine.handle("seek", { env: game.env.env, step: Math.max(0, step) }).catch(game.report).finally(() => {
      const next = seeking;
      seeking = null;
      if (next !== step) seek(next);
    });
  };
}

function speedMenu(game) {
  const { asked } = game;
  const speeds = SPEEDS.includes(asked.speed) ? SPEEDS : [...SPEEDS, asked.speed].sort((a, b) => a - b);
  const menu = h("select", { "aria-label": "Speed" }, speeds.map((value) => h("option", { value: String(value), selected: value === asked.speed }, `${value}×`)));
  menu.addEventListener("change", () => game.set({ speed: (asked.speed = Number(menu.value)) }));
  return h("label", { class: "speed" }, h("span", { class: "visually-hidden" }, "Speed"), menu);
}
