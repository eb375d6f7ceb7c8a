// Runs the environments in a worker: answers requests, and steps the environments that play. The script is a classic
// script without imports, so that a page that was opened as a file can start it from a Blob.
"use strict";

let gym = null;
const text = new TextDecoder();
const bytesOf = new TextEncoder();

// Starts an instance of the module.
function start(module) {
  const { exports } = new WebAssembly.Instance(module, {});
  exports.__wasm_call_ctors();
  exports.start();
  // a call may move the memory, so each view is used only until the next call
  const view = (at, length) => new Uint8Array(exports.memory.buffer, at, length);
  return {
    call(request, bytes) {
      const json = bytesOf.encode(JSON.stringify(request));
      const length = json.length + (bytes ? bytes.length : 0);
      const at = exports.input(length);
      view(at, length).set(json);
      if (bytes) view(at + json.length, bytes.length).set(bytes);
      let answered;
      try {
        answered = exports.call(json.length);
      } catch (trap) {
        const what = text.decode(view(exports.panic_text(), exports.panic_length()));
        throw new Error(`the module stopped: ${what || trap}`, { cause: "trap" });
      }
      const answer = JSON.parse(text.decode(view(exports.output(), answered)));
      if ("error" in answer) throw new Error(answer.error);
      const attached = exports.attachment_length();
      const attachment = attached ? view(exports.attachment(), attached).slice() : null;
      return { answer: answer.ok, attachment };
    },
  };
}

const call = (request, bytes) => gym.call(request, bytes).answer;

// Environments that play by themselves, by number.
//   by: "good", "random", "learner", "none"    idle: null (wait) or an action    held: the action of the keys that are down
//   repeats: whether the last held action is repeated    script: actions to take first
const loops = new Map();
const END = 900; // how long the end of an episode is shown, in milliseconds
let timer = null;

function schedule() {
  if (timer !== null) return;
  let due = Infinity;
  for (const loop of loops.values()) if (!loop.paused && !loop.waiting) due = Math.min(due, loop.due);
  if (due === Infinity) return;
  timer = setTimeout(tick, Math.max(0, due - performance.now()));
}

function tick() {
  timer = null;
  const now = performance.now();
  for (const loop of loops.values()) {
    if (loop.paused || loop.waiting || loop.due > now) continue;
    try {
      advance(loop, now);
    } catch (error) {
      loop.paused = true;
      postMessage({ loop: loop.env, error: error.message, trap: error.cause === "trap" });
    }
  }
  schedule();
}

// Takes the steps that are due, and shows the last state.
function advance(loop, now) {
  const period = 1000 / (loop.fps * loop.speed);
  if (loop.done) {
    if (loop.resets) reset(loop, loop.nextSeed);
    else {
      loop.paused = true;
      return;
    }
  } else {
    const steps = Math.min(Math.floor((now - loop.due) / period) + 1, Math.max(1, Math.ceil(loop.speed * 4)));
    // without a step, for instance because no key is pressed, the missed steps are dropped
    if (!take(loop, steps, now)) {
      if (loop.paused) show(loop, now);
      loop.due = now + 30;
      return;
    }
  }
  loop.due = Math.max(loop.due + period, now - period);
  if (loop.done) loop.due = now + END;
  // show at most one picture per `interval`
  if (loop.done || loop.paused || now - loop.shown >= loop.interval) show(loop, now);
}

// Takes up to `steps` steps. Returns whether it took any.
function take(loop, steps, now) {
  const until = now + 12;
  let taken = false;
  while (steps > 0 && !loop.done) {
    const at = loop.state ? loop.state.steps : 0;
    let by = loop.by;
    let action = null;
    let count = steps;
    if (loop.script && at >= loop.script.length) {
      // the recorded actions end here; the page decides whether the episode continues
      loop.script = null;
      loop.paused = true;
      postMessage({ loop: loop.env, scriptEnded: true });
      return taken;
    }
    if (loop.held !== null) [by, action, count] = ["action", loop.held, 1];
    else if (loop.script && at < loop.script.length) [by, action, count] = ["action", loop.script[at], 1];
    else if (by === "none") {
      action = loop.repeats ? loop.lastHeld : loop.idle;
      if (action === null) return taken;
      [by, count] = ["action", 1];
    }
    if (by !== "action") count = Math.min(count, 64);
    loop.state = call({ do: "step", env: loop.env, by, action, learner: loop.learner, count });
    loop.done = loop.state.terminated || loop.state.truncated;
    taken = true;
    steps -= count;
    if (performance.now() > until) break;
  }
  if (loop.done && !loop.told) {
    loop.told = true;
    postMessage({ loop: loop.env, episode: { return: loop.state.return, length: loop.state.steps, seed: loop.seed, by: loop.by } });
  }
  return taken;
}

