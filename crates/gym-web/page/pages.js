// The book's page about an environment: its text, and the names of actions in it.
import { docs } from "./engine.js";
import { h } from "./dom.js";

// Returns the first page whose table of ids contains `id`.
export async function page(id) {
  for (const [name, text] of Object.entries(await docs())) {
    if (section(text, "Ids").includes(`\`${id}\``)) return { name, text };
  }
  return null;
}

// Returns the title of a page.
export const titleOf = (text) => /^# (.+)$/m.exec(text)?.[1] ?? "";

// Returns the text under the second-level heading `title`.
export function section(text, title) {
  const [, after = ""] = text.split(`\n## ${title}\n`);
  return after.split("\n## ")[0].trim();
}

// Returns the rows of the first table in a text, without the header row.
export function rows(text) {
  const lines = text.split("\n").filter((line) => line.startsWith("|"));
  return lines.slice(2).map((line) => line.replace(/^\||\|$/g, "").split(/(?<!\\)\|/).map((cell) => cell.trim()));
}

// Returns the names of discrete actions, by number.
export function actions(text) {
  const named = new Map();
  for (const [number, name, meaning = ""] of rows(section(text, "Actions"))) named.set(Number(number), { name: plain(name), meaning: plain(meaning) });
  return named;
}

export const plain = (text) => text.replace(/\[([^\]]+)\]\([^)]+\)/g, "$1").replace(/[`*]/g, "");

// Converts the book's Markdown to elements: paragraphs, tables, lists, code.
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

// Converts code, emphasis and links. A link becomes plain text, because this page does not contain the book.
function inline(text) {
  return text.split(/(`[^`]+`|\*\*[^*]+\*\*|\*[^*]+\*|\[[^\]]+\]\([^)]+\))/).map((part) => {
    if (/^`/.test(part)) return h("code", {}, part.slice(1, -1));
    if (/^\*\*/.test(part)) return h("strong", {}, part.slice(2, -2));
    if (/^\*./.test(part)) return h("em", {}, part.slice(1, -1));
    if (/^\[/.test(part)) return h("span", {}, inline(part.slice(1, part.indexOf("]("))));
    return part;
  });
}
