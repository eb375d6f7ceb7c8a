// Lessons: an agent learns in its own worker while its policy plays, and the page draws the learned values.
import { h, number } from "./dom.js";
import { Engine, paint } from "./engine.js";
import { plot, smooth } from "./plot.js";

// Describes a grid: its borders as shares of the picture, and the direction of each action.
const grid = (rows, columns, moves, { left = 0, top = 0, right = 1, bottom = 1 } = {}) => ({ rows, columns, moves, left, top, right, bottom });

export const LESSONS = [
  {
    id: "FrozenLake-v1", title: "FrozenLake", method: "tabular", kwargs: { is_slippery: false },
    options: [{ name: "is_slippery", label: "Slippery ice" }],
    map: grid(4, 4, ["left", "down", "right", "up"]),
    state: (row, column) => row * 4 + column,
    text: "The agent starts knowing nothing. The only reward is at the goal, so the first success comes by luck; from then on values spread back from the goal, one step for each visit. On slippery ice the best action is often to walk against the wall.",
    defaults: { step_size: 0.2, epsilon_decay: 0.995 },
    // at the usual pace the first success takes many seconds
    pace: 100,
  },
  {
    id: "CliffWalking-v1", title: "CliffWalking", method: "tabular", kwargs: {},
    options: [{ name: "is_slippery", label: "Slippery ground" }],
    map: grid(4, 12, ["up", "right", "down", "left"]),
    state: (row, column) => row * 12 + column,
    text: "Every step costs 1, the cliff 100. Q-learning learns the shortest way, along the edge, and falls while it explores; SARSA counts its own exploration in and learns the safe way round. Switch between them and watch the arrows.",
    defaults: { step_size: 0.5, epsilon: 0.1, epsilon_decay: 1, epsilon_min: 0.1 },
  },
  {
    id: "Taxi-v4", title: "Taxi", method: "tabular", kwargs: {}, options: [],
    // grass surrounds the grid
    map: grid(5, 5, ["down", "up", "right", "left", "pick up", "drop off"], { left: 28 / 536, top: 28 / 456, right: 508 / 536, bottom: 428 / 456 }),
    state: (row, column, now) => (row * 5 + column) * 20 + (now % 20),
    text: "500 states: 25 places, times 5 of the passenger, times 4 destinations. The drawing shows the values for the passenger and the destination of the episode that is played now.",
    defaults: { step_size: 0.4, epsilon: 0.3, epsilon_decay: 0.999, epsilon_min: 0.02 },
  },
  {
    id: "CartPole-v1", title: "CartPole", method: "cross_entropy", kwargs: {}, options: [],
    names: ["position", "velocity", "angle", "angular velocity", "constant"],
    text: "A policy search: each generation tries a population of random weights, and the best few decide where the next generation looks. The policy is linear: the weights times what is seen. Pushing right is better where their sum is positive.",
    defaults: {},
    pace: 100,
  },
];

const TABULAR = [
  { name: "update", label: "Method", values: [["q_learning", "Q-learning"], ["sarsa", "SARSA"], ["expected_sarsa", "Expected SARSA"]], value: "q_learning", text: "what an update aims at: the best next action, the one that is taken next, or their mean" },
  { name: "step_size", label: "Step size α", low: 0.01, high: 1, step: 0.01, value: 0.1, text: "how much of an error one update mends" },
  { name: "discount", label: "Discount γ", low: 0.5, high: 1, step: 0.005, value: 0.99, text: "what a reward is worth one step later" },
  { name: "epsilon", label: "Exploration ε", low: 0, high: 1, step: 0.01, value: 1, text: "how often the first episodes act at random", fresh: true },
  { name: "epsilon_decay", label: "Decay of ε", low: 0.98, high: 1, step: 0.0005, value: 0.999, text: "what ε is multiplied by after each episode" },
  { name: "epsilon_min", label: "Least ε", low: 0, high: 0.5, step: 0.01, value: 0.05 },
  { name: "initial_value", label: "First values", low: -1, high: 1, step: 0.1, value: 0, text: "great ones make the agent try everything", fresh: true },
];
const CROSS_ENTROPY = [
  { name: "population", label: "Population", low: 4, high: 100, step: 1, value: 40, text: "policies in a generation" },
  { name: "elite", label: "Elite", low: 0.05, high: 0.6, step: 0.05, value: 0.2, text: "the share that makes the next one" },
  { name: "spread", label: "First spread", low: 0.1, high: 3, step: 0.1, value: 1, text: "standard deviation of the first weights", fresh: true },
  { name: "noise", label: "Extra noise", low: 0, high: 1, step: 0.05, value: 0.5, text: "added to the variance of the first generations, so that the search does not end too soon" },
  { name: "episodes", label: "Episodes each", low: 1, high: 5, step: 1, value: 1 },
];
// episodes a second; the last is as fast as the machine is
const PACES = [1, 5, 20, 100, 500, Infinity];
const PACE = 20;

