// The page of one environment: its picture, who plays it, and what is known of its state.
import { copy, download, h, icon, iconButton, number } from "./dom.js";
import { paint } from "./engine.js";
import { families, link, words } from "./gallery.js";
import { Keys, SYMBOLS } from "./keys.js";
import { observationView } from "./observation.js";
import { actions as namedActions, markdown, names as observationNames, page, plain, section } from "./pages.js";
import { plot } from "./plot.js";
import { pack, unpack } from "./share.js";
import { argumentsForm, snippets } from "./arguments.js";

const SPEEDS = [0.1, 0.25, 0.5, 1, 2, 4, 16, 64];
const GIF_FRAMES = 600;
const POLICIES = { good: "Good policy", random: "Random", none: "You" };
const COLOURS = { good: "--good", random: "--random", none: "--you", learner: "--good", script: "--quiet" };

const randomSeed = () => String(crypto.getRandomValues(new Uint32Array(1))[0] % 100000);
const card = (title, ...content) => h("section", { class: "card" }, h("h2", {}, title), ...content);

export async function play(main, engine, environments, id, parameters, refresh) {
  const environment = environments.find((environment) => environment.id === id);
  if (!environment) throw new Error(`There is no environment “${id}” here.`);
  const versions = families(environments).get(environment.family).get(environment.name);
  const heading = h("div", { class: "play-head" },
    h("div", {}, h("h1", {}, words(environment.name), " ", versions.length > 1 ? versionMenu(versions, id) : environment.version === null ? null : h("span", { class: "version" }, `v${environment.version}`)), h("p", {}, environment.description)));
  if (environment.missing) return needs(main, engine, environment, heading, refresh);

  const [argumentList, book] = await Promise.all([engine.request({ do: "arguments", id }), page(id)]);
  const actionNames = book ? namedActions(book.text) : new Map();
  const script = parameters.get("actions") ? await unpack(parameters.get("actions")) : null;
  const preset = parameters.get("args") ? JSON.parse(parameters.get("args")) : {};

  // what the controls say
  const asked = {
    kwargs: preset,
    seed: parameters.get("seed") ?? "0",
    by: parameters.get("policy") ?? (environment.policy ? "good" : "random"),
    speed: Number(parameters.get("speed") ?? 1) || 1,
    script,
    paused: matchMedia("(prefers-reduced-motion: reduce)").matches,
  };
  if (asked.by === "good" && !environment.policy) asked.by = "random";
  let env = null; // what the worker plays
  let state = null;
  let ended = false;
  const episodes = [];

  const set = (options) => env && engine.handle("set", { env: env.env, ...options }).catch(report);
  const message = h("p", { class: "message", role: "status", hidden: true });
  function report(error) {
    message.textContent = error.message ?? error;
    message.classList.add("error");
    message.hidden = false;
  }
  function say(text) {
    message.textContent = text;
    message.classList.remove("error");
    message.hidden = !text;
  }

  // the picture
  const canvas = h("canvas", { class: "picture", width: 600, height: 400, role: "img", "aria-label": `Picture of ${id}` });
  const badge = h("span", { class: "badge", hidden: true });
  const overlay = h("div", { class: "over", hidden: true });
  const turnHint = h("p", { class: "turn-hint", hidden: true }, "Drag to turn the camera; pinch, or Ctrl and the wheel, to come nearer.");
  const stage = h("div", { class: "stage" }, canvas, badge, overlay);

  // a camera that can be turned: by dragging, by the wheel with Ctrl, by two fingers, by the arrows on the picture
  const pointers = new Map();
  let turned = null;
  function turn(azimuth, elevation, zoom = 1) {
    const fresh = turned === null;
    const sum = turned ?? [0, 0, 1];
    turned = [sum[0] + azimuth, sum[1] + elevation, sum[2] * zoom];
    if (fresh) requestAnimationFrame(() => {
      engine.handle("turn", { env: env.env, by: turned }).catch(report);
      turned = null;
    });
  }
  canvas.addEventListener("pointerdown", (event) => {
    if (!env?.turns) return;
    canvas.setPointerCapture(event.pointerId);
    pointers.set(event.pointerId, event);
  });
  canvas.addEventListener("pointermove", (event) => {
    const before = pointers.get(event.pointerId);
    if (!before) return;
    const others = [...pointers.values()].filter((other) => other.pointerId !== event.pointerId);
    const distance = (a, b) => Math.hypot(a.clientX - b.clientX, a.clientY - b.clientY) || 1;
    if (others.length) turn(0, 0, distance(others[0], before) / distance(others[0], event));
    else turn((before.clientX - event.clientX) * 0.5, (before.clientY - event.clientY) * 0.35);
    pointers.set(event.pointerId, event);
  });
  for (const type of ["pointerup", "pointercancel"]) canvas.addEventListener(type, (event) => pointers.delete(event.pointerId));
  canvas.addEventListener("wheel", (event) => {
    if (!env?.turns || !(event.ctrlKey || event.metaKey)) return;
    event.preventDefault();
    turn(0, 0, Math.exp(event.deltaY * 0.002));
  }, { passive: false });
  canvas.addEventListener("keydown", (event) => {
    const by = { ArrowLeft: [-5, 0], ArrowRight: [5, 0], ArrowUp: [0, -5], ArrowDown: [0, 5], "+": [0, 0, 0.9], "-": [0, 0, 1 / 0.9] }[event.key];
    if (!env?.turns || !by) return;
    event.preventDefault();
    turn(...by);
  });

  // transport
  const playButton = iconButton("pause", "Pause", () => pause(!asked.paused), { class: "icon-button primary" });
  function pause(paused) {
    asked.paused = paused;
    playButton.replaceChildren(icon(paused ? "play" : "pause"));
    playButton.title = paused ? "Play" : "Pause";
    playButton.setAttribute("aria-label", playButton.title);
    set({ paused });
  }
  const stepBack = iconButton("back", "One step back", () => seek(state.steps - 1));
  const stepOn = iconButton("step", "One step", () => {
    pause(true);
    engine.handle("step", { env: env.env }).catch(report);
  });
  const restart = iconButton("reset", "Restart this episode", () => reset(seedInput.value));
  const scrubber = h("input", { type: "range", class: "scrubber", min: "0", max: "0", value: "0", "aria-label": "Step of the episode" });
  scrubber.addEventListener("input", () => seek(Number(scrubber.value)));
  const stepText = h("output", { class: "steps" });
  let seeking = null;
  function seek(step) {
    pause(true);
    // one after the other; of those that come meanwhile the last counts
    if (seeking !== null) return void (seeking = step);
    seeking = step;
    engine.handle("seek", { env: env.env, step: Math.max(0, step) }).catch(report).finally(() => {
      const next = seeking;
      seeking = null;
      if (next !== step) seek(next);
    });
  }
  const speed = h("select", { "aria-label": "Speed" }, SPEEDS.map((value) => h("option", { value: String(value), selected: value === asked.speed }, value < 1 ? `${value}×` : `${value}×`)));
  speed.addEventListener("change", () => set({ speed: (asked.speed = Number(speed.value)) }));
  const transport = h("div", { class: "transport" }, restart, stepBack, playButton, stepOn, scrubber, stepText, h("label", { class: "speed" }, h("span", { class: "visually-hidden" }, "Speed"), speed));

  // who plays
  const who = h("div", { class: "segmented", role: "radiogroup", "aria-label": "Who plays" });
  function chooseWho() {
    const choices = [environment.policy ? "good" : null, "random", "none"].filter(Boolean);
    who.replaceChildren(...choices.map((by) => h("label", {},
      h("input", { type: "radio", name: "who", value: by, checked: asked.by === by, onchange: () => setWho(by) }),
      h("span", { class: `who-${by}` }, POLICIES[by]))));
  }
  function setWho(by) {
    asked.by = by;
    asked.script = null;
    set({ by, script: null });
    showKeys();
    if (by === "none" && asked.paused) pause(false);
    if (ended) reset(seedInput.value);
  }

  // keys, buttons and sliders for the action
  const pad = h("div", { class: "pad" });
  let keys = null;
  let manual = null;
  function showKeys() {
    pad.replaceChildren();
    const space = env.action_space;
    const list = env.keys?.actions ?? [];
    const waits = !env.keys || env.keys.idle === "wait";
    const hold = (action) => {
      if (env === null) return;
      taken(action !== null);
      if (!waits) set({ held: action });
    };
    const press = (action) => {
      if (!waits || env === null) return;
      if (ended) return void reset(String(BigInt(seedInput.value) + 1n));
      engine.handle("step", { env: env.env, action }).catch(report);
    };
    keys?.end();
    keys = new Keys(list, { changed: hold, pressed: press });
    const text = (action) => {
      if (typeof action === "number") return actionNames.get(action)?.name ?? (list.length ? "" : `action ${action}`);
      return JSON.stringify(action);
    };
    if (list.length) {
      pad.append(h("div", { class: "key-list" }, list.map(([name, action]) => keyButton(name, text(action)))));
    } else if (space.kind === "Discrete" && space.n <= 18) {
      pad.append(h("div", { class: "key-list" }, Array.from({ length: space.n }, (_, i) => space.start + i).map((action) => h("button", { type: "button", class: "key", onclick: () => press(action) }, text(action)))));
    } else if (space.kind === "Box" && space.shape.length === 1 && space.low && space.shape[0] <= 24) {
      pad.append(sliders(space));
    }
    if (asked.by === "good") pad.append(h("p", { class: "hint" }, `The good policy ${plain(environment.policy)}.`));
    pad.append(h("p", { class: "hint" }, hint(list, waits)));
  }
  function hint(list, waits) {
    if (!list.length) return env.action_space.kind === "Box" ? "Move a slider to act; every other joint rests." : "";
    if (asked.by === "none") return waits ? "Each press is one step." : "Hold the keys, or the buttons.";
    return waits ? "Press a key to take one step yourself." : "Hold a key to take over; let go to hand back.";
  }
  function keyButton(name, meaning) {
    const button = h("button", { type: "button", class: "key", "data-key": name }, h("kbd", {}, SYMBOLS[name] ?? name.replace(/^Key(?=\d)/, "")), meaning && h("span", {}, meaning));
    button.setAttribute("aria-label", `${name} ${meaning}`);
    button.addEventListener("pointerdown", (event) => {
      event.preventDefault();
      button.setPointerCapture(event.pointerId);
      keys.press(name);
    });
    for (const type of ["pointerup", "pointercancel", "lostpointercapture"]) button.addEventListener(type, () => keys.release(name));
    // by keyboard: a press and its release
    button.addEventListener("click", (event) => {
      if (event.detail === 0) {
        keys.press(name);
        setTimeout(() => keys.release(name), 150);
      }
    });
    return button;
  }
  function sliders(space) {
    const rest = space.low.map((low, i) => Math.max(low, Math.min(space.high[i], 0)));
    manual = [...rest];
    const rows = rest.map((value, i) => {
      const input = h("input", { type: "range", min: String(space.low[i]), max: String(space.high[i]), step: "any", "aria-label": `Action ${i}` });
      input.value = String(value);
      const output = h("output", {}, number(value));
      input.addEventListener("input", () => {
        manual[i] = Number(input.value);
        output.textContent = number(manual[i]);
        taken(true);
        set({ held: manual });
      });
      return h("label", { class: "action-slider" }, h("span", {}, `action ${i}`), input, output);
    });
    const letGo = h("button", { type: "button", onclick: () => { showKeys(); taken(false); set({ held: null }); } }, "Let go");
    return h("div", { class: "sliders" }, rows, letGo);
  }
  function taken(byHand) {
    badge.hidden = !byHand || asked.by === "none";
    badge.textContent = "You";
    for (const button of pad.querySelectorAll("[data-key]")) button.classList.toggle("down", keys.isDown(button.dataset.key));
    if (byHand && asked.paused && env.keys?.idle !== "wait") pause(false);
  }

  // the state beside it
  const returnText = h("output", { class: "return" }, "0");
  const facts = h("dl", { class: "facts" });
  const observed = h("div", {});
  const infoList = h("dl", { class: "facts" });
  const infoCard = card("Info", infoList);
  const seedInput = h("input", { inputmode: "numeric", pattern: "[0-9]+", value: asked.seed, "aria-label": "Seed", class: "seed" });
  seedInput.addEventListener("change", () => (/^\d+$/.test(seedInput.value) ? reset(seedInput.value) : report("A seed is a whole number, zero or greater.")));
  const dice = iconButton("dice", "Another seed", () => reset(randomSeed()));
  let view = null;
  function reset(seed) {
    say("");
    seedInput.value = seed;
    engine.handle("reset", { env: env.env, seed }).then(() => pause(false)).catch(report);
  }
  function showState(next) {
    state = next;
    ended = next.terminated || next.truncated;
    returnText.textContent = number(next.return);
    const limit = env.limit ? ` of ${env.limit}` : "";
    const action = next.action === null ? "–" : typeof next.action === "number" ? (actionNames.get(next.action)?.name ?? next.action) : `[${[next.action].flat().map(number).join(", ")}]`;
    facts.replaceChildren(...[["step", `${next.steps}${limit}`], ["reward", number(next.reward)], ["action", action]].flatMap(([name, value]) => [h("dt", {}, name), h("dd", {}, String(value))]));
    const entries = Object.entries(next.info);
    infoCard.hidden = entries.length === 0;
    infoList.replaceChildren(...entries.flatMap(([name, value]) => [h("dt", {}, name), h("dd", {}, infoText(value))]));
    view?.update(next.observation);
    scrubber.max = String(next.known);
    scrubber.value = String(next.steps);
    stepText.textContent = String(next.steps);
    stepBack.disabled = next.steps === 0;
    stepOn.disabled = ended;
    overlay.hidden = !ended;
    if (ended) overlay.replaceChildren(h("strong", {}, next.terminated ? "Terminated" : "Truncated"), ` after ${next.steps} steps, return ${number(next.return)}`);
  }
  const infoText = (value) => (typeof value === "number" ? number(value) : Array.isArray(value) ? value.map(infoText).join(", ") : typeof value === "object" && value !== null ? JSON.stringify(value) : String(value));

  // returns of the episodes
  const chart = h("canvas", { class: "chart", role: "img", "aria-label": "Returns of the episodes" });
  const chartText = h("p", { class: "quiet" }, "The return of each episode that ends appears here.");
  const compare = h("button", { type: "button", onclick: comparePolicies }, environment.policy ? "Play 20 of each policy" : "Play 20 at random");
  function showEpisodes() {
    const kinds = [...new Set(episodes.map(({ by }) => by))];
    plot(chart, kinds.map((by) => ({ values: episodes.filter((episode) => episode.by === by).map((episode) => episode.return), colour: COLOURS[by], dots: true })), { line: env.threshold });
    const mean = (list) => list.reduce((sum, { return: value }) => sum + value, 0) / list.length;
    if (kinds.length) chartText.replaceChildren(...kinds.flatMap((by, i) => {
      const list = episodes.filter((episode) => episode.by === by);
      return [i ? " · " : "", h("span", { class: `swatch who-${by}` }), ` ${POLICIES[by] ?? "Recorded"}: ${number(mean(list))} on average over ${list.length}`];
    }), env.threshold === null ? "" : `. The dashed line: solved at ${number(env.threshold)}.`);
  }
  let comparing = false;
  async function comparePolicies() {
    if (comparing) return void (comparing = false);
    comparing = true;
    const label = compare.textContent;
    compare.textContent = "Stop";
    const other = 1_000_000 + env.env;
    try {
      await engine.request({ do: "make", env: other, id, kwargs: asked.kwargs, fit: 1 });
      for (let seed = 0; seed < 20 && comparing; seed++) {
        for (const by of environment.policy ? ["good", "random"] : ["random"]) {
          let at = await engine.request({ do: "reset", env: other, seed: String(seed) });
          while (!(at.terminated || at.truncated) && comparing) at = await engine.request({ do: "step", env: other, by, action: null, learner: null, count: 20 });
          if (comparing) episodes.push({ by, return: at.return });
        }
        showEpisodes();
      }
    } catch (error) {
      report(error);
    }
    engine.request({ do: "close", env: other }).catch(() => {});
    comparing = false;
    compare.textContent = label;
  }

  // what comes out of it
  const name = id.replaceAll("/", "-");
  const busy = async (button, work) => {
    button.disabled = true;
    try {
      await work();
    } catch (error) {
      report(error);
    }
    button.disabled = false;
  };
  const gifButton = h("button", { type: "button", onclick: () => busy(gifButton, async () => {
    const { attachment } = await engine.request({ do: "gif", env: env.env, frames: GIF_FRAMES });
    download(attachment, "image/gif", `${name}-${seedInput.value}.gif`);
  }) }, "GIF");
  const traceButton = h("button", { type: "button", onclick: () => busy(traceButton, async () => {
    const { attachment } = await engine.request({ do: "trace", env: env.env });
    download(attachment, "application/json", `${name}-${seedInput.value}.json`);
  }) }, "Trace");
  async function address(withActions) {
    const query = new URLSearchParams({ seed: seedInput.value, policy: asked.by });
    if (Object.keys(asked.kwargs).length) query.set("args", JSON.stringify(asked.kwargs));
    if (withActions) query.set("actions", await pack(await engine.request({ do: "actions", env: env.env })));
    return `${link(id)}?${query}`;
  }
  const linkButton = h("button", { type: "button", onclick: async () => copy(new URL(await address(false), location.href).href, linkButton) }, "Link to this seed");
  const episodeButton = h("button", { type: "button", onclick: async () => copy(new URL(await address(true), location.href).href, episodeButton) }, "Link to this very episode");
  const code = h("div", { class: "code" });
  const spaces = h("dl", { class: "spaces" });

  const form = argumentsForm(argumentList, asked.kwargs, (kwargs) => {
    asked.kwargs = kwargs;
    return start();
  });

  let codeSeed = null;
  function showCode(seed) {
    codeSeed = seed;
    code.replaceChildren(...snippets(id, asked.kwargs, seed).map(([language, text]) => {
      const button = h("button", { type: "button", class: "small", onclick: () => copy(text, button) }, "Copy");
      return h("div", {}, h("p", { class: "code-head" }, language, button), h("pre", { tabindex: "0" }, h("code", {}, text)));
    }));
  }

  // Opens the environment with the arguments that are asked for; the one before stays if they are refused.
  async function start() {
    const opened = await engine.open({ id, kwargs: asked.kwargs, seed: seedInput.value, by: asked.by, speed: asked.speed, script: asked.script, paused: asked.paused }, heard);
    if (env) engine.close(env.env);
    env = opened;
    view = observationView(env.observation_space, book ? observationNames(book.text, env.observation_space.shape?.[0]) : []);
    observed.replaceChildren(view.element);
    set({ sight: view.wantsSight === true, idle: env.keys?.idle?.action ?? null, repeats: env.keys?.idle === "repeat" });
    spaces.replaceChildren(...[["observation", env.observation_space], ["action", env.action_space]].flatMap(([name, space]) => [h("dt", {}, name), h("dd", {}, h("code", {}, space.text))]));
    showCode(seedInput.value);
    stage.style.aspectRatio = `${env.size[0]} / ${env.size[1]}`;
    canvas.classList.toggle("pixelated", env.size[0] < 300);
    canvas.classList.toggle("turns", env.turns);
    if (env.turns) canvas.tabIndex = 0;
    turnHint.hidden = !env.turns;
    stage.style.setProperty("--wide", env.size[0] / env.size[1]);
    chooseWho();
    showKeys();
    say("");
    // the first picture came before the page knew what it shows
    await engine.handle("show", { env: env.env });
    history.replaceState(null, "", await addressOnly());
  }
  const addressOnly = async () => {
    if (asked.script) return location.hash;
    return address(false);
  };
  function heard({ state: next, frame, pixels, seed, sight, sightPixels, episode, scriptEnded, error }) {
    if (error) {
      pause(true);
      return report(error);
    }
    if (scriptEnded) {
      asked.script = null;
      pause(true);
      say("What was recorded ends here. Play goes on from it.");
    }
    if (episode) {
      episodes.push({ by: asked.script ? "script" : episode.by, return: episode.return });
      if (episodes.length > 500) episodes.shift();
      showEpisodes();
    }
    if (!frame || !env) return;
    paint(canvas, frame, pixels);
    if (sight) view.see?.(sight, sightPixels);
    if (document.activeElement !== seedInput) seedInput.value = seed;
    if (seed !== codeSeed) showCode(seed);
    showState(next);
  }

  const about = book ? h("details", { class: "card about" }, h("summary", {}, h("h2", {}, "About this task")), markdown(section(book.text.replace(/^/, "\n## All\n").replace(/\n## (?!All)/g, "\n### "), "All").replace(/\n### (Returns|Ids|Spaces|Arguments)\n[\s\S]*?(?=\n### |$)/g, "").replace(/^[\s\S]*?\n# [^\n]+\n/, ""))) : null;
  main.replaceChildren(
    heading,
    h("div", { class: "play" },
      h("div", { class: "play-main" }, stage, turnHint, transport, message, h("div", { class: "who-row" }, who), pad),
      h("div", { class: "play-side" },
        h("section", { class: "card episode" },
          h("div", { class: "episode-head" }, h("div", {}, h("h2", {}, "Return"), returnText), h("div", { class: "seed-row" }, h("label", {}, "Seed ", seedInput), dice)),
          facts),
        card("Observation", observed),
        infoCard,
        card("Episodes", chart, chartText, compare))),
    h("div", { class: "play-more" },
      argumentList.length ? card("Arguments", form) : null,
      card("Share this episode", h("div", { class: "buttons" }, gifButton, traceButton, linkButton, episodeButton), h("p", { class: "quiet" }, "The trace holds every action and answer; ", h("code", {}, "cargo xtask replay"), " compares it bit for bit. A link gives the same bits to whoever opens it.")),
      card("In code", code),
      card("Spaces", spaces),
      about));
  const redraw = new ResizeObserver(() => env && showEpisodes());
  redraw.observe(chart);
  const onKey = (event) => {
    if (event.target.matches?.("input:not([type=range]):not([type=radio]), textarea, select")) return;
    const action = { ",": () => seek(state.steps - 1), ".": () => stepOn.click(), p: () => pause(!asked.paused), r: () => reset(seedInput.value) }[event.key];
    if (!action || event.ctrlKey || event.metaKey || (env.keys?.actions ?? []).some(([key]) => key === event.key.toUpperCase())) return;
    action();
  };
  addEventListener("keydown", onKey);
  pause(asked.paused);
  await start();
  return () => {
    comparing = false;
    removeEventListener("keydown", onKey);
    redraw.disconnect();
    keys?.end();
    if (env) engine.close(env.env);
  };
}

function versionMenu(versions, id) {
  const menu = h("select", { class: "version", "aria-label": "Version" }, versions.map((other) => h("option", { value: other.id, selected: other.id === id }, `v${other.version}`)));
  menu.addEventListener("change", () => (location.hash = link(menu.value)));
  return menu;
}

// For an environment that needs a file of the user's.
function needs(main, engine, environment, heading, refresh) {
  const input = h("input", { type: "file", accept: ".bin,.a26,.rom" });
  const answer = h("p", { role: "status" });
  const take = async (files) => {
    for (const file of files) {
      try {
        const title = await engine.rom(new Uint8Array(await file.arrayBuffer()));
        answer.textContent = `${file.name} is ${title}.`;
        const list = await engine.request({ do: "list" });
        const now = list.find(({ id }) => id === environment.id);
        if (!now.missing) return refresh(list);
        answer.textContent += ` That is another game than this one.`;
        refresh(list, false);
      } catch (error) {
        answer.textContent = `${file.name}: ${error.message}`;
      }
    }
  };
  input.addEventListener("change", () => take(input.files));
  const area = h("label", { class: "drop" }, h("strong", {}, `Drop your ROM of ${environment.name.replace(/^.*\//, "")} here`), h("span", {}, "or choose a file. It is read in this browser and sent nowhere."), input);
  area.addEventListener("dragover", (event) => event.preventDefault());
  area.addEventListener("drop", (event) => {
    event.preventDefault();
    take(event.dataTransfer.files);
  });
  main.replaceChildren(heading, area, answer);
  return () => {};
}
