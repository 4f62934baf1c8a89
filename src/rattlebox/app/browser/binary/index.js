// Reads the bodies of rattlebox.app.binary: a JSON header and arrays of float32.
let last = {};

// Return a body; charts and animation of one run share it.
export function fetchBody(url) {
  if (last.url !== url || url.includes("?")) last = { url, body: read(url) };
  return last.body;
}

async function read(url) {
  const response = await fetch(url);
  if (!response.ok) throw new Error(`${url}: ${response.status}`);
  const buffer = await response.arrayBuffer();
  const size = new DataView(buffer).getUint32(0, true);
  const about = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 4, size)));
  const arrays = {};
  for (const [name, { offset, shape }] of Object.entries(about.arrays)) {
    const count = shape.reduce((product, side) => product * side, 1);
    arrays[name] = new Float32Array(buffer, 4 + size + 4 * offset, count);
  }
  return { arrays, shapes: Object.fromEntries(Object.entries(about.arrays).map(([name, entry]) => [name, entry.shape])), about };
}
