// The sensors as lines over the time of the model.
import { h, number } from "./dom.js";
import { plot } from "./plot.js";
import { card } from "./state.js";

const FIRST = 2;
const EVERY = 120; // milliseconds
const SAMPLE = 0.02; // seconds of the model between two values
const COLOURS = ["--accent", "--good", "--random", "--quiet"];
const AXES = ["x", "y", "z", "w"];

// Returns the card, and the function `end()`.
export function sensorCard(view) {
  const { sensors } = view.model;
  if (sensors.length === 0) return { element: card("Sensors", h("p", { class: "quiet" }, "This model has no sensors.")), end() {} };
  const shown = new Map();
  const list = h("div", { class: "robot-sensors" });
  const menu = h("select", { "aria-label": "Add a sensor" });
  const fill = () => {
    menu.replaceChildren(h("option", { value: "" }, "Add a sensor …"), ...sensors.flatMap(({ name }, i) => (shown.has(i) ? [] : [h("option", { value: String(i) }, name)])));
    menu.hidden = shown.size === sensors.length;
  };
  function add(i) {
    const canvas = h("canvas", { class: "chart robot-chart" });
    const value = h("output", { class: "bar-value" });
    const remove = () => {
      shown.delete(i);
      element.remove();
      fill();
    };
    const element = h("div", { class: "robot-sensor" },
      h("div", { class: "code-head" }, h("span", {}, sensors[i].name, " ", h("span", { class: "quiet" }, sensors[i].kind.toLowerCase())), h("button", { type: "button", class: "small", "aria-label": `Hide ${sensors[i].name}`, onclick: remove }, "×")),
      canvas, value);
    shown.set(i, { canvas, value });
    list.append(element);
    fill();
  }
  menu.addEventListener("change", () => menu.value !== "" && add(Number(menu.value)));
  sensors.slice(0, FIRST).forEach((_, i) => add(i));
  let busy = false;
  const timer = setInterval(async () => {
    if (busy || view.ended) return;
    busy = true;
    for (const [i, { canvas, value }] of shown) {
      const numbers = await view.page.ask({ do: "history", sensor: i }).catch(() => null);
      if (view.ended || !numbers?.length || !numbers[0].length) continue;
      const last = numbers.map((values) => number(values.at(-1)));
      // each axis in the colour of its line
      value.replaceChildren(...(last.length > 1 ? last.slice(0, 4).flatMap((text, k) => [k ? "  " : "", h("b", { style: `color: var(${COLOURS[k]})` }, AXES[k]), ` ${text}`]) : last));
      plot(canvas, numbers.slice(0, 4).map((values, k) => ({ values, colour: COLOURS[k] })), { from: 0, step: SAMPLE, unit: " s" });
    }
    busy = false;
  }, EVERY);
  return { element: card("Sensors", list, menu), end: () => clearInterval(timer) };
}
