"""Does kilter work on this machine? What `kilter doctor` looks at.

Each look asks for something whose answer is known: a program with a vertex that can be written
down, a scene of the paper, a ball of radius 1 in a STEP file. A look that fails says what
failed; the others are taken all the same. An extra that is not installed is no failure.
"""

from __future__ import annotations

import importlib
import importlib.metadata
import math
import os
import platform
import sys
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import kilter
from kilter import files
from kilter.show.serve import PageServer

__all__ = ["EXTRAS", "NEEDED", "Health", "Look", "doctor"]

State = Literal["works", "absent", "broken"]

NEEDED = (
    "numpy",
    "scipy",
    "manifold3d",
    "shapely",
    "highspy",
    "clarabel",
    "pydantic",
    "typer",
    "threadpoolctl",
)
"""Packages that kilter cannot do without."""
EXTRAS = {
    "step": ("OCP", "cadquery-ocp-novtk", "STEP files"),
    "figures": ("matplotlib", "matplotlib", "kilter draw"),
    "trimesh": ("trimesh", "trimesh", "objects of trimesh"),
    "compas": ("compas", "compas", "objects of COMPAS"),
    "build123d": ("build123d", "build123d", "objects of build123d"),
    "cadquery": ("cadquery", "cadquery", "objects of CadQuery"),
    "mujoco": ("mujoco", "mujoco", "MJCF and URDF files"),
    "batch": ("pyarrow", "pyarrow", "kilter batch: Parquet"),
    "cluster": ("distributed", "distributed", "kilter batch --cluster"),
}
"""Of each extra: what is imported, the package that brings it, what it is for."""
EXACT = 1e-9
"""How near a solver comes to a vertex that is known, and OCCT to a volume, over its size."""
CONIC_EXACT = 1e-6
"""The same of an interior point, which ends inside."""
METHODS: dict[Literal["simplex", "interior"], float] = {"simplex": EXACT, "interior": CONIC_EXACT}
BALL = """ISO-10303-21;
HEADER;
FILE_DESCRIPTION((''),'2;1');
FILE_NAME('','',(''),(''),'','','');
FILE_SCHEMA(('AUTOMOTIVE_DESIGN'));
ENDSEC;
DATA;
#1=APPLICATION_CONTEXT('');
#2=PRODUCT_CONTEXT('',#1,'mechanical');
#3=PRODUCT('ball','ball','',(#2));
#4=PRODUCT_DEFINITION_FORMATION('','',#3);
#5=PRODUCT_DEFINITION_CONTEXT('part definition',#1,'design');
#6=PRODUCT_DEFINITION('design','',#4,#5);
#7=PRODUCT_DEFINITION_SHAPE('','',#6);
#8=SHAPE_DEFINITION_REPRESENTATION(#7,#9);
#9=ADVANCED_BREP_SHAPE_REPRESENTATION('',(#10,#14),#20);
#10=AXIS2_PLACEMENT_3D('',#11,#12,#13);
#11=CARTESIAN_POINT('',(0.,0.,0.));
#12=DIRECTION('',(0.,0.,1.));
#13=DIRECTION('',(1.,0.,0.));
#14=MANIFOLD_SOLID_BREP('ball',#15);
#15=CLOSED_SHELL('',(#16));
#16=ADVANCED_FACE('',(#17),#19,.T.);
#17=FACE_BOUND('',#18,.T.);
#18=VERTEX_LOOP('',#25);
#19=SPHERICAL_SURFACE('',#10,1.);
#20=(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT((#24))
GLOBAL_UNIT_ASSIGNED_CONTEXT((#21,#22,#23))REPRESENTATION_CONTEXT('',''));
#21=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT($,.METRE.));
#22=(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.));
#23=(NAMED_UNIT(*)SI_UNIT($,.STERADIAN.)SOLID_ANGLE_UNIT());
#24=UNCERTAINTY_MEASURE_WITH_UNIT(LENGTH_MEASURE(1.E-7),#21,'distance_accuracy_value','');
#25=VERTEX_POINT('',#26);
#26=CARTESIAN_POINT('',(0.,0.,1.));
ENDSEC;
END-ISO-10303-21;
"""
"""A solid of one face: the sphere of radius 1 m."""


