// The returns of finished episodes, and the comparison of policies.
import { h, number } from "./dom.js";
import { POLICIES } from "./hands.js";
import { plot } from "./plot.js";
import { card } from "./state.js";

const COLOURS = { good: "--good", random: "--random", none: "--you", learner: "--good", script: "--quiet" };
const MOST = 500; // episodes in the chart
const COMPARED = 20; // episodes of each policy

// Returns the card, and the functions `add(episode)`, `show()` and `end()`.
export function makeReturns(game) {
  const episodes = [];
  const chart = h("canvas", { class: "chart", role: "img", "aria-label": "Returns of the episodes" });
  const text = h("p", { class: "quiet" }, "The return of each episode that ends appears here.");
  const show = () => game.env && showEpisodes(chart, text, episodes, game.env.threshold);
  const add = (episode) => {
    episodes.push(episode);
    if (episodes.length > MOST) episodes.shift();
    show();
  };
  const comparison = makeComparison(game, add);
  const redraw = new ResizeObserver(show);
  redraw.observe(chart);
  return {
    element: card("Episodes", chart, text, comparison.button), add, show,
    end() {
      comparison.stop();
      redraw.disconnect();
    },
  };
}

function showEpisodes(chart, text, episodes, threshold) {
  const kinds = [...new Set(episodes.map(({ by }) => by))].map((by) => ({ by, values: episodes.filter((episode) => episode.by === by).map((episode) => episode.return) }));
  plot(chart, kinds.map(({ by, values }) => ({ values, colour: COLOURS[by], dots: true })), { line: threshold });
  if (!kinds.length) return;
  const mean = (values) => values.reduce((sum, value) => sum + value, 0) / values.length;
  const parts = kinds.flatMap(({ by, values }, i) => [i ? " · " : "", h("span", { class: `swatch who-${by}` }), ` ${POLICIES[by] ?? "Recorded"}: ${number(mean(values))} on average over ${values.length}`]);
  text.replaceChildren(...parts, threshold === null ? "" : `. The dashed line: solved at ${number(threshold)}.`);
}

// Makes the button that plays episodes of each policy, in another environment than the shown one. A second click stops.
function makeComparison(game, add) {
  const { engine, environment } = game;
  const policies = environment.policy ? ["good", "random"] : ["random"];
  const label = environment.policy ? `Play ${COMPARED} of each policy` : `Play ${COMPARED} at random`;
  let running = false;
  async function episode(env, by, seed) {
    let at = await engine.request({ do: "reset", env, seed: String(seed) });
    while (!(at.terminated || at.truncated) && running) at = await engine.request({ do: "step", env, by, action: null, learner: null, count: 20 });
    if (running) add({ by, return: at.return });
  }
  async function compare() {
    if (running) {
      running = false;
      return;
    }
    running = true;
    button.textContent = "Stop";
    const env = 1_000_000 + game.env.env;
    try {
      await engine.request({ do: "make", env, id: game.id, kwargs: game.asked.kwargs, fit: 1 });
      for (let seed = 0; seed < COMPARED && running; seed++) {
        for (const by of policies) await episode(env, by, seed);
      }
    } catch (error) {
      game.report(error);
    }
    engine.request({ do: "close", env }).catch(() => {});
    running = false;
    button.textContent = label;
  }
  const button = h("button", { type: "button", onclick: compare }, label);
  return { button, stop: () => (running = false) };
}
