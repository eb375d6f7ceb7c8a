// Starts the page and shows the part that the address names:
//   #/                    the gallery        #/CartPole-v1?seed=7&policy=good   an environment
//   #/learn/FrozenLake-v1 a lesson   #/robot                            the reader's own robot
import { parse } from "./address.js";
import { h, icon } from "./dom.js";
import { Engine } from "./engine.js";
import { gallery } from "./gallery.js";
import { play } from "./play.js";
import { lessons } from "./lessons.js";
import { robot } from "./robot.js";

const main = document.getElementById("main");
// a page with a model in it shows that model alone
const isAlone = globalThis.GYM_ROBOT !== undefined;
const engine = isAlone ? null : new Engine();
let leave = () => {};
let environments = [];
let hasRobots = isAlone;

function fail(error) {
  console.error(error);
  main.replaceChildren(h("section", { class: "card failure", role: "alert" }, h("h1", {}, "That did not work"), h("p", {}, error.message), h("p", {}, h("a", { href: "#/" }, "Back to the gallery"))));
}

// Replaces the list of environments, for instance when the user has provided a ROM.
function refresh(list, again = true) {
  environments = list;
  if (again) show();
}

async function show() {
  leave();
  leave = () => {};
  try {
    const { path, parameters } = parse(location.hash);
    const part = isAlone || path === "robot" ? "robot" : /^learn(\/|$)/.test(path) ? "learn" : "gallery";
    for (const link of document.querySelectorAll("[data-part]")) {
      if (link.dataset.part === part) link.setAttribute("aria-current", "page");
      else link.removeAttribute("aria-current");
    }
    if (part === "robot" && !hasRobots) throw new Error("This gallery was built without MuJoCo's physics, and shows no robots.");
    if (part === "robot") [document.title, leave] = ["Your robot, live", robot(main)];
    else if (path === "") [document.title, leave] = ["Gymnasium's environments, live", gallery(main, engine, environments, hasRobots)];
    else if (part === "learn") [document.title, leave] = ["Learn: reinforcement learning, live", await lessons(main, path.slice("learn/".length), environments)];
    else [document.title, leave] = [`${path}, live`, await play(main, engine, environments, path, parameters, refresh)];
  } catch (error) {
    fail(error);
  }
}

// The button for the light or dark theme. The system's theme applies until the button is pressed; this browser stores
// the choice.
function themes() {
  const button = document.getElementById("theme");
  button.append(icon("sun"));
  const stored = (() => {
    try { return localStorage.getItem("theme"); } catch { return null; }
  })();
  if (stored) document.documentElement.dataset.theme = stored;
  button.addEventListener("click", () => {
    const dark = document.documentElement.dataset.theme ?? (matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light");
    const next = dark === "dark" ? "light" : "dark";
    document.documentElement.dataset.theme = next;
    try { localStorage.setItem("theme", next); } catch { /* a file may keep nothing */ }
  });
}

themes();
try {
  document.documentElement.classList.toggle("alone", isAlone);
  if (!isAlone) {
    environments = await engine.request({ do: "list" });
    // a gallery may be without MuJoCo
    hasRobots = await engine.request({ do: "robot", ask: { do: "forget" } }).then(() => true, () => false);
    document.querySelector("[data-part=robot]").hidden = !hasRobots;
  }
  const route = () => show().then(() => scrollTo(0, 0));
  addEventListener("hashchange", route);
  route();
  // the tests wait for this attribute
  document.documentElement.dataset.ready = String(environments.length);
} catch (error) {
  fail(error);
}
