// Shows an observation as names, bars and numbers, or as a picture.
import { h, number } from "./dom.js";
import { paint } from "./engine.js";

const MOST_BARS = 512; // of an observation with more numbers only the shape is sent
const MOST_SPARKS = 64;
const SPARK = 120; // values in the small chart

// Returns an element that shows observations of a space, and the function `update(observation)`. `names` has the names
// of the numbers by the part of the space: `names["goal/door"]`, and `names[""]` for the space itself.
export function observationView(space, names) {
  if (space.kind === "Box" && space.shape.length >= 2) return pictureView(space);
  return partView(space, names, "");
}

function partView(space, names, path) {
  if (space.kind === "Dict" || space.kind === "Tuple") {
    const members = space.kind === "Dict" ? space.spaces : space.spaces.map((member, i) => [i, member]);
    const views = members.map(([key, member]) => [key, partView(member, names, path === "" ? `${key}` : `${path}/${key}`)]);
    const shown = views.map(([key, view]) => (space.kind === "Dict" ? [h("h3", {}, key), view.element] : view.element));
    return { element: h("div", { class: "parts" }, shown.flat()), update: (observation) => views.forEach(([key, view]) => view.update(observation[key])) };
  }
  const own = names[path] ?? [];
  const count = space.kind === "Box" ? space.shape.reduce((a, b) => a * b, 1) : 1;
  if (space.kind === "Box" && count <= MOST_BARS && (space.shape.length < 2 || own.length)) return barsView(space, count, own);
  if (space.kind === "Box") return { element: h("p", { class: "quiet" }, `${space.shape.join(" × ")} numbers`), update() {} };
  return valueView(space, own[0]);
}

// Shows one number or text.
function valueView(space, name) {
  const value = h("output", { class: "big-value" });
  const of = space.kind === "Discrete" ? h("span", { class: "quiet" }, ` of ${space.n}`) : null;
  const text = (observation) => (Array.isArray(observation) ? `(${observation.map(text).join(", ")})` : typeof observation === "number" ? number(observation) : typeof observation === "string" ? observation : JSON.stringify(observation));
  const element = h("p", { class: "one-value" }, value, of, name ? h("span", { class: "quiet" }, ` ${name}`) : null);
  return { element, update: (observation) => (value.textContent = text(observation)) };
}

function pictureView(space) {
  const canvas = h("canvas", { class: "sight", width: space.shape[1], height: space.shape[0], role: "img", "aria-label": "The picture that the agent sees" });
  const element = h("div", {}, canvas, h("p", { class: "quiet" }, `The agent sees this picture: ${space.shape.join(" × ")} numbers.`));
  return { element, update() {}, wantsSight: true, see: (size, pixels) => paint(canvas, size, pixels) };
}

function barsView(space, count, names) {
  const bounds = (i) => [space.low?.[i], space.high?.[i]].map((bound) => (typeof bound === "number" && Math.abs(bound) < 1e30 ? bound : null));
  const seen = Array.from({ length: count }, () => 1e-9);
  const history = Array.from({ length: count }, () => []);
  const rows = Array.from({ length: count }, (_, i) => {
    const name = names[i] ?? `number ${i}`;
    const bar = h("span", { class: "bar-fill" });
    const value = h("output", { class: "bar-value" });
    const row = h("div", { class: "bar-row" }, h("span", { class: "bar-name" }, name), h("span", { class: "bar", "aria-hidden": "true" }, bar));
    if (count > MOST_SPARKS) {
      row.append(h("span", { class: "spark" }), value);
      return { element: row, bar, value };
    }
    const spark = document.createElementNS("http://www.w3.org/2000/svg", "svg");
    spark.setAttribute("viewBox", `0 0 ${SPARK} 20`);
    spark.setAttribute("preserveAspectRatio", "none");
    spark.classList.add("spark");
    const line = document.createElementNS(spark.namespaceURI, "polyline");
    spark.append(line);
    spark.setAttribute("aria-hidden", "true");
    row.append(spark, value);
    return { element: row, bar, line, value };
  });
  const element = h("div", { class: "bars" }, rows.map((row) => row.element));
  // the end of a bar is the bound, or the greatest number so far if there is no bound
  const update = (observation) => {
    const numbers = [observation].flat(Infinity);
    for (let i = 0; i < count; i++) {
      const x = Number(numbers[i]);
      const [low, high] = bounds(i);
      seen[i] = Math.max(seen[i], Math.abs(x));
      const most = low !== null && high !== null && Math.max(-low, high) < 1e3 ? Math.max(Math.abs(low), Math.abs(high)) : seen[i];
      const share = Math.max(-1, Math.min(1, x / most)) * 50;
      rows[i].bar.style.left = `${50 + Math.min(0, share)}%`;
      rows[i].bar.style.width = `${Math.abs(share)}%`;
      rows[i].value.textContent = number(x);
      if (!rows[i].line) continue;
      const past = history[i];
      past.push(x / most);
      if (past.length > SPARK) past.shift();
      rows[i].line.setAttribute("points", past.map((y, t) => `${SPARK - past.length + t},${(10 - 9 * Math.max(-1, Math.min(1, y))).toFixed(1)}`).join(" "));
    }
  };
  return { element, update };
}
