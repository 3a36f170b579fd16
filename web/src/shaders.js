// Shaders. All parts are one mesh. A texture holds the quaternion, position, colour and state of each
// part in four texels, so that one call draws, moves and hides a thousand parts.

export const TEXELS = 4;

const PLACE = `
uniform highp sampler2D parts;
uniform int across;
in float part;
flat out vec4 colour;
flat out vec4 state;
out vec3 root;
out vec3 seen;

vec4 texel(int row) {
  int k = int(part + 0.5) * ${TEXELS} + row;
  return texelFetch(parts, ivec2(k % across, k / across), 0);
}

void place() {
  vec4 q = texel(0);
  vec3 twice = 2.0 * cross(q.xyz, position);
  root = position + q.w * twice + cross(q.xyz, twice) + texel(1).xyz;
  colour = texel(2);
  state = texel(3);
  vec4 view = modelViewMatrix * vec4(root, 1.0);
  seen = view.xyz;
  gl_Position = projectionMatrix * view;
  if (state.x < 0.5) gl_Position = vec4(0.0, 0.0, 2.0, 1.0); // hidden: moved out of the view
}
`;

const CUT = `
uniform vec4 planes[3];
uniform bool cutting;
in vec3 root;
// a plane without a normal cuts nothing
bool cutAway() {
  if (cutting) for (int k = 0; k < 3; k++) if (dot(planes[k].xyz, root) > planes[k].w) return true;
  return false;
}
`;

/** Where a line of sight enters the half spaces that are kept, and where it leaves them. */
const SIGHT = `${CUT}
uniform vec3 eye;
// the shares of the way from the eye to the root; without an entry the first is negative
vec2 kept(vec3 ray) {
  vec2 ends = vec2(-1.0, 1e9);
  for (int k = 0; k < 3; k++) {
    float rate = dot(planes[k].xyz, ray);
    float left = planes[k].w - dot(planes[k].xyz, eye);
    if (rate < 0.0) ends.x = max(ends.x, left / rate);
    if (rate > 0.0) ends.y = min(ends.y, left / rate);
  }
  return ends;
}
`;

export const vertex = `${PLACE}
void main() { place(); }
`;

export const face = `precision highp float;
${CUT}
uniform vec3 hatch;
uniform vec3 table;
uniform vec3 grip;
uniform vec3 picked;
uniform float opacity;
uniform bool veil;
uniform float dense;
flat in vec4 colour;
flat in vec4 state;
in vec3 seen;
out vec4 result;

float stripes(float width) {
  float t = (gl_FragCoord.x + gl_FragCoord.y) / (width * dense);
  return smoothstep(0.28, 0.34, abs(fract(t) - 0.5));
}

void main() {
  if (cutAway() || (state.w > 0.5) != veil) discard; // transparent parts have a pass of their own
  vec3 n = normalize(cross(dFdx(seen), dFdy(seen)));
  vec3 base = colour.rgb;
  if (state.y > 1.5) base = table;
  if (state.y > 0.5 && state.y < 1.5) base = mix(base, hatch, 0.6 * stripes(9.0)); // a table has a grid
  float key = max(dot(n, normalize(vec3(-0.35, 0.75, 0.55))), 0.0);
  float fill = max(dot(n, normalize(vec3(0.8, 0.1, 0.5))), 0.0);
  vec3 lit = min(base * (0.68 + 0.36 * key + 0.14 * fill), vec3(1.0));
  float marks = mod(state.z, 8.0);
  if (marks > 3.5) lit = mix(lit, grip, 0.18 + 0.62 * stripes(9.0));
  if (state.z > 7.5) lit = mix(lit, picked, 0.22);
  if (mod(marks, 2.0) > 0.5) lit = mix(lit, picked, 0.25 + 0.6 * stripes(7.0));
  result = vec4(lit, veil ? opacity : 1.0);
}
`;

/**
 * The face of the section. If the line of sight is inside a part at the plane (the stencil counts
 * one back face more than front faces beyond it), the nearest back face belongs to that part. It
 * is drawn half way between the plane and itself, nearest first, before everything behind it.
 */
