// The book's page on an environment: what its observations and actions are called, and its text.
import { docs } from "./engine.js";
import { h } from "./dom.js";

// The page on an environment, if the book has one: the first whose table of ids has it.
export async function page(id) {
  for (const [name, text] of Object.entries(await docs())) {
    if (section(text, "Ids").includes(`\`${id}\``)) return { name, text };
  }
  return null;
}

// The text under a heading of the second level.
export function section(text, title) {
  const [, after = ""] = text.split(`\n## ${title}\n`);
  return after.split("\n## ")[0].trim();
}

// The rows of the first table in a text, without its heading.
export function rows(text) {
  const lines = text.split("\n").filter((line) => line.startsWith("|"));
  return lines.slice(2).map((line) => line.replace(/^\||\|$/g, "").split(/(?<!\\)\|/).map((cell) => cell.trim()));
}

// What the numbers of an observation are called: the rows `0, 1` or `3` or `5 to 9` of the page's table.
export function names(text, count) {
  const list = listedNames(text, count);
  for (const [numbers, name, unit = ""] of rows(section(text, "Observation"))) {
    const range = /^(\d+)\s*(?:to|–|-)\s*(\d+)$/.exec(numbers);
    const indices = range
      ? Array.from({ length: range[2] - range[1] + 1 }, (_, i) => Number(range[1]) + i)
      : numbers.split(",").map((text) => Number.parseInt(text, 10));
    indices.forEach((index, i) => {
      if (Number.isInteger(index)) list[index] = { name: plain(name), part: indices.length > 1 ? i + 1 : 0, unit: plain(unit) };
    });
  }
  return list;
}

// The same from the first table, where the row `observation` has just as many parts: `cart position (m), cart velocity (m/s)`.
function listedNames(text, count) {
  const row = rows(text).find(([name]) => name === "observation");
  const parts = plain(row?.[1] ?? "").split(";")[0].split(/,\s+(?![^(]*\))/);
  if (parts.length !== count) return [];
  return parts.map((part) => {
    const [, name, unit = ""] = /^(.*?)(?:\s*\(([^)]*)\))?$/.exec(part);
    return { name, part: 0, unit };
  });
}

// The names of discrete actions, by number.
export function actions(text) {
  const named = new Map();
  for (const [number, name, meaning = ""] of rows(section(text, "Actions"))) named.set(Number(number), { name: plain(name), meaning: plain(meaning) });
  return named;
}

export const plain = (text) => text.replace(/\[([^\]]+)\]\([^)]+\)/g, "$1").replace(/[`*]/g, "");

// Markdown of the book as elements: paragraphs, tables, lists, code.
export function markdown(text) {
  const blocks = [];
  for (const block of text.split(/\n{2,}/)) {
    const lines = block.split("\n");
    if (block.startsWith("<!--") || block.startsWith("![")) continue;
    if (block.startsWith("#")) blocks.push(h("h3", {}, inline(block.replace(/^#+\s*/, ""))));
    else if (block.startsWith("|")) {
      const cells = (line, tag) => line.replace(/^\||\|$/g, "").split(/(?<!\\)\|/).map((cell) => h(tag, {}, inline(cell.trim().replaceAll("\\|", "|"))));
      const head = lines[0].replace(/[|\s]/g, "") ? h("thead", {}, h("tr", {}, cells(lines[0], "th"))) : null;
      blocks.push(h("div", { class: "table", tabindex: "0", role: "region", "aria-label": "Table" }, h("table", {}, head, h("tbody", {}, lines.slice(2).map((line) => h("tr", {}, cells(line, "td")))))));
    } else if (/^[-*] /.test(block)) blocks.push(h("ul", {}, block.split(/\n(?=[-*] )/).map((item) => h("li", {}, inline(item.slice(2))))));
    else if (block.startsWith("```")) blocks.push(h("pre", {}, h("code", {}, lines.slice(1, -1).join("\n"))));
    else if (block.trim()) blocks.push(h("p", {}, inline(block)));
  }
  return blocks;
}

// Code, emphasis and the text of links: the book's own links lead nowhere here.
function inline(text) {
  return text.split(/(`[^`]+`|\*\*[^*]+\*\*|\*[^*]+\*|\[[^\]]+\]\([^)]+\))/).map((part) => {
    if (/^`/.test(part)) return h("code", {}, part.slice(1, -1));
    if (/^\*\*/.test(part)) return h("strong", {}, part.slice(2, -2));
    if (/^\*./.test(part)) return h("em", {}, part.slice(1, -1));
    if (/^\[/.test(part)) return h("span", {}, inline(part.slice(1, part.indexOf("]("))));
    return part;
  });
}