const parametersOf = (lesson) => (lesson.method === "tabular" ? TABULAR : CROSS_ENTROPY);

// Returns the first parameters of a lesson.
export function firstValues(lesson) {
  return Object.fromEntries(parametersOf(lesson).map(({ name, value }) => [name, lesson.defaults[name] ?? value]));
}

// Returns the lesson of an id, or without an id the first lesson of this gallery.
function find(id, environments) {
  const there = LESSONS.filter((lesson) => environments.some((environment) => environment.id === lesson.id));
  if (!there.length) throw new Error("This gallery has none of the environments that the lessons are about.");
  if (!id) return there[0];
  const lesson = there.find((lesson) => lesson.id === id);
  if (!lesson) throw new Error(`There is no lesson “${id}”: the lessons are ${there.map((lesson) => lesson.id).join(", ")}.`);
  return lesson;
}

export async function lessons(main, id, environments) {
  const lesson = find(id, environments);
  const engine = new Engine();
  const list = parametersOf(lesson);
  const values = firstValues(lesson);
  const kwargs = { ...lesson.kwargs };
  const learner = 1;
  let env = null;
  let running = false;
  let returns = [];
  let lengths = [];
  let pace = lesson.pace ?? PACE;
  let over = false;
  let now = 0;

  const parameters = () => ({ method: lesson.method, ...values });
  const canvas = h("canvas", { class: "picture", width: 300, height: 200, role: "img", "aria-label": `The policy that was learned so far plays ${lesson.title}` });
  const drawn = h("canvas", { class: "values", role: "img", "aria-label": "The values that were learned" });
  const stage = h("div", { class: "stage" }, canvas, lesson.map ? drawn : null);
  const chart = h("canvas", { class: "chart tall", role: "img", "aria-label": "Return of each episode of training" });
  const [episodeText, meanText, thirdText] = [h("output", {}, "0"), h("output", {}, "–"), h("output", {}, "–")];
  const weights = h("div", { class: "bars" });
  const status = h("p", { class: "message error", role: "alert", hidden: true });
  const fail = (error) => {
    running = false;
    status.textContent = error.message ?? error;
    status.hidden = false;
    showRunning();
  };

  const runButton = h("button", { class: "primary", type: "button", onclick: () => (running ? stop() : run()) });
  const paceSelect = h("select", { "aria-label": "Pace" }, PACES.map((value) => h("option", { value: String(value), selected: value === pace }, value === Infinity ? "as fast as it goes" : `${value} episode${value === 1 ? "" : "s"} a second`)));
  paceSelect.addEventListener("change", () => (pace = Number(paceSelect.value)));
  const showRunning = () => {
    runButton.replaceChildren(h("span", {}, running ? "Pause" : returns.length ? "Go on" : "Learn"));
  };
  const forget = h("button", { type: "button", onclick: () => open() }, "Forget everything");

  // Trains in slices, at the chosen pace.
  async function run() {
    running = true;
    showRunning();
    let last = performance.now();
    let owed = 1;
    try {
      while (running && !over) {
        const time = performance.now();
        owed = pace === Infinity ? Infinity : Math.min(owed + ((time - last) / 1000) * pace, Math.max(1, pace / 4));
        last = time;
        if (owed >= 1) {
          const ended = await engine.request({ do: "train", learner, episodes: Math.min(Math.floor(owed), 100_000), steps: 40000 });
          owed -= ended.length;
          for (const episode of ended) {
            returns.push(episode.return);
            lengths.push(episode.length);
          }
          await show();
        }
        await new Promise((done) => setTimeout(done, 30));
      }
    } catch (error) {
      fail(error);
    }
  }
  function stop() {
    running = false;
    showRunning();
  }

  async function open() {
    stop();
    [returns, lengths] = [[], []];
    status.hidden = true;
    const seed = crypto.getRandomValues(new Uint32Array(1))[0] % 100000;
    try {
      await engine.request({ do: "learn", learner, id: lesson.id, kwargs, seed, lesson: parameters() });
      if (env) engine.close(env.env);
      env = await engine.open({ id: lesson.id, kwargs, seed: String(seed), by: "learner", learner, speed: 1, interval: 30 }, ({ frame, pixels, state, error }) => {
        if (error) return fail(error);
        if (!frame) return;
        paint(canvas, frame, pixels);
        const before = now;
        now = typeof state.observation === "number" ? state.observation : 0;
        if (lesson.map && before % 20 !== now % 20) show().catch(fail);
      });
      stage.style.aspectRatio = `${env.size[0]} / ${env.size[1]}`;
      stage.style.setProperty("--wide", env.size[0] / env.size[1]);
      await show();
    } catch (error) {
      fail(error);
    }
    showRunning();
  }

  let showing = false;
  async function show() {
    if (showing || over) return;
    showing = true;
    try {
      const { answer, attachment } = await engine.request({ do: "learned", learner });
      const learned = new Float64Array(attachment.buffer);
      episodeText.textContent = String(returns.length);
      const tail = returns.slice(-100);
      meanText.textContent = tail.length ? number(tail.reduce((a, b) => a + b, 0) / tail.length) : "–";
      thirdText.textContent = lesson.method === "tabular" ? number(answer.epsilon) : String(answer.generation);
      plot(chart, [{ values: returns, colour: "--line", width: 1, background: true }, { values: smooth(returns, Math.max(10, Math.floor(returns.length / 40))), colour: "--good", width: 2.25 }]);
      if (lesson.map) drawValues(drawn, lesson, learned, answer.actions, now);
      else drawWeights(weights, lesson, learned, answer);
    } finally {
      showing = false;
    }
  }

  const controls = list.map((parameter) => control(parameter, values, () => {
    if (!parameter.fresh || returns.length === 0) engine.request({ do: "tune", learner, lesson: parameters() }).catch(fail);
    if (parameter.fresh && returns.length === 0) open();
  }));
  const options = lesson.options.map(({ name, label }) => h("label", { class: "buttons" }, h("input", { type: "checkbox", checked: kwargs[name] === true, onchange: (event) => { kwargs[name] = event.target.checked; open(); } }), label));
  main.replaceChildren(
    h("section", { class: "hero" }, h("div", {}, h("h1", {}, "See an agent learn"), h("p", {}, "It learns here, in your browser, from nothing. Move a slider and watch what changes."))),
    h("nav", { class: "lesson-tabs", "aria-label": "Lessons" }, LESSONS.filter(({ id }) => environments.some((e) => e.id === id)).map(({ id, title }) => h("a", { href: `#/learn/${id}`, "aria-current": id === lesson.id ? "page" : null }, title))),
    h("div", { class: "lesson" },
      h("div", { class: "lesson-column" }, h("div", { class: "lesson-first" }, stage, status),
        h("section", { class: "card" }, h("p", {}, lesson.text)),
        lesson.map ? h("section", { class: "card" }, h("h2", {}, "How to read the map"), h("p", { class: "quiet" }, "Each triangle is an action: the stronger its violet, the more it is worth, between the worst and the best place of the map. The arrow is the best one. A place without an arrow was never tried.")) : h("section", { class: "card" }, h("h2", {}, "Weights of pushing right, less those of pushing left"), weights)),
      h("div", { class: "lesson-column" },
        h("section", { class: "card lesson-start" },
          h("div", { class: "buttons" }, runButton, forget, paceSelect),
          options.length ? h("div", { class: "buttons" }, options) : null),
        h("section", { class: "card" }, h("h2", {}, "Return of each episode, and its mean"), chart,
          h("div", { class: "numbers" }, [["episodes", episodeText], ["mean of 100", meanText], [lesson.method === "tabular" ? "ε now" : "generation", thirdText]].map(([name, output]) => h("div", {}, h("span", { class: "quiet" }, name), output)))),
        h("section", { class: "card sliders-list" }, h("h2", {}, "Parameters"), controls))));
  await open();
  const redraw = new ResizeObserver(() => show().catch(() => {}));
  redraw.observe(chart);
  return () => {
    over = true;
    running = false;
    redraw.disconnect();
    engine.end();
  };
}

