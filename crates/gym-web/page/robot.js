// The page of the reader's own robot: drop a folder or an archive, choose a model, watch it and drive it. This module
// reads the files and opens the model; `robotview.js` shows it.
import { h } from "./dom.js";
import { LIMITS_IN_WORDS, contents, models, ofDrop, ofList } from "./dropped.js";
import { Engine } from "./engine.js";
import { robotView } from "./robotview.js";
import { SAMPLE } from "./sample.js";

const HERE = "The files are read, simulated and drawn on this machine. Nothing is sent anywhere.";

export function robot(main) {
  const page = { main, engine: new Engine(), end: () => {}, read: new Map(), left: false };
  page.ask = (request, bytes) => page.engine.request({ do: "robot", ask: request }, bytes);
  page.fail = (error) => {
    page.read = new Map();
    choose(page, error.message);
  };
  const endDrops = listenToDrops(page);
  const embedded = globalThis.GYM_ROBOT;
  if (embedded) openCompiled(page, embedded);
  else choose(page);
  return () => {
    page.left = true;
    page.end();
    endDrops();
    page.engine.end();
  };
}

// Files may be dropped anywhere on the page, also on a robot that is shown.
function listenToDrops(page) {
  const listener = new AbortController();
  const on = (type, f) => addEventListener(type, f, { signal: listener.signal });
  const over = (is) => page.main.classList.toggle("dragged", is);
  on("dragover", (event) => {
    if (![...(event.dataTransfer?.types ?? [])].includes("Files")) return;
    event.preventDefault();
    over(true);
  });
  on("dragleave", (event) => event.relatedTarget === null && over(false));
  on("drop", (event) => {
    event.preventDefault();
    over(false);
    take(page, ofDrop(event.dataTransfer));
  });
  return () => listener.abort();
}

// Ends what the page shows.
function end(page) {
  page.end();
  page.end = () => {};
}

// Shows where to drop a robot, and what went wrong with the last one.
function choose(page, fault = null) {
  end(page);
  const input = (attributes) => {
    const element = h("input", { type: "file", class: "visually-hidden", tabIndex: -1, ...attributes });
    element.addEventListener("change", () => element.files.length && take(page, ofList(element.files)));
    return element;
  };
  const [folder, file] = [input({ webkitdirectory: true, id: "robot-folder" }), input({ accept: ".zip,.xml,.mjcf", id: "robot-file" })];
  const sample = () => open(page, new Map([["sample/robot.xml", new TextEncoder().encode(SAMPLE)]]), "sample/robot.xml");
  page.main.replaceChildren(h("div", {},
    h("div", { class: "play-head" },
      h("h1", {}, "Your robot"),
      h("p", {}, "See a robot move: any model in ", h("a", { href: "https://mujoco.readthedocs.io/en/stable/modeling.html" }, "MJCF"), ", the format of MuJoCo, with its meshes and textures.")),
    fault && h("div", { class: "card message error", role: "alert" }, h("strong", {}, "This robot cannot be shown."), h("pre", { class: "fault" }, fault), h("p", { class: "quiet" }, advice(fault))),
    h("div", { class: "drop robot-drop" },
      h("strong", {}, "Drop a folder or a .zip here"),
      h("span", {}, "or choose it:"),
      h("div", { class: "buttons" },
        h("button", { type: "button", class: "primary", onclick: () => folder.click() }, "Choose a folder"),
        h("button", { type: "button", onclick: () => file.click() }, "Choose a .zip or .xml")),
      folder, file,
      h("p", { class: "quiet" }, HERE),
      h("p", { class: "quiet" }, LIMITS_IN_WORDS)),
    h("div", { class: "card robot-sample" },
      h("h2", {}, "No robot at hand?"),
      h("p", {}, "Start with a table on four legs: it lies on the ground, and stands up if you move its sliders to the right, the upper ones first."),
      h("button", { type: "button", id: "robot-sample", onclick: sample }, "Try the table"),
      h("p", { class: "quiet" }, "Or take a robot of ", h("a", { href: "https://github.com/google-deepmind/mujoco_menagerie" }, "MuJoCo Menagerie"), ": download it, unpack it, and drop the folder of one robot, such as unitree_go2."))));
}

