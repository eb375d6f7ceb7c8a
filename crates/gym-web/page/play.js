// The page of one environment: picture, player and state. This module assembles the parts. Each part is a module, and
// all parts share the object `game`.
import { wishes } from "./address.js";
import { argumentsForm } from "./arguments.js";
import { h } from "./dom.js";
import { paint } from "./engine.js";
import { cardOf, choice, link, words } from "./gallery.js";
import { POLICIES, makeHands, makePlayers } from "./hands.js";
import { actions as namedActions, markdown, page, section } from "./pages.js";
import { makeReturns } from "./returns.js";
import { unpack } from "./share.js";
import { makeSharing } from "./sharing.js";
import { makeStage } from "./stage.js";
import { card, makeState } from "./state.js";
import { makeTransport } from "./transport.js";

export async function play(main, engine, environments, id, parameters, refresh) {
  const environment = environments.find((environment) => environment.id === id);
  if (!environment) throw new Error(`There is no environment “${id}” here.`);
  const heading = head(environment, cardOf(environments, environment));
  if (environment.missing) return needs(main, engine, environment, heading, refresh);

  const [argumentList, book] = await Promise.all([engine.request({ do: "arguments", id }), page(id)]);
  const actionNames = book ? namedActions(book.text) : new Map();
  const { asked, faults } = wishes(parameters, environment, POLICIES);
  asked.script = parameters.get("actions") ? await unpack(parameters.get("actions")) : null;
  asked.paused = matchMedia("(prefers-reduced-motion: reduce)").matches;

  const game = makeGame(engine, environment, asked);
  game.stage = makeStage(game);
  game.transport = makeTransport(game);
  game.players = makePlayers(game);
  game.hands = makeHands(game, actionNames);
  game.shown = makeState(game, actionNames);
  game.returns = makeReturns(game);
  game.sharing = makeSharing(game);
  game.spaces = h("dl", { class: "spaces" });
  const form = argumentsForm(argumentList, asked.kwargs, (kwargs) => {
    asked.kwargs = kwargs;
    return start(game);
  });
  lay(main, heading, game, argumentList.length ? card("Arguments", form) : null, about(book));
  const endKeys = listenToKeys(game);
  game.pause(asked.paused);
  await start(game);
  if (faults.length) game.report(faults.join(" "));
  return () => {
    endKeys();
    game.returns.end();
    game.hands.end();
    if (game.env) engine.close(game.env.env);
  };
}

// Makes the object that the parts share: the environment, the settings (`asked`), and the functions that parts call on
// other parts.
function makeGame(engine, environment, asked) {
  const message = h("p", { class: "message", role: "status", hidden: true });
  const tell = (text, isError) => {
    message.textContent = text;
    message.classList.toggle("error", isError);
    message.hidden = !text;
  };
  const game = {
    engine, environment, id: environment.id, asked, message,
    env: null, // the worker's environment
    state: null,
    ended: false,
    say: (text) => tell(text, false),
    report: (error) => tell(error.message ?? error, true),
    set: (options) => game.env && engine.handle("set", { env: game.env.env, ...options }).catch(game.report),
    pause: (is) => game.transport.pause(is),
    seed: () => game.shown.seed.input.value,
    // Starts the episode of `seed`; without `seed`, restarts the current episode.
    reset(seed = game.seed()) {
      game.say("");
      game.shown.seed.input.value = seed;
      engine.handle("reset", { env: game.env.env, seed }).then(() => game.pause(false)).catch(game.report);
    },
  };
  return game;
}

