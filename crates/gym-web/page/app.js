// Starts the page and shows the part that the address names:
//   #/                    the gallery        #/CartPole-v1?seed=7&policy=good   an environment
//   #/learn/FrozenLake-v1 a lesson
import { parse } from "./address.js";
import { h, icon } from "./dom.js";
import { Engine } from "./engine.js";
import { gallery } from "./gallery.js";
import { play } from "./play.js";
import { lessons } from "./lessons.js";

const main = document.getElementById("main");
const engine = new Engine();
let leave = () => {};
let environments = [];

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
    const part = /^learn(\/|$)/.test(path) ? "learn" : "gallery";
    for (const link of document.querySelectorAll("[data-part]")) {
      if (link.dataset.part === part) link.setAttribute("aria-current", "page");
      else link.removeAttribute("aria-current");
    }
    if (path === "") [document.title, leave] = ["Gymnasium's environments, live", gallery(main, engine, environments)];
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
  environments = await engine.request({ do: "list" });
  const route = () => show().then(() => scrollTo(0, 0));
  addEventListener("hashchange", route);
  route();
  // the tests wait for this attribute
  document.documentElement.dataset.ready = String(environments.length);
} catch (error) {
  fail(error);
}
