// Tests of the page in a real browser: `cargo xtask web --test` opens this page and prints the posted results.
import { number } from "/dom.js";
import { Engine, docs } from "/engine.js";
import { hint } from "/hands.js";
import { LESSONS, firstValues } from "/lessons.js";
import { pack, unpack } from "/share.js";
import { robotTests } from "/test/robot.js";

const post = (result) => fetch("/result", { method: "POST", body: JSON.stringify(result) });
const sleep = (ms) => new Promise((done) => setTimeout(done, ms));
const check = (holds, text) => {
  if (!holds) throw new Error(text);
};

let count = 0;
async function test(name, body) {
  count += 1;
  try {
    await post({ name, note: (await body()) ?? "" });
  } catch (error) {
    await post({ name, error: error.stack ?? String(error) });
  }
}

// The page under test, in a frame. An error that the page logs fails the test.
const frame = document.getElementById("page");
const complaints = [];
async function open(hash, ready = "main canvas") {
  frame.src = "about:blank";
  await sleep(50);
  frame.src = `/index.html?${Math.random()}${hash}`;
  await until(() => frame.contentWindow?.location.pathname === "/index.html" && frame.contentDocument?.documentElement?.dataset.ready, `the page ${hash}`, () => {
    const view = frame.contentWindow;
    if (view.location.pathname === "/index.html" && !view.listened) {
      view.listened = true;
      view.addEventListener("error", (event) => complaints.push(event.message));
      view.addEventListener("unhandledrejection", (event) => complaints.push(String(event.reason)));
      view.console.error = (...parts) => complaints.push(parts.map(String).join(" "));
    }
  });
  await until(() => find(ready), `${ready} of ${hash}`);
}
const find = (selector) => frame.contentDocument.querySelector(selector);
const text = (selector) => find(selector)?.textContent ?? "";
async function until(condition, what, always = () => {}) {
  const end = performance.now() + 60_000;
  while (performance.now() < end) {
    always();
    if (condition()) return;
    await sleep(40);
  }
  throw new Error(`waited in vain for ${what}`);
}
function button(label) {
  const found = [...frame.contentDocument.querySelectorAll("button")].find((button) => button.textContent === label || button.getAttribute("aria-label") === label);
  check(found, `there is no button “${label}”`);
  return found;
}
const parameters = new URLSearchParams(location.search);
const colours = (pixels) => new Set(new Uint32Array(pixels.buffer)).size;
const shown = (canvas) => new Uint8Array(canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height).data);

// this test runs first, before the browser and the server have cached anything
await test("the first picture", async () => {
  const start = performance.now();
  await open("#/", ".tile canvas");
  await until(() => colours(shown(find(".tile canvas"))) > 1, "a picture");
  return `${Math.round(performance.now() - start)} ms after the page was opened`;
});

const engine = new Engine();
const environments = await engine.request({ do: "list" });
const has = (id) => environments.some((environment) => environment.id === id);
// Runs a test only if the gallery has the environment `id`; the gallery of a plugin has other environments.
const testOf = (id, name, body) => (has(id) ? test(name, body) : Promise.resolve());
let next = 1000;
// Makes an environment that the worker does not step by itself.
async function make(id, seed = "0", kwargs = {}, fit = null) {
  const env = next++;
  const description = await engine.request({ do: "make", env, id, kwargs, fit });
  const state = await engine.request({ do: "reset", env, seed });
  const step = (by, count = 1, action = null) => engine.request({ do: "step", env, by, action, learner: null, count });
  const ask = (what, more = {}) => engine.request({ do: what, env, ...more });
  return { env, description, state, step, ask };
}

if (parameters.has("single")) {
  await test("the page as one file, opened as a file, shows a picture", async () => {
    check(parameters.get("single") !== "never", "it shows none");
    return `after ${parameters.get("single")} ms`;
  });
}

