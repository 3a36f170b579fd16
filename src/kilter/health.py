"""Self-test of the installation, for `kilter doctor`.

Each check solves a problem with a known answer: a linear program with a known vertex, a scene of
the paper, a ball of radius 1 in a STEP file. A check that fails reports the failure, and the other
checks still run. An extra that is not installed does not count as a failure.
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
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Literal

import kilter
from kilter import files

State = Literal["works", "absent", "broken"]

NEEDED = (
    "numpy",
    "scipy",
    "manifold3d",
    "shapely",
    "highspy",
    "clarabel",
    "pydantic",
    "threadpoolctl",
    "starlette",
    "uvicorn",
    "websockets",
)
"""Required packages."""
EXTRAS = {
    "step": ("OCP", "cadquery-ocp-novtk", "STEP files"),
    "figures": ("matplotlib", "matplotlib", "kilter draw"),
    "graph": ("networkx", "networkx", "ContactSet.graph"),
    "trimesh": ("trimesh", "trimesh", "objects of trimesh"),
    "meshes": ("collada", "pycollada", "PLY and COLLADA files"),
    "rhino": ("rhino3dm", "rhino3dm", "Rhino files"),
    "compas": ("compas", "compas", "objects of COMPAS"),
    "build123d": ("build123d", "build123d", "objects of build123d"),
    "cadquery": ("cadquery", "cadquery", "objects of CadQuery"),
    "mujoco": ("mujoco", "mujoco", "MJCF and URDF files"),
    "usd": ("pxr", "usd-core", "USD files"),
    "mcp": ("mcp", "mcp", "the server of kilter mcp"),
    "completion": ("shtab", "shtab", "kilter --print-completion"),
    "fast": ("numba", "numba", "kilter.check_many: compiled code"),
    "batch": ("pyarrow", "pyarrow", "kilter batch: Parquet"),
    "cluster": ("distributed", "distributed", "kilter batch --cluster"),
}
"""For each extra: the imported module, the package that contains it, and its purpose."""
EXACT = 1e-9
"""Tolerance for the known vertex [-], and relative tolerance for the volume that OCCT computes."""
CONIC_EXACT = 1e-6
"""Tolerance for interior-point solvers, which stop before the boundary [-]."""
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
    """Result of one check: its name, state and finding, and the remedy for a problem."""

    name: str
    state: State
    found: str
    remedy: str = ""


@dataclass(frozen=True, slots=True)
class Health:
    """Result of `doctor`: all checks of the installation.

    It is no record, since records need the packages that are checked.
    """

    looks: tuple[Look, ...]
    """Results of the single checks."""

    @property
    def works(self) -> bool:
        """Whether no installed component is broken."""
        return all(look.state != "broken" for look in self.looks)

    def to_dict(self) -> dict[str, Any]:
        """The results of all checks as JSON data."""
        return {"kind": "doctor", "kilter": kilter.__version__, "works": self.works,
                "looks": [asdict(look) for look in self.looks]}  # fmt: skip


class _WrongAnswer(Exception):
    """Error if a computed answer differs from the known answer."""


def doctor() -> Health:
    """Check whether kilter works on this machine: solvers, packages, verdicts and the page.

    The checks cover versions, solvers, verdicts with their proofs, the packages of extras, a page
    served on this machine, temporary files and the terminal. They use no network and take about
    two seconds.

    See Also
    --------
    kilter.example : an assembly to try kilter with.
    kilter.check : the verdict on an assembly.

    Examples
    --------
    >>> health = doctor()
    >>> health.works, health.looks[0].name
    (True, 'kilter')
    """
    looks = [_look("kilter", _versions), _look("packages", _packages)]
    looks += [_look(name, check) for name, check in _CHECKS.items()]
    looks += [_extra(name) for name in EXTRAS]
    return Health((*looks, _look("terminal", _terminal)))


def _look(name: str, check: Callable[[], str], remedy: str = "") -> Look:
    """Run a check and return its result; an exception means that the component is broken."""
    try:
        return Look(name, "works", check())
    except Exception as error:
        message = " ".join(str(error).split())[:200]
        finding = (
            message if isinstance(error, _WrongAnswer) else f"{type(error).__name__}: {message}"
        )
        return Look(name, "broken", finding, remedy or "install kilter again: pip install kilter")


def _versions() -> str:
    """Versions of kilter, Python and the system, and the number of cores."""
    cores = os.cpu_count()
    return (
        f"{kilter.__version__}, Python {platform.python_version()}, {platform.system()} "
        f"{platform.machine()}, {cores} cores"
    )


def _packages() -> str:
    """Versions of the required packages; raises an error if one cannot be imported."""
    missing = []
    for name in NEEDED:
        try:
            importlib.import_module(name)
        except Exception as error:
            missing.append(f"{name} ({error})")
    if missing:
        raise _WrongAnswer("cannot be imported: " + ", ".join(missing))
    return ", ".join(f"{name} {importlib.metadata.version(name)}" for name in NEEDED)


def _highs() -> str:
    """Check HiGHS: it must find a known vertex, and must detect an infeasible program.

    max x + y with x + 2 y <= 4, 3 x + y <= 6 is at (1.6, 1.2); x + y >= 9 is infeasible.
    """
    import numpy as np
    from scipy.sparse import csc_array

    from kilter.solvers.highs import solve_linear
    from kilter.solvers.problem import LinearProgram

    def program(least: float) -> LinearProgram:
        free, rows = np.full(2, np.inf), csc_array([[1.0, 2.0], [3.0, 1.0], [1.0, 1.0]])
        sides = np.array([4.0, 6.0, np.inf])
        lower = np.array([-np.inf, -np.inf, least])
        return LinearProgram(-np.ones(2), rows, lower, sides, np.zeros(2), free)

    for method, near in METHODS.items():
        vertex = solve_linear(program(0.0), method=method)
        infeasible = solve_linear(program(9.0), method=method)
        if vertex.outcome != "optimal" or np.abs(vertex.x - [1.6, 1.2]).max() > near:
            raise _WrongAnswer(
                f"{method}: the vertex is (1.6, 1.2), the solver returned "
                f"{vertex.outcome}: {vertex.x}"
            )
        if infeasible.outcome != "infeasible":
            raise _WrongAnswer(f"{method}: an infeasible program was {infeasible.outcome}")
    return "solves a linear program with a known vertex; detects an infeasible program"


def _clarabel() -> str:
    """Check Clarabel: it must find the known minimum of x + y on the disk of radius 1.

    The minimum is at -(1, 1) / sqrt(2).
    """
    import numpy as np
    from scipy.sparse import csc_array

    from kilter.solvers.clarabel import solve_conic
    from kilter.solvers.problem import ConicProgram

    matrix = csc_array([[0.0, 0.0], [-1.0, 0.0], [0.0, -1.0]])
    bound, cones = np.array([1.0, 0.0, 0.0]), np.array([3])
    disk = ConicProgram(csc_array((2, 2)), np.ones(2), matrix, bound, 0, 0, cones)
    solution = solve_conic(disk)
    if solution.outcome != "optimal" or np.abs(solution.x + math.sqrt(0.5)).max() > CONIC_EXACT:
        raise _WrongAnswer(
            f"the minimum on a disk is at -(1, 1) / sqrt(2), the solver returned "
            f"{solution.outcome}: {solution.x}"
        )
    return "solves a conic program with a known minimum"


def _verdicts() -> str:
    """Check the verdicts of built-in scenes with known answers, and verify their proofs."""
    from kilter.analysis.check import check
    from kilter.scenes import SCENES, scene

    names = ("tower", "paper-figure-8", "arch")
    for name in names:
        verdict = check(scene(name))
        if verdict.verdict not in {SCENES[name].answer, "settles"}:
            raise _WrongAnswer(
                f"{name!r} is {SCENES[name].answer}, but the verdict is {verdict.verdict}"
            )
        with tempfile.TemporaryDirectory() as folder:
            _verify_proof(Path(folder), name, verdict.proof())
    return f"{len(names)} examples have the known verdicts; their proofs hold"


def _verify_proof(folder: Path, name: str, proof: dict[str, Any]) -> None:
    """Write a scene and its proof to files, and verify them; an error if the proof fails."""
    import json

    from kilter.analysis.verification import verify
    from kilter.scenes import scene

    files.dump(scene(name), folder / "a.kilter.json")
    files.write_text(folder / "proof.json", json.dumps(proof))
    result = verify(folder / "a.kilter.json", folder / "proof.json")
    if not result.holds:
        raise _WrongAnswer(f"the proof of {name!r} does not hold: {result.reasons[0]}")


def _page() -> str:
    """Check that a page survives writing to a file and serving on this machine."""
    import webbrowser

    from kilter.analysis.everything import everything
    from kilter.scenes import scene
    from kilter.show.page import render

    html = render(everything(scene("tower")), "tower")
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "page.html"
        files.write_text(path, html)
        if path.read_bytes().decode("utf-8") != html:
            raise _WrongAnswer("a page changed when it was written to a file")
    try:
        webbrowser.get()
    except webbrowser.Error:
        return "can be written; no browser found: use kilter view --no-browser"
    return "can be written"


_CHECKS: dict[str, Callable[[], str]] = {
    "HiGHS": _highs,
    "Clarabel": _clarabel,
    "verdicts": _verdicts,
    "page": _page,
}


def _extra(name: str) -> Look:
    """Check an optional dependency: its version, or the command that installs it."""
    module, package, purpose = EXTRAS[name]
    install = f"pip install 'kilter[{name}]'"
    if importlib.util.find_spec(module) is None:
        return Look(name, "absent", purpose, install)
    return _look(name, lambda: f"{purpose}: {_try_extra(name, module, package)}", install)


def _try_extra(name: str, module: str, package: str) -> str:
    """Import an optional dependency and return its version; for STEP, also read a solid."""
    if name == "step":
        _read_ball()
    else:
        importlib.import_module(module)
    try:
        version = f"{package} {importlib.metadata.version(package)}"
    except importlib.metadata.PackageNotFoundError:
        version = f"{module}, installed with another package"
    return version + (", reads a built-in solid" if name == "step" else "")


def _read_ball() -> None:
    """Check the volume of a ball of radius 1 read from a STEP file."""
    from kilter import loading

    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "ball.step").write_text(BALL, encoding="ascii")
        [volume] = loading.load(str(Path(folder) / "ball.step")).geometry.volume.tolist()
    if abs(volume - 4 / 3 * math.pi) > EXACT * volume:
        raise _WrongAnswer(f"the ball of radius 1 has the volume {volume:.9g} instead of 4/3 pi")


def _terminal() -> str:
    """Describe the standard output: its kind, encoding and colours."""
    stream = sys.stdout
    kind = "a terminal" if stream is not None and stream.isatty() else "not a terminal"
    encoding = (getattr(stream, "encoding", None) or "utf-8").lower()
    colour = "NO_COLOR" if os.environ.get("NO_COLOR") else os.environ.get("TERM", "TERM not set")
    return f"{kind}, {encoding}, {colour}"
