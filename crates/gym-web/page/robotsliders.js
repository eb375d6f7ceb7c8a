// A slider for each actuator.
import { h, number } from "./dom.js";
import { card } from "./state.js";

// a name, with breaks after its parts
const broken = (name) => name.split(/(?<=[_/.])/).flatMap((part, i) => (i ? [h("wbr"), part] : [part]));

// more rows than these are left out
const MOST = 60;

// Returns the card, and the functions `update(controls)` and `restart()`.
export function sliderCard(view) {
  const { model, ask } = view;
  const rows = model.controls.slice(0, MOST).map((control, i) => slider(view, control, i));
  const restart = () => {
    rows.forEach((row) => row.set(row.start));
    return Promise.all(rows.map((row, actuator) => ask({ do: "control", actuator, value: row.start })));
  };
  const left = model.controls.length - rows.length;
  const content = rows.length
    ? [h("div", { class: "robot-sliders" }, rows.map((row) => row.element)),
      left > 0 && h("p", { class: "quiet" }, `${left} more actuators have no slider here.`),
      h("button", { type: "button", class: "small", onclick: restart }, "All to their start")]
    : [h("p", { class: "quiet" }, "This model has no actuators: it only falls, and can be pulled.")];
  return {
    element: card(`Actuators: ${model.controls.length}`, ...content), restart,
    // Shows the module's controls: a keyframe sets them too.
    update: (controls) => rows.forEach((row, i) => row.show(controls[i])),
  };
}

function slider(view, { name, range: [low, high], value }, actuator) {
  const start = Math.min(Math.max(value, low), high);
  const input = h("input", { type: "range", min: String(low), max: String(high), step: "any", "aria-label": name });
  const output = h("output", {}, number(start));
  let shown = null;
  const show = (value) => {
    if (value === shown || document.activeElement === input && held) return;
    shown = value;
    input.value = String(value);
    output.textContent = number(value);
  };
  let [held, busy, due] = [false, false, null];
  // one request at a time; of the values meanwhile, only the last one counts
  async function set(value) {
    output.textContent = number(value);
    shown = null;
    due = value;
    if (busy) return;
    busy = true;
    while (due !== null) {
      const next = due;
      due = null;
      await view.ask({ do: "control", actuator, value: next });
    }
    busy = false;
  }
  input.addEventListener("pointerdown", () => (held = true));
  for (const type of ["pointerup", "pointercancel", "blur"]) input.addEventListener(type, () => (held = false));
  input.addEventListener("input", () => set(Number(input.value)));
  input.addEventListener("dblclick", () => {
    input.value = String(start);
    set(start);
  });
  show(start);
  return {
    start, set,
    show: (value) => busy || show(value),
    element: h("label", { class: "action-slider robot-slider", title: name }, h("span", {}, broken(name)), input, output, h("span", { class: "robot-range" }, h("span", {}, number(low)), h("span", {}, number(high)))),
  };
}