await test("every environment of the book is in the list", async () => {
  const ids = new Set(environments.map(({ id }) => id));
  // ids that no browser can run: another physics engine
  const others = /^rapier\//;
  const pages = Object.values(await docs());
  if (environments.length < 50 && has("CartPole-v1")) return `(a small module: ${ids.size} ids)`;
  for (const page of pages) {
    const table = page.split("\n## Ids\n")[1]?.split("\n## ")[0] ?? "";
    for (const [, id] of table.matchAll(/^\| `([^`]+)`/gm)) check(others.test(id) || ids.has(id), `${id} is missing`);
  }
  return `${ids.size} ids`;
});

await test("the page asks for nothing but ROMs", async () => {
  const needs = new Set(environments.map(({ missing }) => missing).filter(Boolean));
  check([...needs].every((what) => what === "ROMs"), `environments need ${[...needs]}`);
});

for (const { id, missing } of environments) {
  if (missing) continue;
  await test(`${id} shows a picture that changes`, async () => {
    const env = await make(id, "0", {}, 200);
    const first = (await env.ask("frame")).attachment;
    check(colours(first) > 1, "the first picture is blank");
    let changed = false;
    for (let i = 0; i < 60 && !changed; i++) {
      const state = await env.step("random", 4);
      const { attachment } = await env.ask("frame");
      changed = attachment.some((byte, at) => byte !== first[at]);
      if (state.terminated || state.truncated) await env.ask("reset", { seed: String(i + 1) });
    }
    check(changed, "nothing moves");
    await env.ask("close");
  });
}

await test("a step back leads to the same bits again", async () => {
  for (const id of ["CartPole-v1", "LunarLander-v3", "Humanoid-v5", "CarRacing-v3", "Taxi-v4"].filter(has)) {
    const env = await make(id, "5", {}, 100);
    const states = [];
    for (let i = 0; i < 40; i++) {
      const state = await env.step("random");
      states.push(JSON.stringify({ ...state, known: 0 }));
      if (state.terminated || state.truncated) break;
    }
    for (const step of [states.length, 3, 17, 1, 20]) {
      if (step > states.length) continue;
      const state = await env.ask("seek", { step });
      check(JSON.stringify({ ...state, known: 0 }) === states[step - 1], `${id}: step ${step} differs`);
    }
    await env.ask("close");
  }
});

await test("the gallery shows tiles that move", async () => {
  await open("#/", ".tile canvas");
  const tile = () => shown(find(".tile canvas"));
  await until(() => colours(tile()) > 1, "the first tile");
  const before = tile();
  await until(() => tile().some((byte, at) => byte !== before[at]), "a movement");
});

await test("families come in their order, and a card has the environments of a page", async () => {
  const all = (selector, within = frame.contentDocument) => [...within.querySelectorAll(selector)];
  const headings = all(".family h2").map((heading) => heading.textContent);
  const expected = [...new Set(environments.map(({ family }) => family))];
  check(headings.join() === expected.join(), `${headings} for ${expected}`);
  const there = environments.filter(({ missing }) => !missing);
  const cards = new Set(there.map(({ family, card }) => `${family} ${card}`));
  // (a card of old names may be folded)
  const tiles = all(".tile");
  check(tiles.length <= cards.size && tiles.length > 0, `${tiles.length} tiles for ${cards.size} cards`);
  const shown = tiles.flatMap((tile) => {
    const choices = all("option", tile).map((option) => option.value);
    return choices.length ? choices : [decodeURIComponent(tile.querySelector("a").hash.slice(2))];
  });
  const lost = there.filter(({ id, family }) => !shown.includes(id) && family !== "Atari");
  check(lost.length === 0, `${lost.map(({ id }) => id)} on no tile`);
  return `${there.length} environments on ${tiles.length} tiles`;
});

await testOf("CartPole-v1", "a choice shows another environment of a card", async () => {
  const tile = [...frame.contentDocument.querySelectorAll(".tile")].find((tile) => tile.querySelector("option[value='CartPole-v1']"));
  const menu = tile.querySelector("select");
  check(menu.value === "CartPole-v1", `${menu.value} is shown first`);
  menu.value = "CartPole-v0";
  menu.dispatchEvent(new Event("change"));
  check(tile.querySelector("a").hash === "#/CartPole-v0", tile.querySelector("a").hash);
  const before = shown(tile.querySelector("canvas"));
  await until(() => shown(tile.querySelector("canvas")).some((byte, at) => byte !== before[at]), "a picture of the other");
});

await testOf("FrozenLake-v1", "the search finds by name", async () => {
  const search = find("input[type=search]");
  search.value = "lake";
  search.dispatchEvent(new Event("input"));
  const seen = [...frame.contentDocument.querySelectorAll(".tile")].filter((tile) => tile.offsetParent).map((tile) => tile.querySelector("h3").textContent);
  check(seen.length >= 1 && seen.every((name) => /lake/i.test(name)), `found ${seen}`);
});

await testOf("CartPole-v1", "keys move the cart", async () => {
  await open("#/CartPole-v1?seed=3&policy=none", ".key[data-key]");
  const position = () => Number(text(".bar-value").replace("−", "-"));
  await until(() => Number.isFinite(position()) && text(".bar-value") !== "", "an observation");
  const press = (type, code) => frame.contentWindow.dispatchEvent(new KeyboardEvent(type, { code, key: code, bubbles: true, cancelable: true }));
  const action = () => [...frame.contentDocument.querySelectorAll(".episode dd")].at(-1)?.textContent;
  for (const [code, name] of [["ArrowLeft", "Left"], ["ArrowRight", "Right"]]) {
    press("keydown", code);
    await until(() => action() === name, `the action ${name}`);
    press("keyup", code);
  }
});

await testOf("LunarLander-v3", "the good policy lands the lander", async () => {
  const env = await make("LunarLander-v3", "1", {}, 100);
  let state = env.state;
  while (!(state.terminated || state.truncated)) state = await env.step("good", 50);
  check(state.return > 200, `return ${state.return}`);
  return `return ${state.return.toFixed(1)}`;
});

await test("every good policy plays an episode", async () => {
  const good = environments.filter(({ policy, missing }) => policy && !missing);
  for (const { id } of good) {
    const env = await make(id, "0", {}, 50);
    let state = env.state;
    for (let i = 0; i < 30 && !(state.terminated || state.truncated); i++) state = await env.step("good", 10);
    check(state.steps > 0, `${id} took no step`);
    await env.ask("close");
  }
  return `${good.length} of them`;
});

await testOf("CartPole-v1", "a GIF decodes to the pictures of the episode", async () => {
  const env = await make("CartPole-v1", "2");
  const { steps } = await env.step("random", 50);
  const { attachment } = await env.ask("gif", { frames: 600 });
  const { attachment: last } = await env.ask("frame");
  const decoder = new ImageDecoder({ data: attachment, type: "image/gif" });
  await decoder.tracks.ready;
  await decoder.completed;
  const frames = decoder.tracks.selectedTrack.frameCount;
  // (a picture without changes extends the duration of the picture before)
  check(frames <= steps + 1 && frames > steps / 2, `${frames} frames for ${steps} steps`);
  const { image } = await decoder.decode({ frameIndex: frames - 1 });
  const canvas = new OffscreenCanvas(image.displayWidth, image.displayHeight);
  canvas.getContext("2d").drawImage(image, 0, 0);
  const pixels = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height).data;
  check(pixels.every((byte, at) => byte === last[at]), "the last picture of the GIF differs from the one that is shown");
  return `${frames} frames, ${attachment.length} bytes`;
});

await testOf("MountainCar-v0", "a link brings back an episode", async () => {
  const env = await make("MountainCar-v0", "11", { goal_velocity: 0.01 });
  const state = await env.step("random", 150);
  const actions = await env.ask("actions");
  const packed = await pack(actions);
  check(JSON.stringify(await unpack(packed)) === JSON.stringify(actions), "the actions differ");
  const args = encodeURIComponent(JSON.stringify({ goal_velocity: 0.01 }));
  await open(`#/MountainCar-v0?seed=11&policy=random&speed=16&args=${args}&actions=${packed}`, ".return");
  await until(() => /recorded ends here/.test(text(".message")), "the end of what was recorded");
  await sleep(300);
  const seen = [...frame.contentDocument.querySelectorAll(".bar-value")].map((value) => Number(value.textContent.replace("−", "-")));
  check(find("#argument-goal_velocity").value === "0.01", "the form does not show the argument");
  check(Number.parseInt(text(".facts dd")) === state.steps, `step ${text(".facts dd")} for ${state.steps}`);
  check(Math.abs(seen[0] - state.observation[0]) < 1e-3, `position ${seen[0]} for ${state.observation[0]}`);
});

await testOf("Hopper-v5", "a link brings back an episode of a robot, to the last digit shown", async () => {
  const env = await make("Hopper-v5", "4");
  const state = await env.step("random", 12);
  const packed = await pack(await env.ask("actions"));
  await open(`#/Hopper-v5?seed=4&policy=random&speed=16&actions=${packed}`, ".return");
  await until(() => Number.parseInt(text(".facts dd")) === state.steps && /recorded ends here/.test(text(".message")), "the end of what was recorded");
  const seen = [...frame.contentDocument.querySelectorAll(".bar-value")].map((value) => value.textContent);
  check(seen.length === 11 && seen.every((value, i) => value === number(state.observation[i])), `${seen} for ${state.observation}`);
  check(text(".return") === number(state.return), `${text(".return")} for ${state.return}`);
});

await testOf("MountainCar-v0", "arguments that are refused are told in words", async () => {
  await open("#/MountainCar-v0", ".arguments");
  const input = find("#argument-goal_velocity");
  input.value = "";
  find(".arguments").requestSubmit();
  await until(() => /number is missing/.test(text(".arguments [role=status]")), "the error");
  const error = await engine.request({ do: "make", env: 1, id: "CartPole-v1", kwargs: { gravitty: 1 }, fit: null }).catch((error) => error.message);
  check(/gravitty/.test(error), error);
});

await testOf("CartPole-v1", "code in the documentation of an argument is shown as code", async () => {
  await open("#/CartPole-v1", ".arguments");
  check(!text(".arguments").includes("`"), "a backtick is shown");
  check(find(".arguments .argument code"), "no code is shown");
});

await test("an environment's page shows its picture while it waits for a key", async () => {
  const { id } = environments.find(({ missing }) => !missing);
  await open(`#/${id}?policy=none`, ".stage canvas");
  await until(() => colours(shown(find(".stage canvas"))) > 1, "a picture");
});

await testOf("CartPole-v1", "pause, steps forth and back", async () => {
  await open("#/CartPole-v1?seed=0&policy=random", ".transport");
  const step = () => Number(text(".steps"));
  await until(() => step() > 2, "a step");
  button("Pause").click();
  await sleep(400);
  const at = step();
  await sleep(300);
  check(step() === at, "it goes on while it is paused");
  button("One step back").click();
  await until(() => step() === at - 1, "a step back");
  if (find(".transport button[aria-label='One step']").disabled) return;
  button("One step").click();
  await until(() => step() === at, "a step");
});

await test("every part fits a narrow screen, light and dark", async () => {
  frame.width = 360;
  const ids = ["CartPole-v1", "Humanoid-v5", "ALE/Pong-v5"].filter(has);
  const parts = ["#/", ...(ids.length ? ids : [environments[0].id]).map((id) => `#/${id}`), ...(has("FrozenLake-v1") ? ["#/learn/FrozenLake-v1"] : [])];
  for (const hash of parts) {
    await open(hash, "main h1");
    await sleep(300);
    const { clientWidth, scrollWidth } = frame.contentDocument.documentElement;
    check(scrollWidth <= clientWidth, `${hash} is ${scrollWidth} pixels wide, of ${clientWidth}`);
  }
  const ground = () => frame.contentWindow.getComputedStyle(frame.contentDocument.body).backgroundColor;
  const before = ground();
  button("Light or dark").click();
  check(ground() !== before, `the ground stays ${before}`);
  button("Light or dark").click();
  check(ground() === before, `the ground was ${before} and is ${ground()}`);
  frame.width = 1200;
});

await testOf("FrozenLake-v1", "Q-learning learns FrozenLake, and its values are drawn", async () => {
  await open("#/learn/FrozenLake-v1", ".lesson .primary");
  const pace = find("select[aria-label=Pace]");
  pace.value = "Infinity";
  pace.dispatchEvent(new Event("change"));
  button("Learn").click();
  const output = (i) => Number(frame.contentDocument.querySelectorAll(".numbers output")[i].textContent);
  await until(() => output(1) > 0.8, "a mean return above 0.8");
  check(colours(shown(find(".values"))) > 10, "no values are drawn");
  button("Pause").click();
  return `${output(0)} episodes`;
});

await testOf("CartPole-v1", "the cross-entropy method balances the pole", async () => {
  await open("#/learn/CartPole-v1", ".lesson .primary");
  const pace = find("select[aria-label=Pace]");
  pace.value = "Infinity";
  pace.dispatchEvent(new Event("change"));
  button("Learn").click();
  const output = (i) => Number(frame.contentDocument.querySelectorAll(".numbers output")[i].textContent);
  await until(() => output(1) > 300, "a mean return above 300");
  button("Pause").click();
  return `${output(2)} generations`;
});

await test("recorded traces replay equal", async () => {
  const response = await fetch("/traces/");
  if (!response.ok) return "(none were given)";
  const names = await response.json();
  let [replayed, events, other] = [0, 0, 0];
  const families = new Map();
  for (const name of names) {
    const bytes = new Uint8Array(await (await fetch(`/traces/${encodeURIComponent(name)}`)).arrayBuffer());
    const parsed = JSON.parse(new TextDecoder().decode(bytes));
    const environment = environments.find(({ id }) => id === parsed.id);
    if (!Array.isArray(parsed.events) || !environment || environment.missing) {
      other += 1;
      continue;
    }
    const answer = await engine.request({ do: "replay" }, bytes);
    check(answer.difference === null, `${name}: ${answer.difference}`);
    replayed += 1;
    families.set(environment.family, (families.get(environment.family) ?? 0) + 1);
    events += answer.events;
    if (replayed % 25 === 0) await post({ name: "…", note: `${replayed} traces so far` });
  }
  check(replayed > 0, "no trace is of an environment here");
  return `${replayed} equal (${[...families].map(([name, n]) => `${name} ${n}`).join(", ")}), ${events} events; ${other} of another form or for what is not here`;
});

await test("speed", async () => {
  const rows = [];
  for (const id of ["CartPole-v1", "LunarLander-v3", "CarRacing-v3", "Humanoid-v5"].filter(has)) {
    const env = await make(id);
    let steps = 0;
    const start = performance.now();
    while (performance.now() - start < 1500) {
      const state = await env.step("random");
      await env.ask("frame");
      steps += 1;
      if (state.terminated || state.truncated) await env.ask("reset", { seed: String(steps) });
    }
    rows.push(`${id} ${Math.round(steps / ((performance.now() - start) / 1000))} of ${env.description.fps}`);
    await env.ask("close");
  }
  return `steps with pictures a second: ${rows.join(", ")}`;
});

// The mean return of the last episodes from which a lesson counts as learned, and the largest number of episodes until
// then.
const LEARNED = {
  "FrozenLake-v1": { last: 100, mean: 0.8, most: 20_000 },
  "CliffWalking-v1": { last: 100, mean: -70, most: 20_000 },
  "Taxi-v4": { last: 100, mean: 4, most: 20_000 },
  "CartPole-v1": { last: 40, mean: 400, most: 2400 },
};

for (const lesson of LESSONS) {
  await testOf(lesson.id, `the lesson ${lesson.title} learns with each of 200 seeds`, async () => {
    const { last, mean, most } = LEARNED[lesson.id];
    let longest = 0;
    for (let seed = 0; seed < 200; seed++) {
      const learner = 50;
      await engine.request({ do: "learn", learner, id: lesson.id, kwargs: lesson.kwargs, seed, lesson: { method: lesson.method, ...firstValues(lesson) } });
      const returns = [];
      const now = () => returns.slice(-last).reduce((sum, x) => sum + x, 0) / last;
      while (returns.length < last || now() < mean) {
        check(returns.length < most, `seed ${seed}: the mean return is ${now()} after ${returns.length} episodes`);
        const ended = await engine.request({ do: "train", learner, episodes: last, steps: 100_000 });
        returns.push(...ended.map((episode) => episode.return));
      }
      longest = Math.max(longest, returns.length);
    }
    return `within ${longest} episodes`;
  });
}

await testOf("CartPole-v1", "addresses that cannot be are told in words", async () => {
  const isTold = async (hash, place, words) => {
    const before = complaints.length;
    await open(hash, place);
    await until(() => words.test(text(place)), `${words} for ${hash}, in place of “${text(place)}”`);
    complaints.splice(before);
  };
  await isTold("#/%E0%A4%A", ".failure", /damaged escape/);
  await isTold("#/learn/Nope", ".failure", /no lesson “Nope”.*CartPole-v1/);
  await isTold("#/Nope-v1", ".failure", /no environment “Nope-v1”/);
  await isTold("#/CartPole-v1?policy=evil", ".message.error", /no policy “evil” here: choose good, random, none/);
  await isTold("#/CartPole-v1?args=%7Boops", ".message.error", /arguments in this link are damaged/);
  await isTold("#/CartPole-v1?seed=-1", ".message.error", /“-1” is not a seed/);
  await isTold("#/CartPole-v1?speed=fast", ".message.error", /“fast” is not a speed/);
  // the page plays as if the address had no parameters
  await until(() => Number(text(".steps")) > 0, "a step");
});

await test("each number of an observation and of an action has its name", async () => {
  const labels = (selector) => [...frame.contentDocument.querySelectorAll(selector)].map((label) => label.textContent);
  for (const [id, first, action] of [
    ["HalfCheetah-v5", "position of torso along z (m)", "torque of bthigh (120 N m)"],
    ["dm_control/cheetah-run-v0", "position of torso along z (m)", "torque of bthigh (120 N m)"],
    ["LunarLander-v3", "x from the middle of the pad (10 m)"],
    ["Pendulum-v1", "cosine of the angle"],
    ["Humanoid-v5", "position of torso along z (m)", "torque of abdomen_y (100 N m)"],
  ].filter(([id]) => has(id))) {
    await open(`#/${id}?policy=none`, ".bar-name");
    const names = labels(".play-side .bar-name");
    check(names[0] === first, `${id}: the first number is called “${names[0]}”`);
    const nameless = [...names, ...labels(".action-slider span")].find((name) => /^(number|action) \d/.test(name));
    check(!nameless, `${id}: “${nameless}” is no name`);
    if (action) check(labels(".action-slider span")[0] === action, `${id}: a slider is called “${labels(".action-slider span")[0]}”`);
  }
  if (has("dm_control/cheetah-run-v0")) {
    await open("#/dm_control/cheetah-run-v0?policy=none", ".bar-name");
    check(labels(".parts h3").join() === "position,velocity", `the parts are ${labels(".parts h3")}`);
  }
});

await test("labels of observations are shown whole", async () => {
  for (const id of ["Humanoid-v5", "dm_control/cheetah-run-v0", "BipedalWalker-v3", "LunarLander-v3", "CartPole-v1"].filter(has)) {
    for (const width of [360, 1200]) {
      frame.width = width;
      await open(`#/${id}`, ".bar-name");
      const labels = [...frame.contentDocument.querySelectorAll(".play-side .bar-name")];
      const cut = labels.find((label) => label.scrollWidth > label.clientWidth + 1 || label.scrollHeight > label.clientHeight + 1);
      check(!cut, `${id}, ${width} pixels wide: “${cut?.textContent}” is cut`);
      check(new Set(labels.map((label) => label.textContent)).size === labels.length, `${id}: two labels are equal`);
    }
  }
  frame.width = 1200;
});

await test("on a phone the button to learn is in sight, and no text speaks of a keyboard", async () => {
  const [width, height] = [frame.width, frame.height];
  [frame.width, frame.height] = [360, 640];
  for (const { id } of LESSONS.filter(({ id }) => has(id))) {
    await open(`#/learn/${id}`, ".lesson .primary");
    await sleep(300);
    const { bottom } = find(".lesson .primary").getBoundingClientRect();
    check(bottom < 640, `${id}: the button ends at ${bottom} of 640`);
  }
  [frame.width, frame.height] = [width, height];
  for (const bits of Array(16).keys()) {
    const [hasKeys, isBox, isYou, waits] = [1, 2, 4, 8].map((bit) => (bits & bit) !== 0);
    check(!/key|press/i.test(hint({ hasKeys, isBox, isYou, waits }, true)), `the hint ${bits} speaks of keys`);
  }
});

await test("the start page says what Gymnasium is", async () => {
  await open("#/", ".hero");
  check(/Gymnasium is .* interface between agents .* and the tasks/.test(text(".hero")), text(".hero"));
  check(/written in Rust/.test(text(".hero")), text(".hero"));
});

if (await engine.request({ do: "robot", ask: { do: "forget" } }).then(() => true, () => false)) {
  // The frames that the module draws in a second of a model, between the timesteps that fall into them.
  const rate = async (model) => {
    const ask = (request, bytes) => engine.request({ do: "robot", ask: request }, bytes);
    await ask({ do: "file", path: "model.xml" }, new TextEncoder().encode(model));
    await ask({ do: "open", main: "model.xml" });
    const start = performance.now();
    let [frames, before] = [0, start];
    while (performance.now() - start < 4000) {
      const now = performance.now();
      await engine.handle("robot", { seconds: (now - before) / 1000, budget: 24, size: [640, 480], fine: false });
      before = now;
      frames += 1;
    }
    return frames / ((performance.now() - start) / 1000);
  };
  await robotTests({ test, open, find, text, until, button, check, colours, shown, sleep, frame, complaints, rate });
}

await test("the page complained about nothing", async () => check(complaints.length === 0, complaints.join("; ")));

await test("no request left for another host", async () => {
  const urls = [...performance.getEntriesByType("resource"), ...(frame.contentWindow.performance.getEntriesByType("resource"))].map(({ name }) => name);
  const others = urls.filter((url) => !url.startsWith(location.origin) && !/^(blob|data):/.test(url));
  check(others.length === 0, others.join(", "));
  return `${urls.length} of this one`;
});

await post({ done: count });
