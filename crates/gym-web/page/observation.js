// Shows an observation as names, bars and numbers, or as a picture.
import { h, number } from "./dom.js";
import { paint } from "./engine.js";

const MOST_BARS = 64;
const SPARK = 120; // values in the small chart

// Returns an element that shows observations of a space, and the function `update(observation)`.
export function observationView(space, names) {
  if (space.kind === "Box" && space.shape.length >= 2) return pictureView(space);
  if (space.kind === "Box") return barsView(space, names);
  const value = h("output", { class: "big-value" });
  const of = space.kind === "Discrete" ? h("span", { class: "quiet" }, ` of ${space.n} states`) : null;
  const text = (observation) => (Array.isArray(observation) ? `(${observation.map(text).join(", ")})` : typeof observation === "number" ? number(observation) : JSON.stringify(observation));
  return { element: h("p", { class: "one-value" }, value, of), update: (observation) => (value.textContent = text(observation)) };
}

function pictureView(space) {
  const canvas = h("canvas", { class: "sight", width: space.shape[1], height: space.shape[0], role: "img", "aria-label": "The picture that the agent sees" });
  const element = h("div", {}, canvas, h("p", { class: "quiet" }, `The agent sees this picture: ${space.shape.join(" × ")} numbers.`));
  return { element, update() {}, wantsSight: true, see: (size, pixels) => paint(canvas, size, pixels) };
}

function barsView(space, names) {
  const count = space.shape.reduce((a, b) => a * b, 1);
  const shown = Math.min(count, MOST_BARS);
  const bounds = (i) => [space.low?.[i], space.high?.[i]].map((bound) => (typeof bound === "number" && Math.abs(bound) < 1e30 ? bound : null));
  const seen = Array.from({ length: shown }, () => 1e-9);
  const history = Array.from({ length: shown }, () => []);
  const rows = Array.from({ length: shown }, (_, i) => {
    const named = names[i];
    const name = named ? named.name + (named.part ? ` ${named.part}` : "") : `number ${i}`;
    const bar = h("span", { class: "bar-fill" });
    const spark = document.createElementNS("http://www.w3.org/2000/svg", "svg");
    spark.setAttribute("viewBox", `0 0 ${SPARK} 20`);
    spark.setAttribute("preserveAspectRatio", "none");
    spark.classList.add("spark");
    const line = document.createElementNS(spark.namespaceURI, "polyline");
    spark.append(line);
    spark.setAttribute("aria-hidden", "true");
    const value = h("output", { class: "bar-value" });
    const element = h("div", { class: "bar-row" },
      h("span", { class: "bar-name", title: named?.unit ? `${name}, in ${named.unit}` : name }, name),
      h("span", { class: "bar", "aria-hidden": "true" }, bar), spark, value);
    return { element, bar, line, value };
  });
  const element = h("div", { class: "bars" }, rows.map((row) => row.element), count > shown ? h("p", { class: "quiet" }, `and ${count - shown} more`) : null);
  // the end of a bar is the bound, or the greatest number so far if there is no bound
  const update = (observation) => {
    for (let i = 0; i < shown; i++) {
      const x = Number(observation[i]);
      const [low, high] = bounds(i);
      seen[i] = Math.max(seen[i], Math.abs(x));
      const most = low !== null && high !== null && Math.max(-low, high) < 1e3 ? Math.max(Math.abs(low), Math.abs(high)) : seen[i];
      const share = Math.max(-1, Math.min(1, x / most)) * 50;
      rows[i].bar.style.left = `${50 + Math.min(0, share)}%`;
      rows[i].bar.style.width = `${Math.abs(share)}%`;
      rows[i].value.textContent = number(x);
      const past = history[i];
      past.push(x / most);
      if (past.length > SPARK) past.shift();
      rows[i].line.setAttribute("points", past.map((y, t) => `${SPARK - past.length + t},${(10 - 9 * Math.max(-1, Math.min(1, y))).toFixed(1)}`).join(" "));
    }
  };
  return { element, update };
}
