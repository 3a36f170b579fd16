// The ground under an assembly: a grid in whole lengths, and the soft shadow of the parts.

import { Color, GLSL3, LinearFilter, MaxEquation, Mesh, OneFactor, OrthographicCamera, PlaneGeometry, Quaternion, ShaderMaterial, Vector3, WebGLRenderTarget, CustomBlending } from "three";
import { shadow, vertex } from "./shaders.js";
import { scaled, unit } from "./vector.js";

const SIDE = 3.2; // half side of the ground [radius of the picture]
const PIXELS = 256; // of the shadow, in each direction
const ABOVE = 2e-3; // the ground lies above the floor by this much, to be seen [radius of the picture]
const LINES = 5; // least number of lines of the grid across the picture

export class Ground {
  /** `parts`: the parts that throw the shadow. */
  constructor(page, parts) {
    const { radius } = page;
    this.parts = parts;
    this.up = scaled(unit(page.given.down), -1);
    this.height = lowest(page, this.up);
    this.reach = 1.35 * radius;
    const target = () => new WebGLRenderTarget(PIXELS, PIXELS, { minFilter: LinearFilter, magFilter: LinearFilter, depthBuffer: false });
    [this.sharp, this.soft] = [target(), target()];
    const blurring = new ShaderMaterial({ glslVersion: GLSL3, vertexShader: WHOLE, fragmentShader: BLUR, uniforms: { shade: { value: this.sharp.texture } }, depthTest: false, depthWrite: false });
    this.blur = new Mesh(new PlaneGeometry(2, 2), blurring);
    this.blur.frustumCulled = false;
    this.step = roundStep((2 * radius) / LINES);
    this.material = new ShaderMaterial({
      glslVersion: GLSL3,
      vertexShader: PLACE,
      fragmentShader: FACE,
      transparent: true,
      depthWrite: false,
      uniforms: {
        shade: { value: this.soft.texture },
        reach: { value: this.reach },
        step: { value: this.step },
        side: { value: SIDE * radius },
        ink: { value: new Color() },
      },
    });
    this.throwing = new ShaderMaterial({
      glslVersion: GLSL3,
      vertexShader: vertex,
      fragmentShader: shadow,
      uniforms: { ...parts.shared, up: { value: new Vector3(...this.up) }, base: { value: this.height }, range: { value: radius } },
      depthTest: false,
      depthWrite: false,
      transparent: true,
      blending: CustomBlending,
      blendEquation: MaxEquation,
      blendSrc: OneFactor,
      blendDst: OneFactor,
    });
    this.mesh = new Mesh(new PlaneGeometry(2 * SIDE * radius, 2 * SIDE * radius), this.material);
    this.mesh.quaternion.copy(new Quaternion().setFromUnitVectors(new Vector3(0, 0, 1), new Vector3(...this.up)));
    this.mesh.position.set(...scaled(this.up, this.height + ABOVE * radius));
    this.planar = page.planar;
    this.mesh.renderOrder = -4;
    this.camera = new OrthographicCamera(-this.reach, this.reach, this.reach, -this.reach, -8 * radius, 8 * radius);
    this.drawn = -1;
  }

  /** Draw the shadow anew if the parts have changed; `plain`: without ground, for quick pictures. */
  shade(renderer, plain) {
    const { parts } = this;
    this.mesh.visible = !plain && !this.planar;
    if (!this.mesh.visible || this.drawn === parts.texture.version) return;
    this.drawn = parts.texture.version;
    const { material } = parts.faces;
    const { matrixWorld, parent } = parts.faces;
    // in the frame of the assembly: the camera looks down along gravity
    this.camera.quaternion.copy(this.mesh.quaternion);
    this.camera.position.set(0, 0, 0);
    this.camera.updateMatrixWorld();
    const into = renderer.getRenderTarget(); // of the picture that is being drawn
    const world = matrixWorld.clone();
    matrixWorld.identity();
    parts.faces.matrixWorldAutoUpdate = false;
    parts.faces.material = this.throwing;
    parts.faces.parent = null;
    renderer.setRenderTarget(this.sharp);
    renderer.clear();
    renderer.render(parts.faces, this.camera);
    renderer.setRenderTarget(this.soft);
    renderer.render(this.blur, this.camera);
    renderer.setRenderTarget(into);
    parts.faces.parent = parent;
    parts.faces.material = material;
    parts.faces.matrixWorldAutoUpdate = true;
    matrixWorld.copy(world);
  }

