// Lessons: an agent learns in its own worker while its policy plays, and the page draws the learned values.
import { h, number } from "./dom.js";
import { Engine, paint } from "./engine.js";
import { plot, smooth } from "./plot.js";

// Describes a grid: its borders, as fractions of the picture's size, and the direction of each action.
const grid = (rows, columns, moves, { left = 0, top = 0, right = 1, bottom = 1 } = {}) => ({ rows, columns, moves, left, top, right, bottom });

export const LESSONS = [
  {
    id: "FrozenLake-v1", title: "FrozenLake", method: "tabular", kwargs: { is_slippery: false },
    options: [{ name: "is_slippery", label: "Slippery ice" }],
    map: grid(4, 4, ["left", "down", "right", "up"]),
    state: (row, column) => row * 4 + column,
    text: "The agent starts knowing nothing. The only reward is at the goal, so the first success comes by luck; from then on values spread back from the goal, one step for each visit. On slippery ice the best action is often to walk against the wall.",
    defaults: { step_size: 0.2, epsilon_decay: 0.995 },
    // at the default pace, the first success takes many seconds
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
// Episodes per second. With Infinity, the learner trains as fast as possible.
const PACES = [1, 5, 20, 100, 500, Infinity];
const PACE = 20;

const parametersOf = (lesson) => (lesson.method === "tabular" ? TABULAR : CROSS_ENTROPY);

// Returns the initial parameters of a lesson.
export function firstValues(lesson) {
  return Object.fromEntries(parametersOf(lesson).map(({ name, value }) => [name, lesson.defaults[name] ?? value]));
}

// Returns the lesson of the environment `id`. Without `id`, returns the first lesson whose environment is in this
// gallery.
function find(id, environments) {
  const there = LESSONS.filter((lesson) => environments.some((environment) => environment.id === lesson.id));
  if (!there.length) throw new Error("This gallery has none of the environments that the lessons are about.");
  if (!id) return there[0];
  const lesson = there.find((lesson) => lesson.id === id);
  if (!lesson) throw new Error(`There is no lesson “${id}”: the lessons are ${there.map((lesson) => lesson.id).join(", ")}.`);
  return lesson;
}

// Shows a lesson in `main`; returns a function that ends it.
export async function lessons(main, id, environments) {
  const lesson = find(id, environments);
  const values = firstValues(lesson);
  const kwargs = { ...lesson.kwargs };
  const view = elements(lesson);
  const fail = (error) => {
    training.stop();
    view.status.textContent = error.message ?? error;
    view.status.hidden = false;
  };
  const training = new Training(lesson, { values, kwargs, show: () => show().catch(fail), fail });
  training.running = (running) => {
    view.run.replaceChildren(h("span", {}, running ? "Pause" : training.returns.length ? "Go on" : "Learn"));
  };

  let showing = false;
  async function show() {
    if (showing) return;
    showing = true;
    try {
      const learned = await training.learned();
      if (learned) showLearned(view, lesson, training, learned);
    } finally {
      showing = false;
    }
  }
  async function open() {
    view.status.hidden = true;
    try {
      const { size } = await training.open(view.canvas);
      view.stage.style.aspectRatio = `${size[0]} / ${size[1]}`;
      view.stage.style.setProperty("--wide", size[0] / size[1]);
      await show();
    } catch (error) {
      fail(error);
    }
  }

  view.run.addEventListener("click", () => training.toggle());
  view.forget.addEventListener("click", open);
  view.pace.addEventListener("change", () => (training.pace = Number(view.pace.value)));
  const controls = parametersOf(lesson).map((parameter) => control(parameter, values, () => {
    const started = training.returns.length > 0;
    if (!parameter.fresh || !started) training.tune().catch(fail);
    if (parameter.fresh && !started) open();
  }));
  const options = lesson.options.map(({ name, label }) => {
    const onchange = (event) => {
      kwargs[name] = event.target.checked;
      open();
    };
    return h("label", { class: "buttons" }, h("input", { type: "checkbox", checked: kwargs[name] === true, onchange }), label);
  });
  main.replaceChildren(...layout(lesson, environments, view, { controls, options }));
  await open();
  const redraw = new ResizeObserver(() => show().catch(() => {}));
  redraw.observe(view.chart);
  return () => {
    redraw.disconnect();
    training.end();
  };
}

// A learner in a worker, which trains in slices, and an environment in which its policy plays.
class Training {
  learner = 1;
  engine = new Engine();
  env = null;
  returns = [];
  isRunning = false;
  over = false;
  // the cell of the playing policy, for the map
  now = 0;

  constructor(lesson, { values, kwargs, show, fail }) {
    Object.assign(this, { lesson, values, kwargs, show, fail });
    this.pace = lesson.pace ?? PACE;
  }

  parameters() {
    return { method: this.lesson.method, ...this.values };
  }

  // Makes a new learner, and starts an episode, which is drawn on `canvas`.
  async open(canvas) {
    this.stop();
    this.returns = [];
    const { engine, learner, kwargs } = this;
    const { id } = this.lesson;
    const seed = crypto.getRandomValues(new Uint32Array(1))[0] % 100000;
    await engine.request({ do: "learn", learner, id, kwargs, seed, lesson: this.parameters() });
    if (this.env) engine.close(this.env.env);
    this.env = await engine.open({ id, kwargs, seed: String(seed), by: "learner", learner, speed: 1, interval: 30 }, ({ frame, pixels, state, error }) => {
      if (error) return this.fail(error);
      if (!frame) return;
      paint(canvas, frame, pixels);
      const before = this.now;
      this.now = typeof state.observation === "number" ? state.observation : 0;
      if (this.lesson.map && before % 20 !== this.now % 20) this.show();
    });
    return this.env;
  }

  toggle() {
    if (this.isRunning) this.stop();
    else this.run();
  }

  stop() {
    this.isRunning = false;
    this.running(false);
  }

  // Trains in slices, at the chosen pace.
  async run() {
    this.isRunning = true;
    this.running(true);
    let last = performance.now();
    let owed = 1;
    try {
      while (this.isRunning && !this.over) {
        const [time, { pace }] = [performance.now(), this];
        owed = pace === Infinity ? Infinity : Math.min(owed + ((time - last) / 1000) * pace, Math.max(1, pace / 4));
        last = time;
        if (owed >= 1) {
          const episodes = Math.min(Math.floor(owed), 100_000);
          const ended = await this.engine.request({ do: "train", learner: this.learner, episodes, steps: 40000 });
          owed -= ended.length;
          for (const episode of ended) this.returns.push(episode.return);
          await this.show();
        }
        await new Promise((done) => setTimeout(done, 30));
      }
    } catch (error) {
      this.fail(error);
    }
  }

  // Applies changed parameters during the training.
  tune() {
    return this.engine.request({ do: "tune", learner: this.learner, lesson: this.parameters() });
  }

  // Returns the learned numbers and their description.
  async learned() {
    if (this.over) return null;
    const { answer, attachment } = await this.engine.request({ do: "learned", learner: this.learner });
    return { answer, numbers: new Float64Array(attachment.buffer) };
  }

  end() {
    this.over = true;
    this.isRunning = false;
    this.engine.end();
  }
}

// Makes the elements of a lesson that change.
function elements(lesson) {
  const paceName = (value) => (value === Infinity ? "as fast as it goes" : `${value} episode${value === 1 ? "" : "s"} a second`);
  const canvas = h("canvas", { class: "picture", width: 300, height: 200, role: "img", "aria-label": `The policy that was learned so far plays ${lesson.title}` });
  const map = h("canvas", { class: "values", role: "img", "aria-label": "The values that were learned" });
  return {
    canvas,
    map,
    stage: h("div", { class: "stage" }, canvas, lesson.map ? map : null),
    chart: h("canvas", { class: "chart tall", role: "img", "aria-label": "Return of each episode of training" }),
    numbers: { episodes: h("output", {}, "0"), mean: h("output", {}, "–"), third: h("output", {}, "–") },
    weights: h("div", { class: "bars" }),
    status: h("p", { class: "message error", role: "alert", hidden: true }),
    run: h("button", { class: "primary", type: "button" }),
    forget: h("button", { type: "button" }, "Forget everything"),
    pace: h("select", { "aria-label": "Pace" }, PACES.map((value) => h("option", { value: String(value), selected: value === (lesson.pace ?? PACE) }, paceName(value)))),
  };
}

// Places the elements of a lesson on the page.
function layout(lesson, environments, view, { controls, options }) {
  const card = (title, ...children) => h("section", { class: "card" }, title ? h("h2", {}, title) : null, ...children);
  const howToRead = "Each triangle is an action: the stronger its violet, the more it is worth, between the worst and the best place of the map. The arrow is the best one. A place without an arrow was never tried.";
  const tab = ({ id, title }) => h("a", { href: `#/learn/${id}`, "aria-current": id === lesson.id ? "page" : null }, title);
  const { episodes, mean, third } = view.numbers;
  const numbers = [["episodes", episodes], ["mean of 100", mean], [lesson.method === "tabular" ? "ε now" : "generation", third]];
  return [
    h("section", { class: "hero" }, h("div", {}, h("h1", {}, "See an agent learn"), h("p", {}, "It learns here, in your browser, from nothing. Move a slider and watch what changes."))),
    h("nav", { class: "lesson-tabs", "aria-label": "Lessons" }, LESSONS.filter(({ id }) => environments.some((e) => e.id === id)).map(tab)),
    h("div", { class: "lesson" },
      h("div", { class: "lesson-column" },
        h("div", { class: "lesson-first" }, view.stage, view.status),
        card(null, h("p", {}, lesson.text)),
        lesson.map ? card("How to read the map", h("p", { class: "quiet" }, howToRead)) : card("Weights of pushing right, less those of pushing left", view.weights)),
      h("div", { class: "lesson-column" },
        h("section", { class: "card lesson-start" },
          h("div", { class: "buttons" }, view.run, view.forget, view.pace),
          options.length ? h("div", { class: "buttons" }, options) : null),
        card("Return of each episode, and its mean", view.chart,
          h("div", { class: "numbers" }, numbers.map(([name, output]) => h("div", {}, h("span", { class: "quiet" }, name), output)))),
        h("section", { class: "card sliders-list" }, h("h2", {}, "Parameters"), controls))),
  ];
}

// Shows the returns and the learned values after a slice of training.
function showLearned(view, lesson, { returns, now }, { answer, numbers }) {
  const { episodes, mean, third } = view.numbers;
  episodes.textContent = String(returns.length);
  const tail = returns.slice(-100);
  mean.textContent = tail.length ? number(tail.reduce((a, b) => a + b, 0) / tail.length) : "–";
  third.textContent = lesson.method === "tabular" ? number(answer.epsilon) : String(answer.generation);
  const window = Math.max(10, Math.floor(returns.length / 40));
  plot(view.chart, [{ values: returns, colour: "--line", width: 1, background: true }, { values: smooth(returns, window), colour: "--good", width: 2.25 }]);
  if (lesson.map) drawValues(view.map, lesson, numbers, answer.actions, now);
  else drawWeights(view.weights, lesson, numbers, answer);
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

// Draws the action values of each cell as triangles, and the best action as an arrow.
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
  // the colours range from the worst to the best cell; values below that range, such as of a fall, have no colour
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

// Draws, for each input, the weight of the second action minus the weight of the first action.
function drawWeights(element, lesson, learned, { inputs }) {
  const row = inputs + 1;
  const difference = Array.from({ length: row }, (_, i) => learned[row + i] - learned[i]);
  const most = Math.max(...difference.map(Math.abs), 1e-9);
  element.replaceChildren(...difference.map((weight, i) => {
    const share = (weight / most) * 50;
    return h("div", { class: "bar-row", style: "grid-template-columns: 9em 1fr 5em" }, h("span", { class: "bar-name" }, lesson.names[i]), h("span", { class: "bar" }, h("span", { class: "bar-fill", style: `left:${50 + Math.min(0, share)}%;width:${Math.abs(share)}%` })), h("output", { class: "bar-value" }, number(weight)));
  }));
}