// Opens the environment with the arguments in `asked`. If they are invalid, the previous environment stays open.
async function start(game) {
  const { asked, engine, id } = game;
  const opened = await engine.open({ id, kwargs: asked.kwargs, seed: game.seed(), by: asked.by, speed: asked.speed, script: asked.script, paused: asked.paused }, (told) => hear(game, told));
  if (game.env) engine.close(game.env.env);
  const env = (game.env = opened);
  const view = game.shown.open(env);
  game.set({ sight: view.wantsSight === true, idle: env.keys?.idle?.action ?? null, repeats: env.keys?.idle === "repeat" });
  game.spaces.replaceChildren(...[["observation", env.observation_space], ["action", env.action_space]].flatMap(([name, space]) => [h("dt", {}, name), h("dd", {}, h("code", {}, space.text))]));
  game.sharing.forget();
  game.sharing.showCode(game.seed());
  game.stage.fit(env);
  game.players.show();
  game.hands.show();
  game.say("");
  // request the first picture again: it arrived before `game.env` was set
  await engine.handle("show", { env: env.env });
  if (!asked.script) history.replaceState(null, "", await game.sharing.address(false));
}

// Handles a message of the worker: an error, the end of a script or of an episode, or a picture with the state.
function hear(game, { state, frame, pixels, seed, sight, sightPixels, episode, scriptEnded, error }) {
  const { asked } = game;
  if (error) {
    game.pause(true);
    game.report(error);
    return;
  }
  if (scriptEnded) {
    asked.script = null;
    game.pause(true);
    game.say("What was recorded ends here. Play goes on from it.");
  }
  if (episode) game.returns.add({ by: asked.script ? "script" : episode.by, return: episode.return });
  if (!frame || !game.env) return;
  paint(game.stage.canvas, frame, pixels);
  if (sight) game.shown.see(sight, sightPixels);
  const { input } = game.shown.seed;
  if (document.activeElement !== input) input.value = seed;
  game.sharing.showCode(seed);
  game.state = state;
  game.ended = state.terminated || state.truncated;
  for (const part of [game.shown, game.transport]) part.update(state);
  game.stage.over(state);
}

// Handles the page's keyboard shortcuts, except keys that the environment uses.
function listenToKeys(game) {
  const onKey = (event) => {
    if (event.target.matches?.("input:not([type=range]):not([type=radio]), textarea, select")) return;
    const action = { ",": () => game.transport.seek(game.state.steps - 1), ".": () => game.transport.stepOn(), p: () => game.pause(!game.asked.paused), r: () => game.reset() }[event.key];
    const isTaken = (game.env?.keys?.actions ?? []).some(([key]) => key === event.key.toUpperCase());
    if (!action || !game.env || event.ctrlKey || event.metaKey || isTaken) return;
    action();
  };
  addEventListener("keydown", onKey);
  return () => removeEventListener("keydown", onKey);
}

// Places the parts on the page.
function lay(main, heading, game, argumentCard, aboutCard) {
  const { stage, transport, message, players, hands, shown, returns, sharing } = game;
  main.replaceChildren(
    heading,
    h("div", { class: "play" },
      h("div", { class: "play-main" }, stage.element, stage.hint, transport.element, message, h("div", { class: "who-row" }, players.element), hands.element),
      h("div", { class: "play-side" }, shown.cards, returns.element)),
    h("div", { class: "play-more" }, argumentCard, sharing.cards, card("Spaces", game.spaces), aboutCard));
}

// Returns the heading: name, the menu of the card's environments, and task.
function head(environment, card) {
  const { name, version, description } = environment;
  const menu = () => choice(card, environment, ({ id }) => (location.hash = link(id)));
  const shown = card.length > 1 ? menu() : version === null ? null : h("span", { class: "version" }, `v${version}`);
  return h("div", { class: "play-head" }, h("div", {}, h("h1", {}, words(name), " ", shown), h("p", {}, description)));
}

// Returns the book's page, without the sections that the page of the environment shows too.
function about(book) {
  if (!book) return null;
  const whole = section(book.text.replace(/^/, "\n## All\n").replace(/\n## (?!All)/g, "\n### "), "All");
  const text = whole.replace(/\n### (Returns|Ids|Numbers|Spaces|Arguments)\n[\s\S]*?(?=\n### |$)/g, "").replace(/^[\s\S]*?\n# [^\n]+\n/, "");
  return h("details", { class: "card about" }, h("summary", {}, h("h2", {}, "About this task")), markdown(text));
}

// Shows a file input for an environment that needs a file from the user, such as a ROM.
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
        answer.textContent += " That is another game than this one.";
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
