/** Value of a half-precision float (IEEE 754). */
function halfValue(bits) {
  const exponent = (bits >> 10) & 31;
  const size = exponent === 0 ? (bits & 1023) * 2 ** -24 : (1 + (bits & 1023) / 1024) * 2 ** (exponent - 15);
  return bits & 0x8000 ? -size : size;
}
let halfTable = null;

/** How the bytes at `at` are read, by type: [bytes per number, reader]. */
const arrayTypes = {
  int32: [4, (view, at, n) => Int32Array.from({ length: n }, (_, i) => view.getInt32(at + 4 * i, true))],
  float32: [4, (view, at, n) => Float32Array.from({ length: n }, (_, i) => view.getFloat32(at + 4 * i, true))],
  uint8: [1, (view, at, n) => Uint8Array.from({ length: n }, (_, i) => view.getUint8(at + i))],
  even: [2, (view, at, n, { low, step }) => {
    const numbers = new Float64Array(n);
    for (let i = 0; i < n; ++i) numbers[i] = low + step * (view.getUint8(at + i) + 256 * view.getUint8(at + n + i));
    return numbers;
  }],
  half: [2, (view, at, n, { scale }) => {
    halfTable ??= Float64Array.from({ length: 65536 }, (_, bits) => halfValue(bits));
    const numbers = new Float64Array(n);
    for (let i = 0; i < n; ++i) numbers[i] = scale * halfTable[view.getUint8(at + i) + 256 * view.getUint8(at + n + i)];
    return numbers;
  }],
};

/** The arrays of a script element of the page, by name. */
async function unpackArrays(id) {
  const packed = JSON.parse(byId(id).textContent);
  const letters = atob(packed.data);
  const bytes = new Uint8Array(letters.length);
  for (let i = 0; i < letters.length; ++i) bytes[i] = letters.charCodeAt(i);
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  const view = new DataView(await new Response(stream).arrayBuffer());
  const arrays = {};
  let at = 0;
  for (const each of packed.arrays) {
    const [size, read] = arrayTypes[each.type];
    arrays[each.name] = read(view, at, each.n, each);
    at += size * each.n;
  }
  return arrays;
}
