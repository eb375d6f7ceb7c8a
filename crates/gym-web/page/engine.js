// The functions by which the page uses its workers.

const single = globalThis.GYM_SINGLE;
const here = (name) => new URL(name, import.meta.url);

// Returns the decompressed file `name`, which lies beside the page or is embedded in the page.
async function unzipped(name) {
  const bytes = single
    ? Uint8Array.from(atob(single[name]), (c) => c.charCodeAt(0))
    : await fetch(here(name)).then((response) => {
        if (!response.ok) throw new Error(`${name}: ${response.status} ${response.statusText}`);
        return response.blob();
      });
  return new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip")));
}

let compiled = null;
const module = () => (compiled ??= unzipped("gym.wasm.gz").then((r) => r.arrayBuffer()).then((bytes) => WebAssembly.compile(bytes)));

let texts = null;
// Loads the book's pages about the environments, by name.
export const docs = () => (texts ??= unzipped("docs.json.gz").then((r) => r.json()).catch(() => ({})));

// A worker that runs an instance of the WebAssembly module.
export class Engine {
  #worker;
  #next = 1;
  #pending = new Map();
  #loops = new Map();
  #roms = [];
  ready;

  constructor() {
    this.#start();
  }

  #start() {
    const url = single ? URL.createObjectURL(new Blob([single["worker.js"]], { type: "text/javascript" })) : here("worker.js");
    this.#worker = new Worker(url);
    this.#worker.onmessage = ({ data }) => this.#receive(data);
    this.#worker.onerror = (event) => console.error(`worker: ${event.message}`);
    this.ready = module().then((module) => this.#post({ module })).then(async () => {
      for (const bytes of this.#roms) await this.#post({ request: { do: "rom" }, bytes });
    });
  }

  #receive({ id, answer, attachment, error, trap, ...data }) {
    if (trap) this.#restart(error);
    if (id !== undefined) {
      const { resolve, reject } = this.#pending.get(id) ?? {};
      this.#pending.delete(id);
      if (error !== undefined) reject?.(new Error(error));
      else resolve?.(attachment ? { answer, attachment } : answer);
      return;
    }
    this.#loops.get(data.loop)?.({ ...data, error });
    if (data.frame) this.handle("shown", { env: data.loop });
  }

  // Starts a new worker after a panic, which ends the old instance of the module. Rejects all pending requests.
  #restart(reason) {
    this.#worker.terminate();
    for (const { reject } of this.#pending.values()) reject(new Error(reason));
    this.#pending.clear();
    const loops = [...this.#loops];
    this.#loops.clear();
    this.#start();
    for (const [loop, listener] of loops) listener({ loop, error: reason });
  }

  #post(message) {
    const id = this.#next++;
    return new Promise((resolve, reject) => {
      this.#pending.set(id, { resolve, reject });
      this.#worker.postMessage({ id, ...message });
    });
  }

  // Sends a request to the module.
  async request(request, bytes) {
    await this.ready;
    return this.#post({ request, bytes });
  }

  // Calls a handler of the worker.
  async handle(handler, request) {
    await this.ready;
    return this.#post({ handler, request });
  }

  // Opens an environment, which then plays. Calls `listener` with its pictures, its states and the ends of its
  // episodes.
  async open(options, listener) {
    const env = this.#next++;
    this.#loops.set(env, listener);
    try {
      return { env, ...(await this.handle("open", { env, ...options })) };
    } catch (error) {
      this.#loops.delete(env);
      throw error;
    }
  }

  close(env) {
    this.#loops.delete(env);
    return this.handle("close", { env }).catch(() => {});
  }

  // Sends a ROM to this instance, and to the instances that replace it. Returns the name of the game.
  async rom(bytes) {
    const title = await this.request({ do: "rom" }, bytes);
    this.#roms.push(bytes);
    return title;
  }

  end() {
    this.#worker.terminate();
  }
}

// Draws `pixels` on a canvas, after resizing the canvas to the size of the picture.
export function paint(canvas, { width, height }, pixels) {
  if (canvas.width !== width || canvas.height !== height) [canvas.width, canvas.height] = [width, height];
  canvas.getContext("2d").putImageData(new ImageData(new Uint8ClampedArray(pixels.buffer), width, height), 0, 0);
}
