// Exports of an episode: a GIF, a trace, links, and code that starts the episode.
import { snippets } from "./arguments.js";
import { copy, download, h } from "./dom.js";
import { link } from "./gallery.js";
import { pack } from "./share.js";
import { card } from "./state.js";

const GIF_FRAMES = 600;

// Returns the cards, and the functions `address(withActions)`, `showCode(seed)` and `forget()`.
export function makeSharing(game) {
  const { asked, engine, id } = game;
  async function address(withActions) {
    const query = new URLSearchParams({ seed: game.seed(), policy: asked.by });
    if (Object.keys(asked.kwargs).length) query.set("args", JSON.stringify(asked.kwargs));
    if (withActions) query.set("actions", await pack(await engine.request({ do: "actions", env: game.env.env })));
    return `${link(id)}?${query}`;
  }
  const buttons = [
    fileButton(game, "GIF", { do: "gif", frames: GIF_FRAMES }, "image/gif", "gif"),
    fileButton(game, "Trace", { do: "trace" }, "application/json", "json"),
    linkButton(game, "Link to this seed", () => address(false)),
    linkButton(game, "Link to this very episode", () => address(true)),
  ];
  const note = h("p", { class: "quiet" }, "The trace holds every action and answer; ", h("code", {}, "cargo xtask replay"), " compares it bit for bit. A link gives the same bits to whoever opens it.");
  const code = h("div", { class: "code" });
  let shown = null;
  function showCode(seed) {
    if (seed === shown) return;
    shown = seed;
    code.replaceChildren(...snippets(id, asked.kwargs, seed).map(([language, text]) => {
      const button = h("button", { type: "button", class: "small", onclick: () => copy(text, button) }, "Copy");
      return h("div", {}, h("p", { class: "code-head" }, language, button), h("pre", { tabindex: "0" }, h("code", {}, text)));
    }));
  }
  const forget = () => (shown = null);
  return { cards: [card("Share this episode", h("div", { class: "buttons" }, buttons), note), card("In code", code)], address, showCode, forget };
}

// Makes a button that downloads the module's answer to `request`.
function fileButton(game, label, request, type, extension) {
  const button = h("button", { type: "button" }, label);
  button.addEventListener("click", async () => {
    button.disabled = true;
    try {
      const { attachment } = await game.engine.request({ ...request, env: game.env.env });
      download(attachment, type, `${game.id.replaceAll("/", "-")}-${game.seed()}.${extension}`);
    } catch (error) {
      game.report(error);
    }
    button.disabled = false;
  });
  return button;
}

// Makes a button that copies an address.
function linkButton(game, label, address) {
  const button = h("button", { type: "button" }, label);
  button.addEventListener("click", () => address().then((hash) => copy(new URL(hash, location.href).href, button)).catch(game.report));
  return button;
}