@dataclass(frozen=True, slots=True)
class Look:
    """What was looked at, how it is, what was found, and what to do about it."""

    name: str
    state: State
    found: str
    remedy: str = ""


@dataclass(frozen=True, slots=True)
class Health:
    """What `doctor` found.

    Attributes
    ----------
    looks : tuple of Look
    """

    looks: tuple[Look, ...]

    @property
    def works(self) -> bool:
        """Whether nothing that is installed is broken."""
        return all(look.state != "broken" for look in self.looks)

    def to_dict(self) -> dict[str, Any]:
        """Every look as data."""
        keys = ("name", "state", "found", "remedy")
        looks = [{key: getattr(look, key) for key in keys} for look in self.looks]
        return {"kind": "doctor", "kilter": kilter.__version__, "works": self.works, "looks": looks}


class _Wrong(Exception):
    """An answer that is not the known one."""


def doctor() -> Health:
    """Look whether what kilter needs is there and answers what is known.

    Versions, the solvers, a verdict with its proof, the readers and libraries of extras, a page
    served on this machine, files in the folder for temporary ones, the terminal. Nothing is
    asked of a network. It takes about two seconds.

    Examples
    --------
    >>> health = doctor()
    >>> health.works, health.looks[0].name
    (True, 'kilter')
    """
    looks = [_look("kilter", _versions), _look("packages", _packages)]
    looks += [_look(name, ask) for name, ask in _ASKED.items()]
    looks += [_extra(name) for name in EXTRAS]
    return Health((*looks, _look("terminal", _terminal)))


def _look(name: str, ask: Callable[[], str], remedy: str = "") -> Look:
    """What a look found; whatever goes wrong in it is what was found."""
    try:
        return Look(name, "works", ask())
    except Exception as error:
        said = " ".join(str(error).split())[:200]
        found = said if isinstance(error, _Wrong) else f"{type(error).__name__}: {said}"
        return Look(name, "broken", found, remedy or "install kilter again: pip install kilter")


def _versions() -> str:
    cores = os.cpu_count()
    return (
        f"{kilter.__version__}, Python {platform.python_version()}, {platform.system()} "
        f"{platform.machine()}, {cores} cores"
    )


def _packages() -> str:
    missing = []
    for name in NEEDED:
        try:
            importlib.import_module(name)
        except Exception as error:
            missing.append(f"{name} ({error})")
    if missing:
        raise _Wrong("cannot be imported: " + ", ".join(missing))
    return ", ".join(f"{name} {importlib.metadata.version(name)}" for name in NEEDED)


def _highs() -> str:
    """The greatest x + y under x + 2 y <= 4 and 3 x + y <= 6 lies at (1.6, 1.2); none above 9."""
    import numpy as np
    from scipy.sparse import csc_array

    from kilter.solvers.highs import solve_linear
    from kilter.solvers.problem import LinearProgram

    def program(least: float) -> LinearProgram:
        none, rows = np.full(2, np.inf), csc_array([[1.0, 2.0], [3.0, 1.0], [1.0, 1.0]])
        sides = np.array([4.0, 6.0, np.inf])
        lower = np.array([-np.inf, -np.inf, least])
        return LinearProgram(-np.ones(2), rows, lower, sides, np.zeros(2), none)

    for method, near in METHODS.items():
        found = solve_linear(program(0.0), method=method)
        none = solve_linear(program(9.0), method=method)
        if found.outcome != "optimal" or np.abs(found.x - [1.6, 1.2]).max() > near:
            raise _Wrong(f"{method}: a vertex at (1.6, 1.2) is {found.outcome}: {found.x}")
        if none.outcome != "infeasible":
            raise _Wrong(f"{method}: a program without a point is {none.outcome}")
    return "finds a known vertex, and that there is none"


