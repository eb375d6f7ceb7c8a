// The choice of the player, and the keys, buttons and sliders with which a person plays.
import { isTouched } from "./address.js";
import { h, number } from "./dom.js";
import { Keys, SYMBOLS } from "./keys.js";
import { plain } from "./pages.js";

export const POLICIES = { good: "Good policy", random: "Random", none: "You" };

// Makes the choice of the player: the good policy, random actions, or the person.
export function makePlayers(game) {
  const { asked, environment } = game;
  const element = h("div", { class: "segmented", role: "radiogroup", "aria-label": "Who plays" });
  function choose(by) {
    asked.by = by;
    asked.script = null;
    game.set({ by, script: null });
    game.hands.show();
    if (by === "none" && asked.paused) game.pause(false);
    if (game.ended) game.reset();
  }
  const show = () => {
    const choices = [environment.policy ? "good" : null, "random", "none"].filter(Boolean);
    element.replaceChildren(...choices.map((by) => h("label", {},
      h("input", { type: "radio", name: "who", value: by, checked: asked.by === by, onchange: () => choose(by) }),
      h("span", { class: `who-${by}` }, POLICIES[by]))));
  };
  return { element, show };
}

// Makes the controls for the action space: keys if the registration names keys, buttons for a few discrete actions,
// sliders for numbers.
export function makeHands(game, actionNames) {
  const { asked, engine, environment } = game;
  const element = h("div", { class: "pad" });
  let keys = null;
  const waits = () => !game.env.keys || game.env.keys.idle === "wait";
  const name = (action) => (typeof action === "number" ? actionNames.get(action)?.name : undefined);

  // Plays `action`, the action of the pressed keys; `null` if no key is pressed.
  function hold(action) {
    if (game.env === null) return;
    taken(action !== null);
    if (!waits()) game.set({ held: action });
  }
  // Takes one step with `action`, if the environment waits for a key.
  function press(action) {
    if (game.env === null || !waits()) return;
    if (game.ended) game.reset(String(BigInt(game.seed()) + 1n));
    else engine.handle("step", { env: game.env.env, action }).catch(game.report);
  }
  function taken(byHand) {
    game.stage.byHand(byHand && asked.by !== "none");
    for (const button of element.querySelectorAll("[data-key]")) button.classList.toggle("down", keys.isDown(button.dataset.key));
    if (byHand && asked.paused && game.env.keys?.idle !== "wait") game.pause(false);
  }
  function show() {
    const { action_space: space } = game.env;
    const list = game.env.keys?.actions ?? [];
    keys?.end();
    keys = new Keys(list, { changed: hold, pressed: press });
    const meaning = (action) => name(action) ?? (typeof action !== "number" ? JSON.stringify(action) : list.length ? "" : `action ${action}`);
    element.replaceChildren();
    if (list.length) element.append(keyList(list.map(([key, action]) => keyButton(keys, key, meaning(action)))));
    else if (space.kind === "Discrete" && space.n <= 18) {
      const actions = Array.from({ length: space.n }, (_, i) => space.start + i);
      element.append(keyList(actions.map((action) => h("button", { type: "button", class: "key", onclick: () => press(action) }, meaning(action)))));
    } else if (space.kind === "Box" && space.shape.length === 1 && space.low && space.shape[0] <= 24) {
      element.append(sliders(space, game.env.names.action[""] ?? [], (held) => {
        taken(held !== null);
        game.set({ held });
        if (held === null) show();
      }));
    }
    if (asked.by === "good") element.append(h("p", { class: "hint" }, `The good policy ${plain(environment.policy)}.`));
    element.append(h("p", { class: "hint" }, hint({ hasKeys: list.length > 0, isBox: space.kind === "Box", isYou: asked.by === "none", waits: waits() })));
  }
  return { element, show, end: () => keys?.end() };
}

const keyList = (buttons) => h("div", { class: "key-list" }, buttons);

// Returns instructions for the person, for a keyboard or for a touch screen.
export function hint({ hasKeys, isBox, isYou, waits }, touched = isTouched()) {
  if (!hasKeys) return isBox ? "Move a slider to act; every other joint rests." : "";
  if (isYou) return waits ? `Each ${touched ? "tap" : "press"} is one step.` : touched ? "Hold the buttons." : "Hold the keys, or the buttons.";
  if (waits) return touched ? "Tap a button to take one step yourself." : "Press a key to take one step yourself.";
  return `Hold a ${touched ? "button" : "key"} to take over; let go to hand back.`;
}

function keyButton(keys, name, meaning) {
  const button = h("button", { type: "button", class: "key", "data-key": name }, h("kbd", {}, SYMBOLS[name] ?? name.replace(/^Key(?=\d)/, "")), meaning && h("span", {}, meaning));
  button.setAttribute("aria-label", `${name} ${meaning}`);
  button.addEventListener("pointerdown", (event) => {
    event.preventDefault();
    button.setPointerCapture(event.pointerId);
    keys.press(name);
  });
  for (const type of ["pointerup", "pointercancel", "lostpointercapture"]) button.addEventListener(type, () => keys.release(name));
  // a click by keyboard has no pointer events: press the key, and release it soon after
  button.addEventListener("click", (event) => {
    if (event.detail !== 0) return;
    keys.press(name);
    setTimeout(() => keys.release(name), 150);
  });
  return button;
}

// Makes a slider for each number of the action, with its name. Calls `act` with all numbers, or with `null` when the person lets go.
function sliders(space, names, act) {
  const values = space.low.map((low, i) => Math.max(low, Math.min(space.high[i], 0)));
  const rows = values.map((value, i) => {
    const name = names[i] ?? `action ${i}`;
    const input = h("input", { type: "range", min: String(space.low[i]), max: String(space.high[i]), step: "any", "aria-label": name });
    input.value = String(value);
    const output = h("output", {}, number(value));
    input.addEventListener("input", () => {
      values[i] = Number(input.value);
      output.textContent = number(values[i]);
      act([...values]);
    });
    return h("label", { class: "action-slider" }, h("span", {}, name), input, output);
  });
  return h("div", { class: "sliders" }, rows, h("button", { type: "button", onclick: () => act(null) }, "Let go"));
}
