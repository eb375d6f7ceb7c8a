// The pressed keys, and their action.

// Returns the registry's name of a key: `Left`, `Space`, `A`, `1`.
export function keyName({ code }) {
  return code.replace(/^Arrow/, "").replace(/^Key(?=[A-Z]$)/, "").replace(/^Digit|^Numpad(?=\d$)/, "").replace(/^NumpadEnter$/, "Enter");
}

export const SYMBOLS = { Left: "←", Right: "→", Up: "↑", Down: "↓" };

// Keys and their actions. When keys are pressed or released, calls `changed` with the action of all pressed keys
// (`null` for none). Calls `pressed` with the action of each newly pressed key.
export class Keys {
  #down = new Set();
  #actions;

  constructor(actions, { changed, pressed }) {
    this.#actions = new Map(actions);
    Object.assign(this, { changed, pressed });
    this.listener = new AbortController();
    const on = (target, type, f) => target.addEventListener(type, f, { signal: this.listener.signal });
    on(window, "keydown", (event) => {
      const name = keyName(event);
      if (!this.#actions.has(name) || event.ctrlKey || event.metaKey || event.altKey || typing(event.target)) return;
      event.preventDefault();
      if (!event.repeat) this.press(name);
    });
    on(window, "keyup", (event) => this.release(keyName(event)));
    on(window, "blur", () => this.clear());
  }

  press(name) {
    if (this.#down.has(name)) return;
    this.#down.add(name);
    this.pressed(this.#actions.get(name));
    this.changed(this.action());
  }

  release(name) {
    if (this.#down.delete(name)) this.changed(this.action());
  }

  clear() {
    if (this.#down.size === 0) return;
    this.#down.clear();
    this.changed(null);
  }

  // Returns the sum of the keys' actions if they are vectors, else the action of the last key.
  action() {
    const actions = [...this.#down].map((name) => this.#actions.get(name));
    if (actions.length === 0) return null;
    const sum = (a, b) => (Array.isArray(a) && Array.isArray(b) ? a.map((x, i) => x + b[i]) : b);
    return actions.reduce(sum);
  }

  isDown(name) {
    return this.#down.has(name);
  }

  end() {
    this.listener.abort();
  }
}

// Returns whether the focused element handles keys itself: a text field, a slider or a list.
function typing(target) {
  return target.matches?.("input, textarea, select, [contenteditable]");
}
