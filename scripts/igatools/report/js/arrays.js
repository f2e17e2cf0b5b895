// Arrays of the page: base64 of little-endian integers, with a scale where they stand for real numbers (arrays.py).

const NUMBERS = {int16: [2, 'getInt16'], uint16: [2, 'getUint16'], uint32: [4, 'getUint32']};

function unpack(array) {
  const text = atob(array.base64);
  const bytes = new Uint8Array(text.length);
  for (let k = 0; k < text.length; ++k) bytes[k] = text.charCodeAt(k);
  const [size, getter] = NUMBERS[array.kind];
  const view = new DataView(bytes.buffer);
  const count = bytes.length / size;
  if (array.scale === undefined) return Uint32Array.from({length: count}, (_, k) => view[getter](k * size, true));
  const values = new Float32Array(count);
  for (let k = 0; k < count; ++k) values[k] = array.scale * view[getter](k * size, true);
  return values;
}
