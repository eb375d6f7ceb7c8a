// Reads the address of the page: the part of the page, and its parameters.

// Splits a hash such as `#/CartPole-v1?seed=7` into its path and its parameters.
export function parse(hash) {
  const [path, query] = hash.replace(/^#\/?/, "").split("?");
  try {
    return { path: decodeURIComponent(path), parameters: new URLSearchParams(query) };
  } catch {
    throw new Error(`The address “${path}” has a damaged escape: after each “%” stand two digits from 0 to f. Ask for the link again.`);
  }
}

const SPEED = [0.01, 1000];

// Reads the parameters of an environment's page: returns the settings (`asked`), and a message for each invalid
// parameter (`faults`).
export function wishes(parameters, environment, policies) {
  const faults = [];
  const wish = (name, usual, read) => {
    const text = parameters.get(name);
    if (text === null) return usual;
    try {
      return read(text);
    } catch (error) {
      faults.push(error.message);
      return usual;
    }
  };
  const usual = environment.policy ? "good" : "random";
  const known = Object.keys(policies).filter((by) => by !== "good" || environment.policy);
  const asked = {
    kwargs: wish("args", {}, (text) => {
      const kwargs = (() => {
        try { return JSON.parse(text); } catch { return null; }
      })();
      if (kwargs && typeof kwargs === "object" && !Array.isArray(kwargs)) return kwargs;
      throw new Error(`The arguments in this link are damaged: “${text}” is not an object in JSON.`);
    }),
    seed: wish("seed", "0", (text) => {
      if (/^\d+$/.test(text)) return text;
      throw new Error(`“${text}” is not a seed: a seed is a whole number, zero or greater.`);
    }),
    by: wish("policy", usual, (text) => {
      if (known.includes(text)) return text;
      if (text === "good") return usual;
      throw new Error(`There is no policy “${text}” here: choose ${known.join(", ")}.`);
    }),
    speed: wish("speed", 1, (text) => {
      const speed = Number(text);
      if (speed >= SPEED[0] && speed <= SPEED[1]) return speed;
      throw new Error(`“${text}” is not a speed: a speed is a number from ${SPEED[0]} to ${SPEED[1]}.`);
    }),
  };
  return { asked, faults };
}

// Whether the page is used by touch, without a keyboard and a mouse.
export const isTouched = () => matchMedia("(hover: none) and (pointer: coarse)").matches;
