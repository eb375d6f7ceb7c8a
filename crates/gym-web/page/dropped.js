// The files of a robot: from a dropped or chosen folder or archive, within limits that are checked before a file is read.
import { entries } from "./zip.js";

const MB = 1 << 20;
export const LIMITS = { files: 1000, file: 64 * MB, all: 256 * MB };
export const LIMITS_IN_WORDS = `At most ${LIMITS.files} files, ${LIMITS.file / MB} MB each and ${LIMITS.all / MB} MB together. In a .zip, the unpacked files count.`;
// entries that are not files of a model: folders, and what only people read
const ENTRIES = 4 * LIMITS.files;

// Files by their extension that no model reads. They are known by name, so that a model that names one hears why not.
const OTHERS = /\.(md|txt|rst|pdf|docx?|html?|css|js|ts|json|ya?ml|toml|lock|csv|npz?|pkl|pt|onnx|py|pyc|ipynb|sh|c|cc|cpp|h|hpp|rs|gif|jpe?g|webp|svg|bmp|tiff?|mp4|mov|avi|webm|mkv|zip|gz|tgz|bz2|xz|7z|rar|urdf|xacro|sdf|blend\d*|fbx|gl[bt]f?|usd[acz]?|ste?p|igs|iges|3mf|ply|dae|mtl)$/i;
const HIDDEN = /(^|\/)(\.[^/]*|__MACOSX|Thumbs\.db|desktop\.ini)(\/|$)/;

const size = (bytes) => (bytes >= MB ? `${(bytes / MB).toFixed(bytes < 10 * MB ? 1 : 0)} MB` : `${Math.ceil(bytes / 1024)} kB`);
const tooMany = (where) => new Error(`${where} has more than ${LIMITS.files} files: drop the folder of one robot.`);

// Returns the files of a drop, as `{path, size, read}`. Call it in the event: later the browser forgets what was dropped.
export function ofDrop(transfer) {
  const items = [...transfer.items].filter((item) => item.kind === "file");
  const roots = items.map((item) => item.webkitGetAsEntry?.() ?? item.getAsFile());
  return ofRoots(roots.filter(Boolean));
}

// Returns the files of `<input type=file>`.
export async function ofList(list) {
  if (list.length > ENTRIES) throw tooMany("The folder");
  return opened([...list].map((file) => ofFile(file.webkitRelativePath || file.name, file)));
}

const ofFile = (path, file) => ({ path, size: file.size, file, read: () => bytes(path, file) });

async function bytes(path, file) {
  try {
    return new Uint8Array(await file.arrayBuffer());
  } catch (error) {
    throw new Error(`${path} cannot be read: ${error.message}`);
  }
}

// Walks through dropped folders, and stops at the limits.
async function ofRoots(roots) {
  const found = [];
  const folders = [];
  let visited = 0;
  const visit = async (root) => {
    visited += 1;
    if (visited > ENTRIES) throw tooMany("The folder");
    if (root instanceof File) found.push(ofFile(root.name, root));
    else if (root.isDirectory) folders.push(root);
    else {
      const path = root.fullPath.replace(/^\/+/, "");
      if (HIDDEN.test(path)) return;
      const file = await new Promise((done, fail) => root.file(done, fail)).catch((error) => {
        throw new Error(`${path} cannot be read: ${error.message}`);
      });
      found.push(ofFile(path, file));
      if (found.filter(({ path }) => !OTHERS.test(path)).length > LIMITS.files) throw tooMany("The folder");
    }
  };
  for (const root of roots) await visit(root);
  while (folders.length) {
    const folder = folders.pop();
    if (HIDDEN.test(folder.fullPath)) continue;
    const reader = folder.createReader();
    for (;;) {
      // a call gives some of the entries
      const batch = await new Promise((done, fail) => reader.readEntries(done, fail)).catch((error) => {
        throw new Error(`The folder ${folder.fullPath} cannot be read: ${error.message}`);
      });
      if (batch.length === 0) break;
      for (const entry of batch) await visit(entry);
    }
  }
  return opened(found);
}

// Opens an archive that was dropped alone, and checks the number and the sizes of the files.
async function opened(found) {
  const [only] = found;
  const archive = found.length === 1 && /\.zip$/i.test(only.path) ? only.file : null;
  const files = (archive ? await entries(archive, ENTRIES) : found).filter(({ path }) => !HIDDEN.test(path));
  const where = archive ? archive.name : "The folder";
  const read = files.filter(({ path }) => !OTHERS.test(path));
  if (read.length > LIMITS.files) throw tooMany(where);
  const large = read.find((file) => file.size > LIMITS.file);
  if (large) throw new Error(`${large.path} has ${size(large.size)}; the limit is ${size(LIMITS.file)}. A mesh for contacts and pictures needs far less: simplify it.`);
  const all = read.reduce((sum, file) => sum + file.size, 0);
  if (all > LIMITS.all) throw new Error(`${where} has ${size(all)} of files; the limit is ${size(LIMITS.all)}. Drop the folder of one robot.`);
  return files.map((file) => ({ ...file, isRead: !OTHERS.test(file.path) }));
}

// Reads the files. Returns their bytes by path; those that no model reads are empty.
export async function contents(files) {
  const read = new Map();
  for (const { path, isRead, read: bytes } of files) read.set(path, isRead ? await bytes() : new Uint8Array());
  return read;
}

// Returns the paths of the models among the files: those that no other includes or attaches come first, of these the ones
// named `scene`, then the ones nearest to the top.
export function models(read) {
  const texts = new Map();
  for (const [path, bytes] of read) {
    if (!/\.(xml|mjcf)$/i.test(path)) continue;
    const text = new TextDecoder().decode(bytes);
    if (/<mujoco[\s>/]/.test(text)) texts.set(path, text.replace(/<!--[^]*?-->/g, ""));
  }
  const parts = new Set();
  for (const [path, text] of texts) {
    const folder = path.split("/").slice(0, -1);
    for (const [, , file] of text.matchAll(/<(?:include|model)\s[^>]*file\s*=\s*(["'])(.*?)\1/g)) parts.add(joined(folder, file));
  }
  const rank = (path) => [parts.has(path) ? 1 : 0, /(^|\/)scene\.(xml|mjcf)$/i.test(path) ? 0 : 1, path.split("/").length];
  const order = (a, b) => {
    const [x, y] = [rank(a), rank(b)];
    const at = x.findIndex((value, i) => value !== y[i]);
    return at < 0 ? (a < b ? -1 : 1) : x[at] - y[at];
  };
  return { all: [...texts.keys()].sort(order), whole: [...texts.keys()].filter((path) => !parts.has(path)).sort(order) };
}

// The path of a file beside a folder, without `.` and `..`.
function joined(folder, file) {
  const parts = [...folder];
  for (const part of file.split("/")) {
    if (part === "..") parts.pop();
    else if (part !== "." && part !== "") parts.push(part);
  }
  return parts.join("/");
}
