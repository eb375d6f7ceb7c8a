// The state of the episode: return, last step, observation, `info` and seed.
import { h, iconButton, number } from "./dom.js";
import { observationView } from "./observation.js";

export const card = (title, ...content) => h("section", { class: "card" }, h("h2", {}, title), ...content);

const randomSeed = () => String(crypto.getRandomValues(new Uint32Array(1))[0] % 100000);
const terms = (pairs) => pairs.flatMap(([name, value]) => [h("dt", {}, name), h("dd", {}, value)]);

function infoText(value) {
  if (typeof value === "number") return number(value);
  if (Array.isArray(value)) return value.map(infoText).join(", ");
  return typeof value === "object" && value !== null ? JSON.stringify(value) : String(value);
}

// Returns the cards, the seed field, `open(env)` for a newly opened environment, and `update(state)`.
export function makeState(game, actionNames) {
  const sum = h("output", { class: "return" }, "0");
  const facts = h("dl", { class: "facts" });
  const observed = h("div", {});
  const infoList = h("dl", { class: "facts" });
  const infoCard = card("Info", infoList);
  const seed = seedField(game);
  let view = null;
  const actionText = (action) => {
    if (action === null) return "–";
    return typeof action === "number" ? String(actionNames.get(action)?.name ?? action) : `[${[action].flat().map(number).join(", ")}]`;
  };
  return {
    seed,
    cards: [
      h("section", { class: "card episode" },
        h("div", { class: "episode-head" }, h("div", {}, h("h2", {}, "Return"), sum), h("div", { class: "seed-row" }, h("label", {}, "Seed ", seed.input), seed.dice)),
        facts),
      card("Observation", observed),
      infoCard,
    ],
    open({ observation_space: space, names }) {
      view = observationView(space, names.observation);
      observed.replaceChildren(view.element);
      return view;
    },
    see: (size, pixels) => view.see?.(size, pixels),
    update(state) {
      sum.textContent = number(state.return);
      const limit = game.env.limit ? ` of ${game.env.limit}` : "";
      facts.replaceChildren(...terms([["step", `${state.steps}${limit}`], ["reward", number(state.reward)], ["action", actionText(state.action)]]));
      const entries = Object.entries(state.info).map(([name, value]) => [name, infoText(value)]);
      infoCard.hidden = entries.length === 0;
      infoList.replaceChildren(...terms(entries));
      view?.update(state.observation);
    },
  };
}

function seedField(game) {
  const input = h("input", { inputmode: "numeric", pattern: "[0-9]+", value: game.asked.seed, "aria-label": "Seed", class: "seed" });
  input.addEventListener("change", () => (/^\d+$/.test(input.value) ? game.reset() : game.report("A seed is a whole number, zero or greater.")));
  return { input, dice: iconButton("dice", "Another seed", () => game.reset(randomSeed())) };
}
