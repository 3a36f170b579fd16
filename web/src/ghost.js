// Bodies that are not part of the assembly, in one colour: the brick to add, or parts after a change.

import { BufferAttribute, BufferGeometry, Group, LineBasicMaterial, LineSegments, Mesh, MeshBasicMaterial } from "three";

const CLEAR = 0.35; // opacity of transparent faces [-]

export class Ghost {
  constructor() {
    this.faces = new Mesh(
      new BufferGeometry(),
      new MeshBasicMaterial({ polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1 }),
    );
    this.edges = new LineSegments(new BufferGeometry(), new LineBasicMaterial());
    this.group = new Group();
    this.group.add(this.faces, this.edges);
    this.group.visible = false;
  }

  /**
   * Set the shape, and the position of its middle in the frame of the assembly; `clear`: transparent,
   * with edges that the parts do not hide.
   */
  set({ positions, triangles, edges }, at, clear = false) {
    Object.assign(this.faces.material, { transparent: clear, opacity: clear ? CLEAR : 1, depthWrite: !clear });
    Object.assign(this.edges.material, { transparent: clear, depthTest: !clear });
    for (const { material } of [this.faces, this.edges]) material.needsUpdate = true;
    const vertices = new BufferAttribute(new Float32Array(positions), 3);
    for (const [mesh, index] of [[this.faces, triangles], [this.edges, edges]]) {
      mesh.geometry.setAttribute("position", vertices);
      mesh.geometry.setIndex(new BufferAttribute(Uint32Array.from(index), 1));
    }
    this.group.position.set(...at);
  }

  theme(style) {
    this.faces.material.color.set(style("picked"));
    this.edges.material.color.set(style("edge"));
  }
}
