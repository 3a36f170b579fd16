// The map of places on the stage: polygons at the height of the underside of the part, and the part.

import {
  BufferGeometry,
  DoubleSide,
  ExtrudeGeometry,
  EdgesGeometry,
  Group,
  LineBasicMaterial,
  LineSegments,
  Mesh,
  MeshBasicMaterial,
  Raycaster,
  Shape,
  ShapeGeometry,
  Vector2,
} from "three";

const COLOURS = { stands: "stable-fill", falls: "unstable-fill", open: "undecided-fill" };
const PART = { stands: "stable", falls: "unstable", open: "open" };
const LIFT = 2e-3; // height of the polygons above the tops, so that both do not flicker [radii of the picture]

export class PlaceLayer {
  constructor() {
    this.group = new Group();
    this.group.visible = false;
    this.areas = new Group();
    this.colours = {};
    this.materials = Object.fromEntries(
      Object.keys(COLOURS).map((name) => [name, new MeshBasicMaterial({ side: DoubleSide, transparent: true, opacity: 0.75 })]),
    );
    this.part = new Mesh(new BufferGeometry(), new MeshBasicMaterial({ transparent: true, opacity: 0.6 }));
    this.edges = new LineSegments(new BufferGeometry(), new LineBasicMaterial());
    this.part.add(this.edges);
    this.part.visible = false;
    this.group.add(this.areas, this.part);
    this.caster = new Raycaster();
  }

  /** Show the places of an answer and a part: {footprint, below, above}, for a picture with a middle. */
  set(levels, part, center, radius) {
    this.clear();
    Object.assign(this, { data: part, center });
    const lift = LIFT * radius;
    for (const level of levels) {
      for (const name of Object.keys(COLOURS)) {
        for (const polygon of level[name]) {
          const mesh = new Mesh(new ShapeGeometry(shapeOf(polygon)), this.materials[name]);
          mesh.position.set(-center[0], -center[1], level.height - part.below - center[2] + lift);
          this.areas.add(mesh);
        }
      }
    }
    const solid = new ExtrudeGeometry(shapeOf([part.footprint]), { depth: part.below + part.above, bevelEnabled: false });
    solid.translate(0, 0, -part.below);
    this.part.geometry = solid;
    this.edges.geometry = new EdgesGeometry(solid);
    this.group.visible = true;
  }

  clear() {
    this.areas.children.forEach(({ geometry }) => geometry.dispose());
    this.areas.clear();
    this.data = null;
    this.part.visible = false;
    this.group.visible = false;
  }

  /** Centre (x, y) of the place under a point of the canvas, -1 to 1; null beside the map. */
  under(x, y, camera) {
    if (!this.group.visible) return null;
    this.caster.setFromCamera(new Vector2(x, y), camera);
    const [hit] = this.caster.intersectObjects(this.areas.children);
    if (!hit) return null;
    const at = this.group.parent.worldToLocal(hit.point.clone());
    return [at.x + this.center[0], at.y + this.center[1]];
  }

  /** Put the part at a place, in the colour of its state; null hides it. */
  move(place, found) {
    this.part.visible = Boolean(place && found);
    if (!this.part.visible) return;
    const [x, y, z] = this.center;
    this.part.position.set(place[0] - x, place[1] - y, found.height - z);
    this.part.material.color.set(this.colours[PART[found.state]]);
  }

  theme(style) {
    for (const [name, role] of Object.entries(COLOURS)) this.materials[name].color.set(style(role));
    for (const role of Object.values(PART)) this.colours[role] = style(role);
    this.edges.material.color.set(style("edge"));
  }
}

function shapeOf([outline, ...holes]) {
  const points = (ring) => ring.map(([x, y]) => new Vector2(x, y));
  const shape = new Shape(points(outline));
  shape.holes = holes.map((hole) => new Shape(points(hole)));
  return shape;
}