function control({ name, label, low, high, step, values: choices, text, fresh }, values, changed) {
  const note = text || fresh ? h("p", { class: "quiet" }, text ?? "", fresh ? `${text ? "; " : ""}counts from the start` : "") : null;
  if (choices) {
    const select = h("select", {}, choices.map(([value, title]) => h("option", { value, selected: values[name] === value }, title)));
    select.addEventListener("change", () => {
      values[name] = select.value;
      changed();
    });
    return h("label", { class: "parameter" }, h("span", {}, label), select, note);
  }
  const input = h("input", { type: "range", min: String(low), max: String(high), step: String(step) });
  input.value = String(values[name]);
  const output = h("output", {}, number(values[name]));
  input.addEventListener("input", () => {
    values[name] = Number(input.value);
    output.textContent = number(values[name]);
    changed();
  });
  return h("label", { class: "parameter" }, h("span", {}, label), output, input, note);
}

const TURNS = { up: [0, -1], down: [0, 1], left: [-1, 0], right: [1, 0] };

// Draws the action values of each place as triangles, and the best action as an arrow.
function drawValues(canvas, lesson, learned, actions, now) {
  const ratio = devicePixelRatio || 1;
  const [width, height] = [canvas.clientWidth, canvas.clientHeight];
  if (!width) return;
  [canvas.width, canvas.height] = [width * ratio, height * ratio];
  const pen = canvas.getContext("2d");
  pen.scale(ratio, ratio);
  const { rows, columns, moves, left, top, right, bottom } = lesson.map;
  const [cellWidth, cellHeight] = [((right - left) * width) / columns, ((bottom - top) * height) / rows];
  const cells = [];
  for (let row = 0; row < rows; row++) {
    for (let column = 0; column < columns; column++) {
      const state = lesson.state(row, column, now);
      cells.push({ row, column, values: learned.subarray(state * actions, (state + 1) * actions) });
    }
  }
  // the colours range from the worst to the best place; worse actions, such as a fall, have no colour
  const worth = cells.filter(({ values }) => values.some((value) => value !== values[0])).map(({ values }) => Math.max(...values));
  const [least, most] = [Math.min(...worth), Math.max(...worth)];
  const share = (value) => (least === most ? Number(value >= most) : Math.max(0, Math.min(1, (value - least) / (most - least))));
  for (const { row, column, values } of cells) {
    const x = left * width + (column + 0.5) * cellWidth;
    const y = top * height + (row + 0.5) * cellHeight;
    const size = Math.min(cellWidth, cellHeight);
    const [halfWidth, halfHeight] = [cellWidth / 2 - 1, cellHeight / 2 - 1];
    if (values.every((value) => value === values[0])) continue;
    values.forEach((value, action) => {
      const turn = TURNS[moves[action]];
      if (!turn) return;
      const [dx, dy] = turn;
      pen.fillStyle = `rgb(91 61 245 / ${(0.1 + 0.7 * share(value) ** 1.3).toFixed(3)})`;
      pen.beginPath();
      pen.moveTo(x + dx * halfWidth * 0.12, y + dy * halfHeight * 0.12);
      pen.lineTo(x + (dx || -1) * halfWidth, y + (dy || -1) * halfHeight);
      pen.lineTo(x + (dx || 1) * halfWidth, y + (dy || 1) * halfHeight);
      pen.fill();
    });
    const best = values.indexOf(Math.max(...values));
    const turn = TURNS[moves[best]];
    pen.strokeStyle = pen.fillStyle = "#fff";
    pen.shadowColor = "#2a1a80";
    pen.shadowBlur = 4;
    if (turn) arrow(pen, x, y, turn, size * 0.24);
    else {
      pen.font = `700 ${Math.max(9, size * 0.2)}px system-ui, sans-serif`;
      pen.textAlign = "center";
      pen.textBaseline = "middle";
      pen.fillText(moves[best] ?? "", x, y);
    }
    pen.shadowBlur = 0;
  }
}