export const cap = `precision highp float;
${SIGHT}
uniform highp mat4 projectionMatrix;
uniform highp mat4 modelViewMatrix;
uniform float dense;
flat in vec4 colour;
flat in vec4 state;
in vec3 seen;
out vec4 result;
void main() {
  vec3 ray = root - eye;
  vec2 ends = kept(ray);
  float t = ends.x;
  if (t <= 0.0 || t >= 1.0 || t >= ends.y) discard;
  vec4 at = projectionMatrix * modelViewMatrix * vec4(eye + t * ray, 1.0);
  float depth = 0.5 + 0.5 * at.z / at.w;
  gl_FragDepth = mix(depth, gl_FragCoord.z, 0.5);
  float stripe = smoothstep(0.36, 0.42, abs(fract((gl_FragCoord.x - gl_FragCoord.y) / (8.0 * dense)) - 0.5));
  result = vec4(colour.rgb * mix(0.92, 0.66, stripe), 1.0);
}
`;

/** Draws nothing; for counting faces in the stencil. */
export const nothing = `precision highp float;
${SIGHT}
out vec4 result;
void main() {
  if (kept(root - eye).x >= 1.0) discard; // before the line of sight enters
  result = vec4(0.0);
}
`;

export const edge = `precision highp float;
${CUT}
uniform vec3 ink;
uniform vec3 accent;
uniform vec3 grip;
uniform float strength;
flat in vec4 state;
out vec4 result;
void main() {
  if (cutAway()) discard;
  float marks = mod(state.z, 8.0);
  bool gripped = marks > 3.5;
  bool moves = marks > 1.5 && !gripped;
  result = vec4(gripped ? grip : moves ? accent : ink, gripped || moves ? 1.0 : strength * (state.w > 0.5 ? 0.5 : 1.0));
}
`;

export const flatColour = `precision highp float;
${CUT}
uniform vec3 ink;
uniform float strength;
out vec4 result;
void main() {
  if (cutAway()) discard;
  result = vec4(ink, strength);
}
`;

export const spot = `${PLACE}
uniform float dense;
void main() { place(); gl_PointSize = 7.0 * dense; }
`;

export const spotFace = `precision highp float;
${CUT}
uniform vec3 ink;
uniform float strength;
out vec4 result;
void main() {
  if (cutAway() || length(gl_PointCoord - 0.5) > 0.5) discard;
  result = vec4(ink, strength);
}
`;

export const number = `precision highp float;
${CUT}
uniform float count;
flat in vec4 colour;
flat in vec4 state;
out vec4 result;
void main() {
  if (cutAway()) discard;
  int k = int(colour.a + 0.5);
  result = vec4(float(k & 255), float((k >> 8) & 255), float((k >> 16) & 255), 255.0) / 255.0;
}
`;

export const arrow = `
in float tint;
out vec3 seen;
flat out float share;
void main() {
  share = tint;
  vec4 view = modelViewMatrix * instanceMatrix * vec4(position, 1.0);
  seen = view.xyz;
  gl_Position = projectionMatrix * view;
}
`;

export const arrowFace = `precision highp float;
uniform vec3 ink;
uniform vec3 full;
uniform bool plain;
in vec3 seen;
flat in float share;
out vec4 result;
void main() {
  vec3 n = normalize(cross(dFdx(seen), dFdy(seen)));
  float key = max(dot(n, normalize(vec3(-0.35, 0.75, 0.55))), 0.0);
  result = vec4(plain ? ink : mix(ink, full, share) * (0.8 + 0.3 * key), 1.0);
}
`;

/** The shadow of the parts on the ground: darker where they are near to it; tables throw none. */
export const shadow = `precision highp float;
uniform vec3 up;
uniform float base;
uniform float range;
flat in vec4 colour;
flat in vec4 state;
in vec3 root;
out vec4 result;
void main() {
  if (state.y > 1.5) discard;
  float near = 1.0 - clamp((dot(up, root) - base) / range, 0.0, 1.0);
  result = vec4(near * near, 0.0, 0.0, 1.0);
}
`;
