// The picture of an environment, the camera that the user can turn, and the end of the episode as text over the
// picture.
import { isTouched } from "./address.js";
import { h, number } from "./dom.js";

// Returns the elements, and the functions `fit(env)`, `byHand(is)` and `over(state)`.
export function makeStage(game) {
  const canvas = h("canvas", { class: "picture", width: 600, height: 400, role: "img", "aria-label": `Picture of ${game.id}` });
  const badge = h("span", { class: "badge", hidden: true }, "You");
  const overlay = h("div", { class: "over", hidden: true });
  const nearer = isTouched() ? "pinch to come nearer" : "pinch, or Ctrl and the wheel, to come nearer";
  const hint = h("p", { class: "turn-hint", hidden: true }, `Drag to turn the camera; ${nearer}.`);
  const element = h("div", { class: "stage" }, canvas, badge, overlay);
  const camera = makeCamera(game);
  byPointers(canvas, game, camera);
  byKeys(canvas, game, camera);
  return {
    element, canvas, hint,
    // Applies the picture's size of a newly opened environment.
    fit({ size: [width, height], turns }) {
      element.style.aspectRatio = `${width} / ${height}`;
      element.style.setProperty("--wide", width / height);
      canvas.classList.toggle("pixelated", width < 300);
      canvas.classList.toggle("turns", turns);
      if (turns) canvas.tabIndex = 0;
      hint.hidden = !turns;
    },
    byHand(is) {
      badge.hidden = !is;
    },
    // Shows how the episode ended, if it has ended.
    over({ terminated, truncated, steps, return: sum }) {
      overlay.hidden = !(terminated || truncated);
      if (!overlay.hidden) overlay.replaceChildren(h("strong", {}, terminated ? "Terminated" : "Truncated"), ` after ${steps} steps, return ${number(sum)}`);
    },
  };
}

// Returns a function that turns the camera. Turns are summed, and sent at most once per animation frame.
function makeCamera({ engine }) {
  let turned = null;
  return (play, azimuth, elevation, zoom = 1) => {
    const isFirst = turned === null;
    const sum = turned ?? [0, 0, 1];
    turned = [sum[0] + azimuth, sum[1] + elevation, sum[2] * zoom];
    if (isFirst) requestAnimationFrame(() => {
      engine.handle("turn", { env: play.env.env, by: turned }).catch(play.report);
      turned = null;
    });
  };
}

// One pointer turns the camera; two pointers, or Ctrl with the wheel, change its distance.
function byPointers(canvas, game, turn) {
  const pointers = new Map();
  const distance = (a, b) => Math.hypot(a.clientX - b.clientX, a.clientY - b.clientY) || 1;
  canvas.addEventListener("pointerdown", (event) => {
    if (!game.env?.turns) return;
    canvas.setPointerCapture(event.pointerId);
    pointers.set(event.pointerId, event);
  });
  canvas.addEventListener("pointermove", (event) => {
    const before = pointers.get(event.pointerId);
    if (!before) return;
    const others = [...pointers.values()].filter((other) => other.pointerId !== event.pointerId);
    if (others.length) turn(game, 0, 0, distance(others[0], before) / distance(others[0], event));
    else turn(game, (before.clientX - event.clientX) * 0.5, (before.clientY - event.clientY) * 0.35);
    pointers.set(event.pointerId, event);
  });
  for (const type of ["pointerup", "pointercancel"]) canvas.addEventListener(type, (event) => pointers.delete(event.pointerId));
  canvas.addEventListener("wheel", (event) => {
    if (!game.env?.turns || !(event.ctrlKey || event.metaKey)) return;
    event.preventDefault();
    turn(game, 0, 0, Math.exp(event.deltaY * 0.002));
  }, { passive: false });
}

// While the picture has the focus, the arrow keys turn the camera, and plus and minus change its distance.
function byKeys(canvas, game, turn) {
  const turns = { ArrowLeft: [-5, 0], ArrowRight: [5, 0], ArrowUp: [0, -5], ArrowDown: [0, 5], "+": [0, 0, 0.9], "-": [0, 0, 1 / 0.9] };
  canvas.addEventListener("keydown", (event) => {
    const by = turns[event.key];
    if (!game.env?.turns || !by) return;
    event.preventDefault();
    turn(game, ...by);
  });
}
