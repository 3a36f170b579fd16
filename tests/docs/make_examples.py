"""Write the example files that programs make: ``python tests/docs/make_examples.py FOLDER``."""

from __future__ import annotations

import math
import sys
from pathlib import Path


def arch(path: Path, stones: int = 14, inner: float = 4.2, outer: float = 5.0) -> None:
    """A semicircular arch of stones on two supports, as an Assembly of COMPAS [m]."""
    import compas
    from compas_assembly.datastructures import Assembly, Block

    def block(name: str, corners: list[list[float]]) -> Block:
        faces = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
        made = Block.from_vertices_and_faces(corners, faces)
        made.name = name
        return made

    assembly = Assembly(name="arch")
    middle = (inner + outer) / 2
    for k in range(stones):
        angles = [math.pi * step / stones for step in (k, k + 1)]
        corners = [
            [round(r * math.cos(t), 6), y, round(r * math.sin(t), 6)]
            for y in (-0.5, 0.5)
            for t in angles
            for r in (inner, outer)
        ]
        assembly.add_block(block(f"stone-{k + 1}", corners), node=k)
    for k, (name, x) in enumerate((("support-right", middle), ("support-left", -middle))):
        corners = [
            [round(x + dx, 6), y, z] for y in (-0.5, 0.5) for z in (0.0, -0.5) for dx in (-0.8, 0.8)
        ]
        assembly.add_block(block(name, corners), node=stones + k)
        assembly.graph.node_attribute(stones + k, "is_support", True)
    compas.json_dump(assembly, path)


def stand(path: Path) -> None:
    """A plant stand as a FreeCAD document [mm]: foot, post, and a board that reaches too far."""
    from freecad_maker import Maker, at
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox

    maker = Maker()
    for name, size, corner in (
        ("foot", (200, 200, 20), (-100, -100, 0)),
        ("post", (40, 40, 300), (-20, -20, 20)),
        ("board", (400, 300, 18), (-140, -150, 320)),
        ("pot", (120, 120, 110), (100, -60, 338)),
    ):
        solid = BRepPrimAPI_MakeBox(*map(float, size)).Shape()
        maker.add("Part::Feature", name, maker.shape(solid, at(*corner)))
    maker.write(path)


if __name__ == "__main__":
    sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "files"))
    folder = Path(sys.argv[1])
    arch(folder / "arch-compas.json")
    stand(folder / "stand.FCStd")
