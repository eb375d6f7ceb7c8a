// A robot that is open: its picture, the controls of time, sliders, cameras and sensors. The module simulates and draws;
// this page asks for a picture at a time.
import { isTouched } from "./address.js";
import { h, icon, iconButton, number } from "./dom.js";
import { paint } from "./engine.js";
import { hands } from "./robothands.js";
import { sensorCard } from "./robotsensors.js";
import { sliderCard } from "./robotsliders.js";
import { card } from "./state.js";

const SPEEDS = [0.1, 0.25, 0.5, 1, 2, 4];
// the sides of a moving picture, in pixels, and how long the timesteps and the drawing of a picture may take, in milliseconds
const WIDEST = 960;
const [STEPPING, DRAWING] = [24, 40];

// Shows the robot. `page` asks the module; `files` opens other models, or leaves. Returns a function that ends it.
export function robotView(page, model, path, files) {
  const view = {
    page, model,
    paused: false, speed: 1, contacts: false, camera: -1, pulls: false,
    // whether a picture is due although time stands still
    stale: true, size: [640, 480], scale: 1, ended: false,
    ask: (request) => page.ask(request).then((answer) => ((view.stale = true), answer), report),
  };
  const message = h("p", { class: "message", role: "status", hidden: true });
  const say = (text, isError = false) => {
    message.textContent = text;
    message.classList.toggle("error", isError);
    message.hidden = !text;
  };
  function report(error) {
    say(error.message, true);
  }
  view.say = say;
  view.canvas = h("canvas", { class: "picture turns", width: 640, height: 480, role: "img", tabIndex: 0, "aria-label": `Picture of ${model.name || path}` });
  const clock = h("output", { class: "steps robot-clock", title: "Time of the model, and its speed" });
  const held = h("span", { class: "badge", hidden: true });
  view.hold = (name) => {
    held.textContent = name ?? "";
    held.hidden = !name;
  };
  const sliders = sliderCard(view);
  const sensors = sensorCard(view);
  const transport = makeTransport(view, clock);
  const help = helpDialog(view);
  view.toggleHelp = () => (help.open ? help.close() : help.showModal());
  const stage = h("div", { class: "stage robot-stage" }, view.canvas, held);
  const nearer = isTouched() ? "Drag to turn, two fingers to move and come nearer." : "Drag to turn, right button to move, wheel to come nearer. Ctrl and drag pulls a body.";
  page.main.replaceChildren(
    h("div", { class: "play-head robot-head" }, h("h1", {}, model.name || path.split("/").pop() || "Model"), fileMenu(files, path)),
    h("div", { class: "play robot-play" },
      h("div", { class: "play-main" }, stage, message, transport.element, h("p", { class: "turn-hint" }, nearer, " ", h("button", { type: "button", class: "small", onclick: view.toggleHelp }, "All keys: ?"))),
      h("div", { class: "play-side" }, sliders.element, sensors.element, card("Model", about(model)))),
    help);
  const endHands = hands(view, { ...transport, sliders });
  const speedOf = measure(view);
  draw(view, report, (picture) => {
    const speed = speedOf(picture.time);
    clock.textContent = `${picture.time.toFixed(2)} s${speed < 0.9 * view.speed ? ` at ${speed.toPrecision(1)}×` : ""}`;
    if (view.contacts) transport.count(picture.contacts);
    sliders.update(picture.controls);
  });
  return () => {
    view.ended = true;
    endHands();
    sensors.end();
  };
}

// Returns a function that takes the model's time and returns the speed that the last second reached.
function measure(view) {
  let [since, from, speed] = [0, Infinity, 0];
  return (time) => {
    const now = performance.now();
    if (view.paused || time < from) [since, from, speed] = [now, time, view.speed];
    else if (now > since + 1000) [speed, since, from] = [((time - from) * 1000) / (now - since), now, time];
    return speed;
  };
}

const nextFrame = () => new Promise((done) => requestAnimationFrame(done));

