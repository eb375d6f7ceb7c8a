// The reader's hands on a robot: mouse, touch and keyboard.

// Listens until the returned function is called. `controls` are those of the page.
export function hands(view, controls) {
  const listener = new AbortController();
  const send = gather(view);
  byPointers(view, send);
  byKeys(view, controls, send, listener.signal);
  return () => listener.abort();
}

// Returns a function that sends movements of the camera, summed, one request at a time.
function gather(view) {
  const sums = { turn: [0, 0], move: [0, 0], zoom: 0 };
  let busy = false;
  async function flush() {
    busy = true;
    for (;;) {
      const due = Object.entries(sums).filter(([, by]) => (Array.isArray(by) ? by.some((x) => x !== 0) : by !== 0));
      if (due.length === 0 || view.ended) break;
      Object.assign(sums, { turn: [0, 0], move: [0, 0], zoom: 0 });
      for (const [what, by] of due) await view.ask({ do: what, by });
    }
    busy = false;
  }
  return (what, by) => {
    sums[what] = Array.isArray(by) ? sums[what].map((x, i) => x + by[i]) : sums[what] + by;
    if (!busy) flush();
  };
}

const middle = (a, b) => [(a.clientX + b.clientX) / 2, (a.clientY + b.clientY) / 2];
// how far a click may move, in pixels, and how long it shows a name, in milliseconds
const [CLICK, SHOWN] = [4, 1500];
const distance = (a, b) => Math.hypot(a.clientX - b.clientX, a.clientY - b.clientY) || 1;

// A pointer turns the camera, or pulls a body; with the right button it moves the camera. Two pointers move the camera and
// change its distance. A click shows the name of a body.
function byPointers(view, send) {
  const { canvas, ask } = view;
  const pointers = new Map();
  let pulling = null;
  let pressed = null;
  const release = () => {
    if (pulling === null) return;
    pulling = null;
    view.hold(null);
    ask({ do: "release" });
  };
  // a point of the picture that the module draws now
  const place = (event) => {
    const box = canvas.getBoundingClientRect();
    const size = view.size;
    return { at: [((event.clientX - box.left) / box.width) * size[0], ((event.clientY - box.top) / box.height) * size[1]], size };
  };
  canvas.addEventListener("contextmenu", (event) => event.preventDefault());
  canvas.addEventListener("pointerdown", async (event) => {
    canvas.setPointerCapture(event.pointerId);
    pointers.set(event.pointerId, event);
    pressed = pointers.size === 1 ? event : null;
    if (pointers.size > 1) return release();
    if (!(view.pulls || event.ctrlKey || event.metaKey)) return;
    const own = (pulling = { id: event.pointerId, sent: true, due: null });
    const hit = await ask({ do: "select", ...place(event) });
    own.sent = false;
    if (pulling !== own) return ask({ do: "release" });
    if (!hit?.moves) pulling = null;
    if (pulling) view.hold(hit.body);
    else name(hit);
  });
  function name(hit) {
    view.hold(hit?.body ?? null);
    setTimeout(() => pulling ?? view.hold(null), SHOWN);
  }
  async function pull(own, to) {
    own.due = to;
    if (own.sent) return;
    own.sent = true;
    while (own.due && pulling === own) {
      const next = own.due;
      own.due = null;
      await ask({ do: "pull", ...next });
    }
    own.sent = false;
  }
  canvas.addEventListener("pointermove", (event) => {
    const before = pointers.get(event.pointerId);
    if (!before) return;
    pointers.set(event.pointerId, event);
    const heights = (x) => x / (canvas.clientHeight || 1);
    const other = [...pointers.values()].find((other) => other.pointerId !== event.pointerId);
    if (other) {
      const [from, to] = [middle(other, before), middle(other, event)];
      send("move", [heights(to[0] - from[0]), heights(to[1] - from[1])]);
      send("zoom", 0.4 * Math.log(distance(other, before) / distance(other, event)));
      return;
    }
    if (pulling?.id === event.pointerId) return void pull(pulling, place(event));
    const by = [heights(event.clientX - before.clientX), heights(event.clientY - before.clientY)];
    send(event.buttons & 2 || event.shiftKey ? "move" : "turn", by);
  });
  for (const type of ["pointerup", "pointercancel"]) canvas.addEventListener(type, (event) => {
    pointers.delete(event.pointerId);
    if (pulling?.id === event.pointerId) return release();
    const isClick = type === "pointerup" && event.pointerId === pressed?.pointerId && distance(event, pressed) <= CLICK && event.button === 0;
    pressed = null;
    if (isClick && !view.pulls) ask({ do: "select", ...place(event) }).then((hit) => ask({ do: "release" }).then(() => name(hit)));
  });
  canvas.addEventListener("wheel", (event) => {
    event.preventDefault();
    send("zoom", Math.max(-0.3, Math.min(0.3, event.deltaY * 0.0005)));
  }, { passive: false });
}

function byKeys(view, controls, send, signal) {
  const arrows = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
  const keys = {
    " ": () => controls.pause(!view.paused), ".": controls.step, r: controls.reset, k: controls.nextKeyframe, v: controls.nextCamera,
    c: controls.contacts, p: controls.pulling, f: () => view.ask({ do: "follow" }), "[": () => controls.faster(-1), "]": () => controls.faster(1), 0: () => controls.sliders.restart(),
    "+": () => send("zoom", -0.05), "=": () => send("zoom", -0.05), "-": () => send("zoom", 0.05), "?": view.toggleHelp,
  };
  addEventListener("keydown", (event) => {
    const { target, key } = event;
    // (some keyboards have brackets behind AltGr)
    if ((event.ctrlKey || event.metaKey || event.altKey) && !event.getModifierState("AltGraph") || target.matches?.("input:not([type=range]), textarea, select")) return;
    // a button takes the space bar, and a slider the arrows
    if (key === " " && target.matches?.("button, a")) return;
    const arrow = target.matches?.("input[type=range]") ? null : arrows[key];
    if (arrow) send(event.shiftKey ? "move" : "turn", arrow.map((x) => x * 0.03));
    else if (keys[key.toLowerCase()]) keys[key.toLowerCase()]();
    else return;
    event.preventDefault();
  }, { signal });
}
