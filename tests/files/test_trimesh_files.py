"""PLY and COLLADA files, which trimesh reads, and OFF files."""

from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest
import trimesh

from kilter.errors import InputError
from kilter.loading import load


def pair() -> trimesh.Trimesh:
    """Two bodies in one mesh."""
    upper = trimesh.creation.box((1, 1, 1))
    upper.apply_translation([0, 0, 1.5])
    return trimesh.util.concatenate([trimesh.creation.box((3, 3, 2)), upper])


@pytest.mark.parametrize(
    ("ending", "more"), [("ply", {"encoding": "ascii"}), ("ply", {}), ("off", {})]
)
def test_the_bodies_of_a_mesh_are_parts(ending, more, tmp_path):
    path = tmp_path / f"pile.{ending}"
    pair().export(path, **more)
    assembly = load(path)
    assert assembly.names == ("pile_1", "pile_2")
    assert sorted(assembly.geometry.volume) == pytest.approx([1, 18])
    assert load(path, units="mm").units == "mm"


def off(points: list[tuple[float, float]]) -> str:
    """A prism over a polygon."""
    n = len(points)
    rows = [f"{x} {y} {z}" for z in (0, 1) for x, y in points]
    faces = [
        [*range(n - 1, -1, -1)],
        [*range(n, 2 * n)],
        *([k, (k + 1) % n, n + (k + 1) % n, n + k] for k in range(n)),
    ]
    lines = [f"{len(face)} {' '.join(map(str, face))}" for face in faces]
    return "\n".join(["OFF", f"{2 * n} {n + 2} 0", *rows, *lines])


def test_polygons_of_off_are_cut(tmp_path):
    path = tmp_path / "a.off"
    angles = np.arange(6) * np.pi / 3
    path.write_text(off([(np.cos(a), np.sin(a)) for a in angles.tolist()]))
    assert load(path).geometry.volume == pytest.approx([1.5 * 3**0.5])
    path.write_text(off([(4, 1), (1, 1), (1, 4), (0, 4), (0, 0), (4, 0)]))
    assembly = load(path)
    assert assembly.geometry.volume == pytest.approx([7])
    vertices, triangles = assembly.parts[0].shape.vertices, assembly.parts[0].shape.triangles
    p, q, r = (vertices[triangles[:, k]] for k in range(3))
    area = np.linalg.norm(np.cross(q - p, r - p), axis=1).sum() / 2
    assert area == pytest.approx(2 * 7 + 16)


def test_a_folded_polygon_of_ply_is_rejected(tmp_path):
    """The second polygon of a prism over a dart is cut outside of the dart."""
    path = tmp_path / "a.ply"
    dart = [(0, 0), (4, -1), (1, 0), (4, 1)]
    rows = [f"{x} {y} {z}" for z in (0, 1) for x, y in dart]
    faces = [
        "4 1 2 3 0",
        "4 7 6 5 4",
        *(f"4 {(k + 1) % 4} {k} {4 + k} {4 + (k + 1) % 4}" for k in range(4)),
    ]
    head = ["ply", "format ascii 1.0", "element vertex 8", *(f"property float {a}" for a in "xyz")]
    head += ["element face 6", "property list uchar int vertex_indices", "end_header"]
    path.write_text("\n".join([*head, *rows, *faces, ""]))
    with pytest.raises(InputError, match="not convex, or two triangles"):
        load(path)


DAE = """<?xml version="1.0" encoding="utf-8"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
  <asset>{unit}<up_axis>Z_UP</up_axis></asset>
  <library_geometries><geometry id="g" name="g"><mesh>
    <source id="p"><float_array id="pa" count="12">0 0 0 6 0 0 0 6 0 0 0 6</float_array>
      <technique_common><accessor source="#pa" count="4" stride="3">
        <param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/>
      </accessor></technique_common></source>
    <vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
    <triangles count="4"><input semantic="VERTEX" source="#v" offset="0"/>
      <p>0 2 1 0 1 3 1 2 3 2 0 3</p></triangles>
  </mesh></geometry></library_geometries>
  <library_nodes>{library}</library_nodes>
  <library_visual_scenes><visual_scene id="s">{nodes}</visual_scene></library_visual_scenes>
  <scene><instance_visual_scene url="#s"/></scene>
</COLLADA>"""
NODE = (
    '<node id="{0}" name="{0}"><translate>{1} 0 0</translate><instance_geometry url="#g"/></node>'
)


def write_dae(path: Path, unit: str = "", nodes: str = "", library: str = "") -> Path:
    nodes = nodes or NODE.format("low", 0) + NODE.format("high", 10)
    path.write_text(DAE.format(unit=unit, nodes=nodes, library=library))
    return path


@pytest.mark.parametrize(
    ("unit", "units", "size"),
    [("", "m", 1), ('<unit meter="0.01"/>', "cm", 1), ('<unit meter="0.3048"/>', "m", 0.3048)],
)
def test_collada_has_the_parts_of_its_nodes(unit, units, size, tmp_path):
    pytest.importorskip("collada")
    assembly = load(write_dae(tmp_path / "a.dae", unit))
    assert assembly.units == units
    assert len(assembly) == 2
    assert assembly.geometry.volume == pytest.approx([36 * size**3] * 2)
    assert sorted(assembly.geometry.center[:, 0]) == pytest.approx([1.5 * size, 11.5 * size])


def test_collada_does_not_multiply_without_end(tmp_path):
    pytest.importorskip("collada")
    library = NODE.format("n0", 0)
    for k in range(1, 9):
        library += f'<node id="n{k}">' + f'<instance_node url="#n{k - 1}"/>' * 8 + "</node>"
    top = '<node id="x"><instance_node url="#n8"/></node>'
    path = write_dae(tmp_path / "a.dae", "", top, library)
    with pytest.raises(InputError, match="placed meshes; the limit is 50,000"):
        load(path)
    path = write_dae(path, "", '<node id="x"><instance_node url="#x"/></node>')
    with pytest.raises(InputError, match="nested deeper"):
        load(path)


@pytest.mark.quick(1)
@pytest.mark.parametrize("seed", range(10))
def test_damaged_files_are_rejected_or_read(seed, tmp_path):
    """200 files of each format."""
    rng = np.random.default_rng(seed)
    sources = {
        "a.ply": pair().export(file_type="ply", encoding="ascii"),
        "b.ply": pair().export(file_type="ply"),
        "c.off": pair().export(file_type="off").encode(),
    }
    if find_spec("collada"):
        sources["d.dae"] = write_dae(tmp_path / "whole.dae").read_bytes()
    for k in range(20):
        for name, whole in sources.items():
            path, data = tmp_path / f"{k}{name}", bytearray(whole)
            for _ in range(int(rng.integers(1, 4))):
                start = int(rng.integers(len(data)))
                data[start : start + int(rng.integers(1, 9))] = rng.bytes(int(rng.integers(5)))
            path.write_bytes(bytes(data))
            try:
                load(path)
            except InputError as error:
                message = str(error)
            else:
                message = f"{path}: "
            assert message.startswith(f"{path}: ")
