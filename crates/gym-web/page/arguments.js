// The form for an environment's arguments, and the code that makes the environment.
import { h, prose } from "./dom.js";

const same = (a, b) => JSON.stringify(a) === JSON.stringify(b);

// Makes a form. `apply(kwargs)` gets the arguments that differ from their default values; the form shows its errors.
export function argumentsForm(list, kwargs, apply) {
  const status = h("p", { class: "quiet", role: "status" });
  const fields = list.map(({ name, value, kind = "", unit = "", meaning = "" }) => {
    const now = kwargs[name] ?? value;
    const isNumber = typeof value === "number";
    const input = typeof value === "boolean"
      ? h("input", { type: "checkbox", checked: now, id: `argument-${name}` })
      : h("input", { type: isNumber ? "number" : "text", step: "any", id: `argument-${name}`, value: isNumber ? String(now) : JSON.stringify(now) });
    const read = () => {
      if (input.type === "checkbox") return input.checked;
      if (isNumber) {
        if (input.value === "") throw new Error(`${name}: a number is missing`);
        return Number(input.value);
      }
      try {
        return JSON.parse(input.value);
      } catch {
        // not JSON: a text without quotes
        return input.value;
      }
    };
    const element = h("div", { class: `argument${typeof value === "boolean" ? " check" : ""}` },
      h("label", { for: input.id }, name, unit ? h("span", { class: "unit" }, ` ${unit}`) : null), input,
      meaning ? h("p", { class: "quiet" }, prose(meaning), kind ? h("span", { class: "kind" }, ` (${kind})`) : null) : null);
    return { name, value, read, element };
  });
  const submit = async (event) => {
    event.preventDefault();
    try {
      const next = {};
      for (const { name, value, read } of fields) {
        const given = read();
        if (!same(given, value)) next[name] = given;
      }
      await apply(next);
      status.textContent = Object.keys(next).length ? "Playing with these arguments." : "Playing with the default arguments.";
      status.classList.remove("error");
    } catch (error) {
      status.textContent = error.message;
      status.classList.add("error");
    }
  };
  return h("form", { class: "arguments", onsubmit: submit, novalidate: true }, fields.map(({ element }) => element), h("div", { class: "buttons" }, h("button", { class: "primary", type: "submit" }, "Apply"), status));
}

const python = (value) => (value === null ? "None" : value === true ? "True" : value === false ? "False" : Array.isArray(value) ? `[${value.map(python).join(", ")}]` : typeof value === "object" ? `{${Object.entries(value).map(([key, item]) => `${JSON.stringify(key)}: ${python(item)}`).join(", ")}}` : JSON.stringify(value));
const rust = (value) => (value === null || typeof value === "object" ? `serde_json::json!(${JSON.stringify(value)})` : JSON.stringify(value));

// Returns Rust and Python code that makes this environment and resets it.
export function snippets(id, kwargs, seed) {
  const given = Object.entries(kwargs);
  const make = given.length
    ? `gym::builder(${JSON.stringify(id)})${given.map(([name, value]) => `\n    .arg(${JSON.stringify(name)}, ${rust(value)})`).join("")}\n    .build()?`
    : `gym::make(${JSON.stringify(id)})?`;
  return [
    ["Rust", `use gym::prelude::*;\n\nlet mut env = ${make};\nlet observation = env.reset(${seed})?;`],
    ["Python", `import rustgym as gym\n\nenv = gym.make(${[JSON.stringify(id), ...given.map(([name, value]) => `${name}=${python(value)}`)].join(", ")})\nobservation, info = env.reset(seed=${seed})`],
  ];
}