  theme(style) {
    this.material.uniforms.ink.value.set(style("ink"));
  }

  dispose() {
    for (const each of [this.sharp, this.soft, this.material, this.blur.material, this.blur.geometry]) each.dispose();
    this.throwing.dispose();
    this.mesh.geometry.dispose();
  }
}

/** Height of the lowest free or held part, without tables, along `up`; that of the page without parts. */
function lowest({ parts, shapes, extent }, up) {
  let least = Infinity;
  parts.shape.forEach((which, k) => {
    if (parts.table?.[k]) return;
    const [w, x, y, z] = parts.rotation.subarray(4 * k, 4 * k + 4);
    const turn = new Quaternion(x, y, z, w).invert();
    const along = new Vector3(...up).applyQuaternion(turn);
    const base = up.reduce((sum, c, i) => sum + c * parts.position[3 * k + i], 0);
    const { positions } = shapes[which];
    for (let i = 0; i < positions.length; i += 3) {
      const height = base + along.x * positions[i] + along.y * positions[i + 1] + along.z * positions[i + 2];
      if (height < least) least = height;
    }
  });
  return Number.isFinite(least) ? least : -Math.hypot(...extent);
}

/** The largest of 1, 2, 5, 10, 20 ... that is at most a length. */
function roundStep(length) {
  const ten = 10 ** Math.floor(Math.log10(length));
  return ten * ([5, 2, 1].find((k) => k * ten <= length) ?? 1);
}

const PLACE = `
out vec2 at;
void main() {
  at = position.xy;
  gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
}
`;

const FACE = `precision highp float;
uniform sampler2D shade;
uniform float reach;
uniform float step;
uniform float side;
uniform vec3 ink;
in vec2 at;
out vec4 result;

float line(vec2 p, float every) {
  vec2 q = abs(fract(p / every - 0.5) - 0.5) / fwidth(p / every);
  return 1.0 - min(min(q.x, q.y), 1.0);
}

void main() {
  float fade = 1.0 - smoothstep(0.35, 0.95, length(at) / side);
  if (fade <= 0.0) discard;
  float grid = max(0.16 * line(at, step), 0.3 * line(at, 5.0 * step)) * fade;
  vec2 uv = 0.5 + 0.5 * at / reach;
  bool inside = all(greaterThan(uv, vec2(0.0))) && all(lessThan(uv, vec2(1.0)));
  float dark = inside ? 0.42 * texture(shade, uv).r : 0.0;
  // the shadow darkens, the lines have the colour of the ink
  result = vec4(ink * grid / max(grid + dark, 1e-4), min(0.75, grid + dark));
}
`;

const WHOLE = `
out vec2 spot;
void main() {
  spot = 0.5 + 0.5 * position.xy;
  gl_Position = vec4(position.xy, 0.0, 1.0);
}
`;

const BLUR = `precision highp float;
uniform sampler2D shade;
in vec2 spot;
out vec4 result;
void main() {
  float dark = 0.0;
  float whole = 0.0;
  for (int i = -3; i <= 3; i++) {
    for (int j = -3; j <= 3; j++) {
      float weight = exp(-0.16 * float(i * i + j * j));
      dark += weight * texture(shade, spot + vec2(float(i), float(j)) * 0.011).r;
      whole += weight;
    }
  }
  result = vec4(dark / whole, 0.0, 0.0, 1.0);
}
`;