// Asks for pictures until the view ends: while time passes, and when something changed.
async function draw(view, report, seen) {
  let before = performance.now();
  while (!view.ended) {
    await nextFrame();
    const now = performance.now();
    const seconds = (now - before) / 1000;
    before = now;
    if (view.paused && !view.stale) continue;
    view.stale = false;
    view.size = sizeOf(view);
    try {
      const { answer, attachment } = await view.page.engine.handle("robot", { seconds, budget: STEPPING, size: view.size, fine: view.paused });
      if (view.ended) return;
      paint(view.canvas, answer, attachment);
      // a large or a detailed model is drawn with fewer pixels while it moves
      if (answer.drawing > DRAWING) view.scale = Math.max(0.25, view.scale * Math.max(0.5, Math.sqrt(DRAWING / answer.drawing)));
      else if (answer.drawing < DRAWING / 3) view.scale = Math.min(1, view.scale * 1.05);
      seen(answer);
    } catch (error) {
      if (view.ended) return;
      report(error);
      // without the module there is nothing to draw; a state that diverged was reset
      if (/module stopped/.test(error.message)) return view.page.fail(error);
    }
  }
}

// The size of the picture in pixels: those of the screen, within bounds.
function sizeOf(view) {
  const { clientWidth: width, clientHeight: height } = view.canvas;
  if (!width || !height) return view.size;
  const ratio = Math.min(devicePixelRatio || 1, WIDEST / width, WIDEST / height) * (view.paused ? 1 : view.scale);
  return [width, height].map((side) => Math.max(16, Math.round(side * ratio)));
}

function makeTransport(view, clock) {
  const { model, ask } = view;
  const playButton = iconButton("pause", "Pause", () => pause(!view.paused), { class: "icon-button primary" });
  function pause(paused) {
    view.paused = paused;
    playButton.replaceChildren(icon(paused ? "play" : "pause"));
    playButton.title = paused ? "Play" : "Pause";
    playButton.setAttribute("aria-label", playButton.title);
    ask({ do: "pause", is: paused });
  }
  const step = () => {
    pause(true);
    ask({ do: "step" });
  };
  const reset = (keyframe = null) => {
    view.say("");
    keyframes.value = keyframe ?? "";
    ask({ do: "reset", keyframe });
  };
  const speeds = h("select", { "aria-label": "Speed" }, SPEEDS.map((speed) => h("option", { value: String(speed), selected: speed === 1 }, `${speed}×`)));
  speeds.addEventListener("change", () => ask({ do: "speed", speed: (view.speed = Number(speeds.value)) }));
  const faster = (by) => {
    const at = Math.min(Math.max(speeds.selectedIndex + by, 0), SPEEDS.length - 1);
    if (at === speeds.selectedIndex) return;
    speeds.selectedIndex = at;
    speeds.dispatchEvent(new Event("change"));
  };
  const keyframes = h("select", { "aria-label": "Keyframe" }, h("option", { value: "" }, "Initial pose"), model.keyframes.map((name) => h("option", { value: name }, name)));
  keyframes.addEventListener("change", () => reset(keyframes.value || null));
  const nextKeyframe = () => reset(model.keyframes[(model.keyframes.indexOf(keyframes.value) + 1) % model.keyframes.length] ?? null);
  const cameras = h("select", { "aria-label": "Camera" }, h("option", { value: "-1" }, "Free camera"), model.cameras.map((name, i) => h("option", { value: String(i) }, name)));
  const look = (camera) => {
    view.camera = camera;
    cameras.value = String(camera);
    ask({ do: "camera", camera: camera < 0 ? null : camera });
  };
  cameras.addEventListener("change", () => look(Number(cameras.value)));
  const nextCamera = () => look(view.camera + 1 < model.cameras.length ? view.camera + 1 : -1);
  const counted = h("span", {}, "Contacts");
  const contacts = toggle(counted, (are) => {
    view.contacts = are;
    counted.textContent = "Contacts";
    ask({ do: "contacts", are });
  });
  const pulling = toggle(h("span", {}, "Pull"), (is) => (view.pulls = is), "Drag a body to pull it, instead of turning the camera");
  const count = (n) => (counted.textContent = `Contacts: ${n}`);
  const element = h("div", { class: "robot-controls" },
    h("div", { class: "transport" },
      iconButton("reset", "Restart", () => reset(keyframes.value || null)), playButton, iconButton("step", "One step", step), clock,
      h("label", { class: "speed" }, h("span", { class: "visually-hidden" }, "Speed"), speeds)),
    h("div", { class: "buttons" },
      model.keyframes.length ? h("label", {}, h("span", { class: "visually-hidden" }, "Keyframe"), keyframes) : null,
      model.cameras.length ? h("label", {}, h("span", { class: "visually-hidden" }, "Camera"), cameras) : null,
      contacts.element, pulling.element));
  return { element, pause, step, reset: () => reset(keyframes.value || null), nextKeyframe, nextCamera, faster, count, contacts: contacts.turn, pulling: pulling.turn };
}