function arrow(pen, x, y, [dx, dy], length) {
  pen.lineWidth = Math.max(2, length / 5);
  pen.lineCap = pen.lineJoin = "round";
  const [tipX, tipY] = [x + dx * length, y + dy * length];
  pen.beginPath();
  pen.moveTo(x - dx * length, y - dy * length);
  pen.lineTo(tipX, tipY);
  pen.moveTo(tipX - (dx + dy) * length * 0.6, tipY - (dy + dx) * length * 0.6);
  pen.lineTo(tipX, tipY);
  pen.lineTo(tipX - (dx - dy) * length * 0.6, tipY - (dy - dx) * length * 0.6);
  pen.stroke();
}

// Draws the differences between the weights of the second action and those of the first.
function drawWeights(element, lesson, learned, { inputs }) {
  const row = inputs + 1;
  const difference = Array.from({ length: row }, (_, i) => learned[row + i] - learned[i]);
  const most = Math.max(...difference.map(Math.abs), 1e-9);
  element.replaceChildren(...difference.map((weight, i) => {
    const share = (weight / most) * 50;
    return h("div", { class: "bar-row", style: "grid-template-columns: 9em 1fr 5em" }, h("span", { class: "bar-name" }, lesson.names[i]), h("span", { class: "bar" }, h("span", { class: "bar-fill", style: `left:${50 + Math.min(0, share)}%;width:${Math.abs(share)}%` })), h("output", { class: "bar-value" }, number(weight)));
  }));
}
