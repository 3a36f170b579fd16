// The data of the page: JSON with arrays in base64, the long ones compressed.

import { unzlibSync } from "fflate";
import { tailsOf } from "./tails.js";

const TYPES = {
  f4: Float32Array,
  f8: Float64Array,
  u1: Uint8Array,
  u2: Uint16Array,
  u4: Uint32Array,
};

/** A packed array as a typed array. */
export function unpack({ type, data, zlib }) {
  const text = atob(zlib ?? data);
  let bytes = new Uint8Array(text.length);
  for (let k = 0; k < text.length; k += 1) bytes[k] = text.charCodeAt(k);
  // slice: the buffer of the result may be longer than its bytes
  if (zlib) bytes = unzlibSync(bytes).slice();
  return new TYPES[type](bytes.buffer);
}

/** Data with every packed array unpacked, at any depth. */
export function unpacked(value) {
  if (Array.isArray(value)) return value.map(unpacked);
  if (value === null || typeof value !== "object") return value;
  if (typeof (value.zlib ?? value.data) === "string" && value.type in TYPES) return unpack(value);
  return Object.fromEntries(Object.entries(value).map(([k, v]) => [k, unpacked(v)]));
}

/** The data of this page; null if the page has no picture. */
export function pageData(text) {
  const data = unpacked(JSON.parse(text));
  if (data && data.parts) data.parts.tails = tailsOf(data.parts.names);
  return data;
}
