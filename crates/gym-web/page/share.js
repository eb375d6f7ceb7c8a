// The actions of an episode as text in an address: JSON, compressed with deflate, in URL-safe base64.

async function through(bytes, stream) {
  return new Uint8Array(await new Response(new Blob([bytes]).stream().pipeThrough(stream)).arrayBuffer());
}

export async function pack(actions) {
  const bytes = await through(new TextEncoder().encode(JSON.stringify(actions)), new CompressionStream("deflate-raw"));
  let text = "";
  for (const byte of bytes) text += String.fromCharCode(byte);
  return btoa(text).replaceAll("+", "-").replaceAll("/", "_").replaceAll("=", "");
}

export async function unpack(text) {
  try {
    const bytes = Uint8Array.from(atob(text.replaceAll("-", "+").replaceAll("_", "/")), (c) => c.charCodeAt(0));
    const actions = JSON.parse(new TextDecoder().decode(await through(bytes, new DecompressionStream("deflate-raw"))));
    if (Array.isArray(actions)) return actions;
  } catch { /* as any other text that is no episode */ }
  throw new Error("The actions in this link are damaged: ask for the link again.");
}