// Returns what to do about a message of the engine or of this page.
function advice(fault) {
  if (/there is no file/.test(fault)) return "The model names a file that was not among the dropped ones. Drop the folder that holds the model and all of its files: meshes are often in a folder beside it.";
  if (/limit is|more than \d+ files/.test(fault)) return LIMITS_IN_WORDS;
  if (/module stopped|memory/.test(fault)) return "The model needs more memory than a browser gives a page. Simplify its meshes.";
  if (/line \d+: </.test(fault)) return "The message names file and line. What MJCF has and this engine lacks is refused rather than simulated wrongly.";
  return "Mend it, and drop the robot again.";
}

// Shows a message while files are read or a model is compiled, how long that takes so far, and a button to stop.
function wait(page, text) {
  end(page);
  const [since, passed] = [performance.now(), h("output", {})];
  const clock = setInterval(() => (passed.textContent = ` ${Math.round((performance.now() - since) / 1000)} s`), 1000);
  page.end = () => clearInterval(clock);
  const stop = () => {
    page.job = null;
    page.engine.end();
    page.engine = new Engine();
    choose(page);
  };
  page.main.replaceChildren(h("div", { class: "card failure", role: "status" }, h("h1", {}, "One moment"), h("p", {}, text, passed), h("div", { class: "buttons" }, h("button", { type: "button", onclick: stop }, "Stop"))));
}

// Runs a job unless the reader leaves, stops it or starts another. Its errors are shown where a robot is chosen.
async function work(page, job) {
  const own = (page.job = {});
  const goesOn = () => page.job === own && !page.left;
  try {
    await job(goesOn);
  } catch (error) {
    if (goesOn()) choose(page, error.message);
  }
}

// Reads dropped or chosen files. If several models are among them, the reader chooses.
const take = (page, listed) => work(page, async (goesOn) => {
  wait(page, "Looking at the files …");
  const files = await listed;
  if (!goesOn()) return;
  wait(page, `Reading ${files.length} files …`);
  const read = await contents(files);
  const { all, whole } = models(read);
  if (!goesOn()) return;
  if (all.length === 0) {
    const named = files.slice(0, 3).map(({ path }) => path).join(", ");
    throw new Error(files.length ? `There is no model among ${files.length} files (${named}${files.length > 3 ? ", …" : ""}): an .xml file with the element <mujoco> is needed.` : "No file was dropped.");
  }
  // models that are all parts of each other are an error, which the engine tells
  const mains = whole.length ? whole : all.slice(0, 1);
  if (mains.length === 1) await opening(page, read, mains[0], goesOn);
  else chooseModel(page, read, mains);
});

function chooseModel(page, read, paths) {
  end(page);
  const menu = h("ul", { class: "robot-models" }, paths.map((path) => h("li", {}, h("button", { type: "button", onclick: () => open(page, read, path) }, path))));
  page.main.replaceChildren(h("div", { class: "card failure" }, h("h1", {}, "Which model?"), h("p", {}, `${paths.length} models are among ${read.size} files. The one named scene has a floor, if there is one.`), menu, h("p", {}, h("button", { type: "button", onclick: () => choose(page) }, "Other files"))));
  menu.querySelector("button").focus();
}

const open = (page, read, path) => work(page, (goesOn) => opening(page, read, path, goesOn));

// Gives the files to the module, which compiles the model.
async function opening(page, read, path, goesOn) {
  wait(page, `Compiling ${path} …`);
  if (page.read !== read) {
    await page.ask({ do: "forget" });
    page.read = new Map();
    for (const [path, bytes] of read) await page.ask({ do: "file", path }, bytes);
    page.read = read;
  }
  const model = await page.ask({ do: "open", main: path }).catch((error) => {
    // an instance that stopped took the files with it
    if (/module stopped/.test(error.message)) page.read = new Map();
    throw error;
  });
  if (!goesOn()) return;
  const { whole, all } = models(read);
  const others = whole.length > 1 ? whole : all;
  show(page, model, path, {
    others, open: (other) => open(page, read, other), leave: () => choose(page),
  });
}

// Opens the compiled model that stands in the page: its JSON, packed with gzip, in base64.
const openCompiled = (page, text) => work(page, async (goesOn) => {
  wait(page, "Opening the model …");
  const packed = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"));
  const model = await page.ask({ do: "compiled" }, new Uint8Array(await new Response(stream).arrayBuffer()));
  if (goesOn()) show(page, model, "", { others: [], open: null, leave: null });
});

function show(page, model, path, files) {
  page.end();
  page.end = robotView(page, model, path, files);
}