function reset(loop, seed) {
  loop.state = call({ do: "reset", env: loop.env, seed });
  Object.assign(loop, { seed, done: false, told: false, lastHeld: null, nextSeed: String(BigInt(seed) + 1n) });
}

// Sends the picture and the state. The next picture waits until the page has shown this picture.
function show(loop, now = performance.now()) {
  const { answer, attachment } = gym.call({ do: "frame", env: loop.env });
  const message = { loop: loop.env, state: loop.state, seed: loop.seed, frame: answer, pixels: attachment };
  const transfer = [attachment.buffer];
  if (loop.sight) {
    const seen = gym.call({ do: "sight", env: loop.env });
    if (seen.answer) {
      message.sight = seen.answer;
      message.sightPixels = seen.attachment;
      transfer.push(seen.attachment.buffer);
    }
  }
  loop.shown = now;
  loop.waiting = true;
  postMessage(message, transfer);
}

// The time of a timestep of the reader's robot, in milliseconds, as last measured.
let perStep = 1;

const handlers = {
  // Opens an environment, resets it and shows it. The environment plays unless it is paused.
  open({ env, id, kwargs, fit = null, seed, ...options }) {
    const description = call({ do: "make", env, id, kwargs, fit });
    const loop = {
      env, fps: Math.max(1, description.fps), speed: 1, by: "random", learner: null, idle: null, repeats: false, held: null,
      lastHeld: null, script: null, paused: false, resets: true, sight: false, interval: 15, shown: 0, waiting: false,
      ...options,
    };
    reset(loop, seed);
    loops.set(env, loop);
    loop.due = performance.now() + 1000 / loop.fps;
    show(loop);
    return description;
  },
  // Changes the options of an environment that plays.
  set({ env, ...options }) {
    const loop = loops.get(env);
    if (!loop) return null;
    if ("held" in options && options.held !== null) loop.lastHeld = options.held;
    const paused = loop.paused;
    Object.assign(loop, options);
    if (paused && !loop.paused) loop.due = performance.now();
    return null;
  },
  // Shows the state again.
  show({ env }) {
    show(loops.get(env));
    return null;
  },
  // The page has shown the last picture, so the next picture may be sent.
  shown({ env }) {
    const loop = loops.get(env);
    if (loop) loop.waiting = false;
    return null;
  },
  close({ env }) {
    loops.delete(env);
    return call({ do: "close", env });
  },
  reset({ env, seed }) {
    const loop = loops.get(env);
    reset(loop, seed);
    loop.due = performance.now() + 1000 / loop.fps;
    show(loop);
    return null;
  },
  // Takes one step, with `action` or with the action of the current player.
  step({ env, action = null }) {
    const loop = loops.get(env);
    if (loop.done) return null;
    const held = loop.held;
    if (action !== null) loop.held = action;
    try {
      take(loop, 1, performance.now());
    } finally {
      loop.held = held;
    }
    loop.due = performance.now() + (loop.done ? END : 1000 / (loop.fps * loop.speed));
    show(loop);
    return null;
  },
  // Advances the reader's robot by `seconds`, or as far as it comes in about `budget` milliseconds, and draws it.
  robot({ seconds, budget, size, fine }) {
    const start = performance.now();
    const taken = call({ do: "robot", ask: { do: "advance", seconds, most: Math.max(1, Math.floor(budget / perStep)) } });
    const stepped = performance.now();
    if (taken > 0) perStep += 0.2 * ((stepped - start) / taken - perStep);
    const { answer, attachment } = gym.call({ do: "robot", ask: { do: "frame", size, fine } });
    return { answer: { ...answer, taken, drawing: performance.now() - stepped }, attachment };
  },
  turn({ env, by }) {
    const loop = loops.get(env);
    call({ do: "turn", env, by });
    if (!loop.waiting) show(loop);
    return null;
  },
  seek({ env, step }) {
    const loop = loops.get(env);
    loop.state = call({ do: "seek", env, step });
    loop.done = loop.told = loop.state.terminated || loop.state.truncated;
    show(loop);
    return null;
  },
};

onmessage = ({ data }) => {
  if (data.module) {
    gym = start(data.module);
    postMessage({ id: data.id, answer: null });
    return;
  }
  const { id, handler, request, bytes } = data;
  try {
    const result = handler ? handlers[handler](request) : gym.call(request, bytes);
    const { answer, attachment } = result?.attachment === undefined ? { answer: result, attachment: null } : result;
    postMessage({ id, answer, attachment }, attachment ? [attachment.buffer] : []);
  } catch (error) {
    postMessage({ id, error: error.message, trap: error.cause === "trap" });
  }
  schedule();
};