def _clarabel() -> str:
    """The least x + y on the disk of radius 1 lies at -(1, 1) / sqrt(2)."""
    import numpy as np
    from scipy.sparse import csc_array

    from kilter.solvers.clarabel import solve_conic
    from kilter.solvers.problem import ConicProgram

    matrix = csc_array([[0.0, 0.0], [-1.0, 0.0], [0.0, -1.0]])
    bound, cones = np.array([1.0, 0.0, 0.0]), np.array([3])
    disk = ConicProgram(csc_array((2, 2)), np.ones(2), matrix, bound, 0, 0, cones)
    found = solve_conic(disk)
    if found.outcome != "optimal" or np.abs(found.x + math.sqrt(0.5)).max() > CONIC_EXACT:
        raise _Wrong(f"the least sum of a disk is {found.outcome}: {found.x}")
    return "finds a known point of a cone"


def _verdicts() -> str:
    """Scenes whose answers are known, through the proof of each."""
    from kilter.analysis.check import check
    from kilter.scenes import SCENES, scene

    names = ("tower", "paper-figure-8", "arch")
    for name in names:
        verdict = check(scene(name))
        if verdict.verdict not in {SCENES[name].answer, "settles"}:
            raise _Wrong(f"{name!r} is {SCENES[name].answer}, and is said to be {verdict.verdict}")
        with tempfile.TemporaryDirectory() as folder:
            _verified(Path(folder), name, verdict.proof())
    return f"{len(names)} examples have their known answers; their proofs hold"


def _verified(folder: Path, name: str, proof: dict[str, Any]) -> None:
    import json

    from kilter.analysis.verification import verify
    from kilter.scenes import scene

    files.dump(scene(name), folder / "a.kilter.json")
    files.write_text(folder / "proof.json", json.dumps(proof))
    result = verify(folder / "a.kilter.json", folder / "proof.json")
    if not result.holds:
        raise _Wrong(f"the proof of {name!r} does not hold: {result.reasons[0]}")


def _page() -> str:
    """A page written to a file, and another served to this machine."""
    import urllib.request
    import webbrowser

    from kilter.analysis.everything import everything
    from kilter.scenes import scene
    from kilter.show.page import render

    html = render(everything(scene("tower")), "tower")
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "page.html"
        files.write_text(path, html)
        if path.read_bytes().decode("utf-8") != html:
            raise _Wrong("a page that is written is not what is read again")
    direct = urllib.request.build_opener(urllib.request.ProxyHandler({}))
    with PageServer(html) as server, direct.open(server.url, timeout=10) as answer:
        if answer.read().decode("utf-8") != html:
            raise _Wrong("a page that is served is not what arrives")
    try:
        webbrowser.get()
    except webbrowser.Error:
        return "written and served; no browser is known here: kilter view --no-browser"
    return "written and served"


_ASKED: dict[str, Callable[[], str]] = {
    "HiGHS": _highs,
    "Clarabel": _clarabel,
    "verdicts": _verdicts,
    "page": _page,
}


def _extra(name: str) -> Look:
    """An extra: its version, or how it is installed."""
    module, package, purpose = EXTRAS[name]
    install = f"pip install 'kilter[{name}]'"
    if importlib.util.find_spec(module) is None:
        return Look(name, "absent", purpose, install)
    return _look(name, lambda: f"{purpose}: {_works(name, module, package)}", install)


def _works(name: str, module: str, package: str) -> str:
    if name == "step":
        _ball()
    else:
        importlib.import_module(module)
    try:
        said = f"{package} {importlib.metadata.version(package)}"
    except importlib.metadata.PackageNotFoundError:
        said = f"{module}, brought by another package"
    return said + (", reads a built-in solid" if name == "step" else "")


def _ball() -> None:
    """The volume of a ball of radius 1, out of a STEP file."""
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "ball.step").write_text(BALL, encoding="ascii")
        [volume] = files.load(str(Path(folder) / "ball.step")).geometry.volume.tolist()
    if abs(volume - 4 / 3 * math.pi) > EXACT * volume:
        raise _Wrong(f"the ball of radius 1 has a volume of {volume:.9g}, not 4/3 pi")


def _terminal() -> str:
    """What answers are printed on."""
    stream = sys.stdout
    kind = "a terminal" if stream is not None and stream.isatty() else "no terminal"
    encoding = (getattr(stream, "encoding", None) or "utf-8").lower()
    colour = "NO_COLOR" if os.environ.get("NO_COLOR") else os.environ.get("TERM", "no TERM")
    return f"{kind}, {encoding}, {colour}"
