// The gallery: environments by family, each playing in a tile.
import { h } from "./dom.js";
import { paint } from "./engine.js";
import { page, titleOf } from "./pages.js";


// The size of a tile's picture. Environments draw vector graphics, and a small picture takes less time.
const TILE = 300;

const still = matchMedia("(prefers-reduced-motion: reduce)");

// Returns the words of a name, with possible line breaks between them.
export const words = (name) => name.split(/(?<=[a-z0-9])(?=[A-Z])/).flatMap((word, i) => (i ? [h("wbr"), word] : [word]));

// Groups environments by family, and each family's environments by card: those that share a page of the book. The first of
// a card is the one that it shows; the newest version of a name comes before the others.
export function families(environments) {
  const families = new Map();
  for (const environment of environments) {
    const cards = families.get(environment.family) ?? [];
    families.set(environment.family, cards);
    (cards[environment.card] ??= []).push(environment);
  }
  const byName = (a, b) => b.shown - a.shown || (a.name < b.name ? -1 : a.name > b.name ? 1 : (b.version ?? 0) - (a.version ?? 0));
  for (const cards of families.values()) cards.forEach((card) => card.sort(byName));
  return families;
}

// Returns the card of an environment.
export const cardOf = (environments, { family, card }) => families(environments).get(family)[card];

// Returns a menu of a card's environments, with `chosen` selected.
export function choice(card, chosen, choose) {
  const isOfOneName = card.every(({ name }) => name === chosen.name);
  const menu = h("select", { class: "choice", "aria-label": isOfOneName ? "Version" : "Environment" }, card.map((other) => h("option", { value: other.id, selected: other === chosen }, isOfOneName ? `v${other.version}` : other.id)));
  menu.addEventListener("change", () => choose(card.find(({ id }) => id === menu.value)));
  return menu;
}

export const link = (id) => `#/${id.split("/").map(encodeURIComponent).join("/")}`;

export function gallery(main, engine, environments, hasRobots) {
  const tiles = new Map();
  const playing = new IntersectionObserver((entries) => {
    for (const { target, isIntersecting } of entries) tiles.get(target)?.(isIntersecting);
  }, { rootMargin: "80px" });

  function tile(card) {
    const [environment] = card;
    const canvas = h("canvas", { width: TILE, height: TILE * 2 / 3, "aria-hidden": "true" });
    const name = h("span", {}, words(environment.name.replace(/^ALE\//, "")));
    const version = card.length > 1 || environment.version === null ? null : h("span", { class: "version" }, `v${environment.version}`);
    const task = h("p", {}, environment.description);
    const to = h("a", { href: link(environment.id) }, h("div", { class: "tile-picture" }, canvas), h("h3", {}, name, " ", version), task);
    page(environment.id).then((page) => page && name.replaceChildren(...words(titleOf(page.text))));
    let seen = false;
    let play = live(canvas, environment);
    const menu = card.length > 1 ? choice(card, environment, (chosen) => {
      to.href = link(chosen.id);
      task.textContent = chosen.description;
      play(false);
      play = live(canvas, chosen);
      play(seen);
    }) : null;
    const element = h("li", { class: "tile" }, to, menu);
    tiles.set(element, (isSeen) => play(seen = isSeen));
    playing.observe(element);
    return element;
  }

  // Returns a function that plays a tile while the tile is visible. If the user prefers reduced motion, the tile stops
  // at its first picture.
  function live(canvas, environment) {
    let open = null;
    let frames = 0;
    const start = async () => {
      const by = environment.policy ? "good" : "random";
      return engine.open({ id: environment.id, kwargs: {}, fit: TILE, seed: "0", by, interval: 30 }, ({ frame, pixels, error }) => {
        if (error) return console.error(`${environment.id}: ${error}`);
        if (!frame) return;
        paint(canvas, frame, pixels);
        // the tile's background has the colour of the picture's first pixel
        if (frames === 0) canvas.parentElement.style.background = `rgb(${pixels.slice(0, 3).join(" ")})`;
        frames += 1;
        if (still.matches && frames === 1) open?.then((env) => env && engine.handle("set", { env: env.env, paused: true }));
      }).catch((error) => console.error(`${environment.id}: ${error.message}`));
    };
    return (seen) => {
      if (seen && !open) open = start();
      else if (!seen && open) {
        open.then((env) => env && engine.close(env.env));
        open = null;
      }
    };
  }

  const sections = [...families(environments)].map(([family, all]) => {
    const lacking = all.filter(([shown]) => shown.missing);
    // ids from before ale-py had a namespace
    const isOld = ([shown]) => family === "Atari" && !shown.name.includes("/");
    const list = h("ul", { class: "tiles" }, all.filter((card) => !card[0].missing && !isOld(card)).map(tile));
    const chips = (cards) => h("ul", { class: "chips" }, cards.map(([{ id, name }]) => h("li", {}, h("a", { href: link(id) }, name.replace(/^[^/]*\//, "")))));
    const rest = lacking.filter((card) => !isOld(card));
    const old = all.filter(isOld);
    const folded = [
      rest.length ? h("p", { class: "quiet" }, `These need ${rest[0][0].missing}, which you give on their page.`) : null,
      rest.length ? chips(rest) : null,
      old.length ? h("details", {}, h("summary", {}, `${old.length} older names`), chips(old)) : null,
    ];
    return { element: h("section", { class: "family", "aria-label": family }, h("h2", {}, family), list, folded), lists: [list, ...folded.flatMap((part) => (part ? [...(part.matches("ul") ? [part] : part.querySelectorAll("ul"))] : []))] };
  });
  const none = h("p", { class: "none", hidden: true }, "No environment has that in its name or description.");
  const search = h("input", { type: "search", placeholder: "Search", "aria-label": "Search the environments" });
  search.addEventListener("input", () => {
    const words = search.value.toLowerCase().split(/\s+/).filter(Boolean);
    let found = 0;
    for (const { element, lists } of sections) {
      let seen = 0;
      for (const item of lists.flatMap((list) => [...list.children])) {
        item.hidden = !words.every((word) => (element.getAttribute("aria-label") + item.textContent).toLowerCase().includes(word));
        seen += !item.hidden;
      }
      element.hidden = seen === 0;
      found += seen;
    }
    none.hidden = found > 0;
  });
  main.replaceChildren(
    h("section", { class: "hero" },
      h("div", {},
        h("h1", {}, "Gymnasium's environments, live"),
        h("p", {}, h("a", { href: "https://gymnasium.farama.org" }, "Gymnasium"), " is the usual interface between agents that learn and the tasks that they learn: an agent sees an observation, chooses an action and gets a reward. These are its tasks, written in Rust and compiled for the browser."),
        h("p", {}, "Watch a good policy, take over yourself, see what the agent sees, and ", h("a", { href: "#/learn" }, "train an agent"), ". ", hasRobots && ["Drop ", h("a", { href: "#/robot" }, "your own robot"), " here and drive it. "], "Nothing to install.")),
      search),
    ...sections.map(({ element }) => element),
    none);
  return () => {
    playing.disconnect();
    for (const toggle of tiles.values()) toggle(false);
  };
}