// A button that is on or off.
function toggle(label, changed, title = null) {
  let is = false;
  const turn = () => {
    is = !is;
    element.setAttribute("aria-pressed", String(is));
    changed(is);
  };
  const element = h("button", { type: "button", class: "toggle", "aria-pressed": "false", title, onclick: turn }, label);
  return { element, turn };
}

// The models among the files, and the way back.
function fileMenu({ others, open, leave }, path) {
  if (!leave) return null;
  const menu = h("select", { class: "choice", "aria-label": "Model" }, others.map((other) => h("option", { value: other, selected: other === path }, other)));
  menu.addEventListener("change", () => open(menu.value));
  const shown = others.length > 1 ? menu : h("code", { class: "quiet" }, path);
  return h("p", {}, shown, " ", h("button", { type: "button", class: "small", onclick: leave }, "Another robot"));
}

function about(model) {
  const facts = [
    ["bodies", model.bodies], ["joints", `${model.joints}, ${model.freedom} degrees of freedom`], ["geoms", model.meshes ? `${model.geoms}, ${model.meshes} of meshes` : model.geoms],
    ["mass", `${number(model.mass)} kg`], ["timestep", `${number(model.timestep * 1000)} ms`], ["numbers of", `MuJoCo ${model.mujoco}`],
  ];
  return h("dl", { class: "facts" }, facts.flatMap(([name, value]) => [h("dt", {}, name), h("dd", {}, String(value))]));
}

export const KEYS = [
  ["Space", "pause or play"], [".", "one step"], ["R", "restart"], ["K", "next keyframe"], ["[ and ]", "slower, faster"],
  ["← → ↑ ↓", "turn the camera"], ["Shift and ← → ↑ ↓", "move the camera"], ["+ and −", "nearer, farther"], ["V", "next camera"],
  ["F", "follow the clicked body"], ["C", "contacts and their forces"], ["P", "pull by dragging"], ["0", "all sliders to their start"], ["?", "these keys"],
];
const POINTER = [
  ["Click a body", "its name"], ["Drag", "turn the camera"], ["Right button, or two fingers", "move the camera"], ["Wheel, or two fingers apart", "nearer, farther"],
  ["Ctrl and drag, or Pull and drag", "pull a body"], ["Double-click a slider", "to its start"],
];

function helpDialog() {
  const list = (rows) => h("dl", { class: "facts robot-keys" }, rows.flatMap(([key, meaning]) => [h("dt", {}, h("kbd", {}, key)), h("dd", {}, meaning)]));
  const dialog = h("dialog", { class: "card robot-help", "aria-label": "Keys" });
  dialog.append(h("h2", {}, "Keys"), list(KEYS), h("h2", {}, "Mouse and touch"), list(POINTER), h("button", { type: "button", class: "primary", onclick: () => dialog.close() }, "Close"));
  dialog.addEventListener("click", (event) => event.target === dialog && dialog.close());
  return dialog;
}
