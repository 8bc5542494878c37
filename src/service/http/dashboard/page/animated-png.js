// Puts PNG pictures of one size together to an animated PNG, which browsers play like any picture.

const SIGNATURE = [137, 80, 78, 71, 13, 10, 26, 10];

/** The checksum of chunks (CRC-32), by a table for each byte. */
const TABLE = Uint32Array.from({ length: 256 }, (_, byte) => {
  let value = byte;
  for (let bit = 0; bit < 8; bit++) value = value & 1 ? (value >>> 1) ^ 0xedb88320 : value >>> 1;
  return value;
});

function checksum(bytes) {
  let sum = 0xffffffff;
  for (const byte of bytes) sum = TABLE[(sum ^ byte) & 255] ^ (sum >>> 8);
  return (sum ^ 0xffffffff) >>> 0;
}

function number(...values) {
  const bytes = new Uint8Array(4 * values.length);
  const view = new DataView(bytes.buffer);
  values.forEach((value, place) => view.setUint32(4 * place, value));
  return bytes;
}

function joined(...parts) {
  const all = new Uint8Array(parts.reduce((sum, part) => sum + part.length, 0));
  let at = 0;
  for (const part of parts) {
    all.set(part, at);
    at += part.length;
  }
  return all;
}

function chunk(kind, ...parts) {
  const named = joined(new TextEncoder().encode(kind), ...parts);
  return joined(number(named.length - 4), named, number(checksum(named)));
}

/** The chunks of a PNG, as `[kind, bytes]`. */
function chunks(png) {
  const view = new DataView(png.buffer, png.byteOffset, png.byteLength);
  const found = [];
  for (let at = SIGNATURE.length; at < png.length;) {
    const length = view.getUint32(at);
    found.push([String.fromCharCode(...png.subarray(at + 4, at + 8)), png.subarray(at + 8, at + 8 + length)]);
    at += length + 12;
  }
  return found;
}

/** `pictures`: PNGs as bytes; `milliseconds`: for which each is shown. Answers the bytes of the animation. */
export function animatedPng(pictures, milliseconds) {
  const frames = pictures.map(chunks);
  const [[, header]] = frames[0];
  const [width, height] = [0, 4].map((at) => new DataView(header.buffer, header.byteOffset).getUint32(at));
  const parts = [
    Uint8Array.from(SIGNATURE), chunk("IHDR", header), chunk("acTL", number(frames.length, 0)),
  ];
  let order = 0;
  frames.forEach((frame, place) => {
    const [[, own]] = frame;
    if (own.some((byte, at) => byte !== header[at])) throw new Error("the browser makes pictures of different kinds");
    // The time is a fraction of two numbers of two bytes; two bytes more say that each picture replaces the one before.
    const time = Uint8Array.from([milliseconds >> 8, milliseconds & 255, 1000 >> 8, 1000 & 255, 0, 0]);
    parts.push(chunk("fcTL", number(order++, width, height, 0, 0), time));
    for (const [kind, bytes] of frame) {
      if (kind !== "IDAT") continue;
      parts.push(place === 0 ? chunk("IDAT", bytes) : chunk("fdAT", number(order++), bytes));
    }
  });
  return joined(...parts, chunk("IEND"));
}
