// Reads ZIP archives: the list at their end, and single files. Sizes are checked before and while a file is inflated.

const END = 0x06054b50;
const ENTRY = 0x02014b50;
// the longest end: 22 bytes and a comment
const LONGEST_END = 22 + 0xffff;
const ENCRYPTED = 1;
const METHODS = { 0: "stored", 8: "deflated" };

const view = async (blob, from, to) => new DataView(await blob.slice(from, to).arrayBuffer());

// Returns the archive's files as `{path, size, read}`, without its folders. `most` is the largest number of entries.
export async function entries(archive, most) {
  const damaged = (what) => new Error(`${archive.name} is no ZIP archive, or a damaged one: ${what}. Pack the folder again.`);
  const start = Math.max(0, archive.size - LONGEST_END);
  const tail = await view(archive, start, archive.size);
  let at = tail.byteLength - 22;
  while (at >= 0 && tail.getUint32(at, true) !== END) at -= 1;
  if (at < 0) throw damaged("its end is missing");
  const [count, size, offset] = [tail.getUint16(at + 10, true), tail.getUint32(at + 12, true), tail.getUint32(at + 16, true)];
  if (count === 0xffff || offset === 0xffffffff) throw new Error(`${archive.name} is in the format ZIP64, which this page does not read: pack fewer files, or drop the folder itself.`);
  if (count > most) throw new Error(`${archive.name} has ${count} entries; the limit is ${most}. Pack the folder of one robot.`);
  if (offset + size > archive.size) throw damaged("its list of files lies outside of it");
  const list = await view(archive, offset, offset + size);
  const found = [];
  for (let i = 0, from = 0; i < count; i++) {
    if (from + 46 > list.byteLength || list.getUint32(from, true) !== ENTRY) throw damaged("its list of files ends too early");
    const word = (at) => list.getUint16(from + at, true);
    const long = (at) => list.getUint32(from + at, true);
    const [flags, method, packed, unpacked, local] = [word(8), word(10), long(20), long(24), long(42)];
    const next = from + 46 + word(28) + word(30) + word(32);
    if (next > list.byteLength) throw damaged("its list of files ends too early");
    const path = named(new Uint8Array(list.buffer, from + 46, word(28))).replaceAll("\\", "/").replace(/^(\.?\/)+/, "");
    from = next;
    if (path === "" || path.endsWith("/")) continue;
    if (flags & ENCRYPTED) throw new Error(`${path} in ${archive.name} is encrypted: pack it without a password.`);
    if (!(method in METHODS)) throw new Error(`${path} in ${archive.name} is packed by method ${method}; this page reads stored and deflated files. Pack the folder again.`);
    found.push({ path, size: unpacked, read: () => unpack(archive, { path, method, packed, unpacked, local }, damaged) });
  }
  return found;
}

// Returns a name: UTF-8, as most programs write it, or else Latin-1.
function named(bytes) {
  try {
    return new TextDecoder("utf-8", { fatal: true }).decode(bytes);
  } catch {
    return new TextDecoder("latin1").decode(bytes);
  }
}

// Returns the bytes of a file: as many as the list says, or an error.
async function unpack(archive, { path, method, packed, unpacked, local }, damaged) {
  const head = await view(archive, local, local + 30);
  if (head.byteLength < 30) throw damaged(`${path} lies outside of it`);
  const from = local + 30 + head.getUint16(26, true) + head.getUint16(28, true);
  const data = archive.slice(from, from + packed);
  if (data.size !== packed) throw damaged(`${path} lies outside of it`);
  if (method === 0) {
    if (packed !== unpacked) throw damaged(`${path} has two sizes`);
    return new Uint8Array(await data.arrayBuffer());
  }
  const bytes = new Uint8Array(unpacked);
  const reader = data.stream().pipeThrough(new DecompressionStream("deflate-raw")).getReader();
  let length = 0;
  for (;;) {
    const { done, value } = await reader.read().catch(() => {
      throw damaged(`${path} cannot be inflated`);
    });
    if (done) break;
    if (length + value.length > unpacked) {
      reader.cancel().catch(() => {});
      throw damaged(`${path} has more than the ${unpacked} bytes that its list says`);
    }
    bytes.set(value, length);
    length += value.length;
  }
  if (length !== unpacked) throw damaged(`${path} has ${length} bytes, not the ${unpacked} that its list says`);
  return bytes;
}
