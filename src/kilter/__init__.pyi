"""Public names of kilter, written by `python docs/build_stub.py`."""

from collections.abc import Callable
from collections.abc import Iterable
from collections.abc import Mapping
from collections.abc import Sequence
from matplotlib.figure import Figure
from numpy.typing import ArrayLike
from pathlib import Path
from typing import Any
from typing import Literal
from kilter.analysis.engine_contacts.judged import Judged as Judged
from kilter.analysis.many.batch import Batch as Batch
from kilter.analysis.many.settle_states import SettledStates as SettledStates
from kilter.analysis.many.verdicts import Verdicts as Verdicts
from kilter.analysis.margins.margin_answer import Margin as Margin
from kilter.analysis.margins.parameter_limit import ParameterLimit as ParameterLimit
from kilter.analysis.margins.parameter_limit import limit as limit
from kilter.analysis.margins.uncertainty import Ranges
from kilter.analysis.placing.check_plan import CheckedPlan as CheckedPlan
from kilter.analysis.placing.piles.pile import Pile as Pile
from kilter.analysis.placing.piles.pile import PileFit as PileFit
from kilter.analysis.placing.place import Places as Places
from kilter.analysis.placing.place import box_to_place as box_to_place
from kilter.analysis.planning.hold.fixture import Fixture as Fixture
from kilter.analysis.planning.order.order import Order as Order
from kilter.analysis.planning.order.plan_rules import PlanRules as PlanRules
from kilter.analysis.planning.order.plan_step import Step as Step
from kilter.analysis.planning.states.known_proofs import State as State
from kilter.analysis.planning.states.states import States as States
from kilter.analysis.regions.region import Region as Region
from kilter.analysis.regions.region import common_region as common_region
from kilter.analysis.scene_states.scene_report import SceneObject as SceneObject
from kilter.analysis.scene_states.scene_report import SceneReport as SceneReport
from kilter.analysis.settled_pose.settle import Settled as Settled
from kilter.analysis.transport.carrier import CarrierMotion as CarrierMotion
from kilter.analysis.transport.carrier_path import CarrierPath as CarrierPath
from kilter.analysis.transport.transport_answer import Transport as Transport
from kilter.analysis.turning.facet_program import Method
from kilter.analysis.turning.orientation import Orientation as Orientation
from kilter.analysis.verdict.part_answer import PartAnswer as PartAnswer
from kilter.analysis.verdict.part_answer import PointForces as PointForces
from kilter.analysis.verdict.verdict import Verdict as Verdict
from kilter.analysis.verification import Verification as Verification
from kilter.analysis.verification import verify as verify
from kilter.assembly.assembly import Assembly as Assembly
from kilter.assembly.assembly_arrays import AssemblyArrays as AssemblyArrays
from kilter.assembly.bonds import Bond as Bond
from kilter.assembly.feature import Feature as Feature
from kilter.assembly.interactions import FrictionPair as FrictionPair
from kilter.assembly.interactions import GivenContact as GivenContact
from kilter.assembly.interactions import Joint as Joint
from kilter.assembly.interactions import Load as Load
from kilter.assembly.part import Part as Part
from kilter.assembly.question import AssemblyOrPath
from kilter.assembly.straps import Strap as Strap
from kilter.contact.common.gaps import Tolerance as Tolerance
from kilter.contact.common.patches import Patch as Patch
from kilter.contact.contact_set import ContactSet as ContactSet
from kilter.contact.fits.fastening import fastened as fastened
from kilter.contact.supports import Support as Support
from kilter.errors import InputError as InputError
from kilter.errors import KilterError as KilterError
from kilter.errors import SolverError as SolverError
from kilter.files.own.answer_files import LoadedAnswer as LoadedAnswer
from kilter.files.own.answer_files import load_answer as load_answer
from kilter.files.own.choices import Choices as Choices
from kilter.files.packing.packing_lists import PackingPlan
from kilter.files.writing import dump as dump
from kilter.health import Health as Health
from kilter.health import doctor as doctor
from kilter.loading import save as save
from kilter.notebook import Shown as Shown
from kilter.publish.films import animate as animate
from kilter.publish.offline_page import Report as Report
from kilter.rigid import Pose as Pose
from kilter.scenes import example as example
from kilter.scenes.registry import Example as Example
from kilter.shape.primitives import Box as Box
from kilter.shape.primitives import Cylinder as Cylinder
from kilter.shape.primitives import Mesh as Mesh
from kilter.shape.primitives import Prism as Prism
from kilter.shape.primitives import Sphere as Sphere
from kilter.tell.levels import VerdictWord as VerdictWord
from kilter.workbench.server import view as view

__version__: str
__all__: list[str]
_HOMES: dict[str, str]

def batch(
    source: str | Path,
    output: str | Path,
    *,
    processes: int | None = None,
    chunk: int = 1000,
    cluster: str | None = None,
    progress: Callable[[int, int], None] | None = None,
    tolerance: Tolerance | None = None,
    require: str = "settles",
    effort: float = 1.0,
    time_limit: float | None = None,
    **reading: Any,
) -> Batch:
    """Compute the verdicts of many files, and write them to a folder as tables.

    A later run continues an interrupted one with the missing rows.

    Parameters
    ----------
    source : path
        A folder of assemblies, or a text file with a path a line.
    output : path
        A folder; ``part-000000.parquet`` and so on, CSV if pyarrow is not installed.
    processes : int, optional
        Number of worker processes on this machine; by default the number of cores.
    chunk : int
        Number of rows of a file.
    cluster : str, optional
        Address of a scheduler of Dask, in place of processes of this machine. The files are
        read where its workers run.
    progress : callable, optional
        Called with how many rows are written, and of how many.
    **reading
        How every file is read, as of `kilter.load`: `ground`, `floor`, `friction` and so on.
    tolerance : Tolerance, optional
        Tolerances of the detection: gap, angle and clearance. By default those of the
        assembly.
    require : {"equilibrium", "settles", "proved", "strict"}
        Level from which the answer is yes.
    effort : float
        Work limit; each further unit allows about ten times more work [-]. 0 is quick and
        1 is usual. Work is counted in operations, not in time.
    time_limit : float, optional
        Time limit [s]. The clock is read between steps, so an answer at the limit may
        differ from run to run.

    Raises
    ------
    InputError
        If nothing can be read or written, another run is at work in the folder, or it has
        another batch.

    See Also
    --------
    kilter.check_many : verdicts on assemblies in memory, without files.
    kilter.check : the complete answer for one assembly.
    """

def check(
    assembly: AssemblyOrPath,
    *,
    friction: float | None = None,
    down: ArrayLike | None = None,
    ground: str | Iterable[str] = (),
    floor: bool | float | None = None,
    measures: bool = False,
    contacts: ContactSet | None = None,
    tolerance: Tolerance | None = None,
    require: str = "settles",
    effort: float = 1.0,
    time_limit: float | None = None,
    progress: Callable[[str], None] | None = None,
    assume: str | None = None,
) -> Verdict:
    """Decide whether an assembly stays together under gravity, and prove the answer.

    Parameters
    ----------
    assembly : Assembly, or path
        At least one part must be held. The assembly contains friction and the direction of
        gravity: ``check(assembly.with_friction(0.6).with_down([0.1, 0, -1]))``.
    require : {"equilibrium", "settles", "proved", "strict"}
        Level from which the answer is yes. `Verdict.stable` is true from this level.
    measures : bool
        Whether to report z, kappa and the displacements although friction plays a part. They do
        not include friction.
    friction : float, optional
        Coefficient of the contacts without a coefficient of their own [-].
    down : array_like, shape (3,), optional
        Direction of gravity, whose magnitude stays [-].
    ground : str or iterable of str
        Parts that are also held; ``*`` and ``?`` are wildcards.
    floor : bool or float, optional
        True adds a held table under the lowest point; a number is its height [length].
    contacts : ContactSet, optional
        Contacts of this assembly; by default they are detected from its geometry.
    tolerance : Tolerance, optional
        Tolerances of the detection: gap, angle and clearance. By default those of the
        assembly.
    effort : float
        Work limit; each further unit allows about ten times more work [-]. 0 is quick and
        1 is usual. Work is counted in operations, not in time.
    time_limit : float, optional
        Time limit [s]. The clock is read between steps, so an answer at the limit may
        differ from run to run.
    progress : callable, optional
        Function that is called with the name of each stage.
    assume : {"drawn", "play", "fits", "joined"}, optional
        Rung of the ladder of assumptions about an inexact file: the drawn pose; parts move
        within their play until they rest; pairs that look fastened are joined, too; parts
        that touch are joined, too. The default is that of the saved choices, else play for
        files of simulators, else drawn.

    Returns
    -------
    Verdict

    Raises
    ------
    InputError
        If no part is held, if an argument is invalid, or if the geometry is not usable.

    See Also
    --------
    kilter.margin : how much tilt, push or loss of friction it withstands.
    kilter.scene : a state for each object of a scene.

    Examples
    --------
    >>> from kilter.scenes import scene
    >>> check(scene("tower")).verdict
    'stable'
    >>> verdict = check(scene("paper-figure-8"))
    >>> verdict.verdict, verdict.moving
    ('unstable', ['C2', 'C3'])
    """

def check_contacts(
    points: Any,
    normals: Any,
    mu: Any,
    bodies: Any,
    center_of_mass: Any,
    *,
    mass: Any = None,
    wrenches: Any = None,
    gravity: Any = (0.0, 0.0, -9.81),
    curved: Any = None,
    require: str = "settles",
    effort: float = 1.0,
    time_limit: float | None = None,
) -> Verdict:
    """Decide whether given contacts hold bodies at rest: arrays in, a verdict with proof out.

    The arrays are those of any physics engine. Only these contacts exist, and shapes are not read.
    All vectors are in the world frame; lengths are metres. Contact k acts between the bodies
    ``bodies[k]``, and its Coulomb cone has the axis ``normals[k]``.

    Parameters
    ----------
    points : array_like, shape (K, 3)
        Contact points [m].
    normals : array_like, shape (K, 3)
        Normals from the first body to the second, of any length [-].
    mu : array_like, shape (K,), or float
        Friction coefficients [-].
    bodies : array_like of int, shape (K, 2)
        First and second body of each contact, from 0 to B - 1; -1 is the world, which is held.
    center_of_mass : array_like, shape (B, 3)
        Centres of mass [m].
    mass : array_like, shape (B,), optional
        Masses [kg]. Without masses `wrenches` are all loads; accelerations then belong to assumed
        masses in proportion to the wrenches.
    wrenches : array_like, shape (B, 6), optional
        Force [N] and torque about the centre of mass [N m] on each body, in addition to the weight.
    gravity : array_like, shape (3,)
        Acceleration of gravity [m/s^2].
    require : {"equilibrium", "settles", "proved", "strict"}
        Level from which the answer is yes. "equilibrium" is the quickest: it decides only whether
        forces at the contacts balance every body, in about 10 ms for 20 bodies.
    curved : array_like of bool, shape (B,), optional
        Whether the surface of each body may be curved at its contacts. By default none is: every
        body touches with corners, edges and flat faces. For a curved body the level is at most
        "equilibrium" unless friction or further contacts prevent that it rolls.
    effort : float
        Work limit; each further unit allows about ten times more work [-]. 0 is quick and
        1 is usual. Work is counted in operations, not in time.
    time_limit : float, optional
        Time limit [s]. The clock is read between steps, so an answer at the limit may
        differ from run to run.

    Returns
    -------
    Verdict
        Its parts are named "0", "1", ... and "world". The contact points of ``forces`` have the
        order of the given points.

    Raises
    ------
    InputError
        If an array has another shape, a number is not finite, a normal is zero, a coefficient is
        negative, a contact is of a body with itself, or there are neither masses nor wrenches.

    See Also
    --------
    kilter.judge : the same for a state of MuJoCo, with motors and joints.
    kilter.check : the verdict on an assembly with shapes.

    Examples
    --------
    A block on a plane of friction 0.5, whose slope is below and above atan 0.5:

    >>> corners = [[x, y, -1.0] for x in (-1, 1) for y in (-1, 1)]
    >>> for slope in (0.49, 0.51):
    ...     verdict = check_contacts(corners, [[0, 0, 1]] * 4, 0.5, [[-1, 0]] * 4, [[0, 0, 0]],
    ...                              mass=[2.0], gravity=[9.81 * slope, 0, -9.81])
    ...     print(verdict.verdict)
    stable
    unstable
    """

def check_many(
    assemblies: Iterable[AssemblyOrPath] | AssemblyArrays,
    *,
    friction: float | None = None,
    down: ArrayLike | None = None,
    ground: str | Iterable[str] = (),
    floor: bool | float | None = None,
    proofs: bool = False,
    progress: Callable[[int, int], None] | None = None,
    tolerance: Tolerance | None = None,
    require: str = "settles",
    effort: float = 1.0,
    time_limit: float | None = None,
) -> Verdicts:
    """Decide for each of many assemblies whether it stays together under gravity.

    Verdicts and levels are the same as those of `check`. If `check` rejects an assembly, its
    verdict is "error", and `Verdicts.errors` has the reason.

    Parameters
    ----------
    assemblies : iterable of Assembly or path, or AssemblyArrays
        Assemblies, each with its own gravity, friction, units and size. `AssemblyArrays` avoid the
        construction of part objects.
    tolerance : Tolerance, optional
        Tolerances of the detection: gap, angle and clearance. They apply to all assemblies; by
        default each assembly has its own.
    require : {"equilibrium", "settles", "proved", "strict"}
        Level from which the answer is yes. `Verdicts.stable` is true from this level.
    proofs : bool
        Whether to store every proof, about 10 kB each, for `Verdicts.certificate`.
    progress : callable, optional
        Function called with the number of finished assemblies and the total.
    friction : float, optional
        Coefficient of the contacts without a coefficient of their own [-].
    down : array_like, shape (3,), optional
        Direction of gravity, whose magnitude stays [-].
    ground : str or iterable of str
        Parts that are also held; ``*`` and ``?`` are wildcards.
    floor : bool or float, optional
        True adds a held table under the lowest point; a number is its height [length].
    effort : float
        Work limit; each further unit allows about ten times more work [-]. 0 is quick and
        1 is usual. Work is counted in operations, not in time.
    time_limit : float, optional
        Time limit [s]. The clock is read between steps, so an answer at the limit may
        differ from run to run.

    Raises
    ------
    InputError
        If the tolerance or an option is invalid, a file cannot be read, a name matches no part of
        an assembly, or an element of `assemblies` is neither an assembly nor a path.

    See Also
    --------
    kilter.batch : the same for many files, with tables on disk.
    kilter.check : the complete answer for one assembly.

    Examples
    --------
    >>> from kilter.scenes import scene
    >>> check_many([scene("tower"), scene("paper-figure-8")]).verdict.tolist()
    ['stable', 'unstable']
    """

def check_plan(
    plan: PackingPlan | str | Path,
    *,
    friction: float | None = 0.0,
    order: str | None = None,
    units: str | None = None,
    pallet: tuple[float, float] | None = None,
    held: Assembly | None = None,
    walls: tuple[float, float] | None = None,
    carried: bool = False,
    tolerance: Tolerance | None = None,
    require: str = "settles",
    effort: float = 1.0,
    time_limit: float | None = None,
    progress: Callable[[str], None] | None = None,
) -> CheckedPlan:
    """Decide for each item of a packing plan whether the pile stands when the item is put down.

    Parameters
    ----------
    plan : PackingPlan or path
        A plan, or its file (CSV, or JSON of BED-BPP).
    order : str, optional
        Name of the order, for a file with several orders.
    units : {"m", "cm", "mm", "in"}, optional
        Length unit of a table that states none.
    pallet : (float, float), optional
        Length and width of the base, from the origin of x and y [length unit]. By default the base
        extends beyond the pile.
    held : Assembly, optional
        Held parts around the pile, such as the walls of a roll container.
    walls : (float, float), optional
        Inner length and width of four held walls from the origin of x and y, as tall as the pile
        [length unit].
    require : {"equilibrium", "settles", "proved", "strict"}
        Level from which an item stands.
    carried : bool
        Whether to compute the accelerations that the finished pile carries.
    friction : float, optional
        Coefficient of the contacts without a coefficient of their own [-].
    tolerance : Tolerance, optional
        Tolerances of the detection: gap, angle and clearance. By default those of the
        assembly.
    effort : float
        Work limit; each further unit allows about ten times more work [-]. 0 is quick and
        1 is usual. Work is counted in operations, not in time.
    time_limit : float, optional
        Time limit [s]. The clock is read between steps, so an answer at the limit may
        differ from run to run.
    progress : callable, optional
        Function that is called with the name of each stage.

    Returns
    -------
    CheckedPlan

    Raises
    ------
    TimeLimitReached
        At the time limit.
    InputError
        If the plan is invalid, two boxes are in the same place, or a box lies beyond the walls.

    See Also
    --------
    kilter.place : the places where a next part stands.
    kilter.plan : a search for an order.

    Examples
    --------
    >>> from kilter.files.packing.packing_lists import PackedBox, PackingPlan
    >>> lower = PackedBox("a", (1, 1, 1), 1, (0, 0, 0), 1)
    >>> upper = PackedBox("b", (1, 1, 1), 1, (0.6, 0, 1), 2)
    >>> check_plan(PackingPlan((lower, upper), "m")).why
    "the centre of 'b' lies 0.1 m beside the area on which it rests"
    """

def contacts(
    assembly: AssemblyOrPath,
    *,
    friction: float | None = None,
    down: ArrayLike | None = None,
    ground: str | Iterable[str] = (),
    floor: bool | float | None = None,
    tolerance: Tolerance | None = None,
    time_limit: float | None = None,
    progress: Callable[[str], None] | None = None,
) -> ContactSet:
    """Find the contacts of an assembly.

    Parameters
    ----------
    assembly : Assembly, or path
    time_limit : float, optional
        Time limit [s]. Near pairs that are not examined until then are open pairs of the kind
        "unexamined". The search takes at least 0.2 s, which suffice for small assemblies.
    friction : float, optional
        Coefficient of the contacts without a coefficient of their own [-].
    down : array_like, shape (3,), optional
        Direction of gravity, whose magnitude stays [-].
    ground : str or iterable of str
        Parts that are also held; ``*`` and ``?`` are wildcards.
    floor : bool or float, optional
        True adds a held table under the lowest point; a number is its height [length].
    tolerance : Tolerance, optional
        Tolerances of the detection: gap, angle and clearance. By default those of the
        assembly.
    progress : callable, optional
        Function that is called with the name of each stage.

    Returns
    -------
    ContactSet
        Patches of detected and given contacts, rejected pairs, overlaps and open pairs.

    Raises
    ------
    InputError
        If the tolerance is not above zero.

    See Also
    --------
    kilter.fastened : joints between the touching parts.
    kilter.check : the verdict, which detects contacts itself.

    Examples
    --------
    >>> from kilter.shape.primitives import Box
    >>> from kilter.assembly import Part
    >>> from kilter.rigid import Pose
    >>> table = Part("table", Box([4, 4, 1]), Pose([0, 0, -0.5]), grounded=True)
    >>> result = contacts(Assembly([table, Part("cube", Box([1, 1, 1]), Pose([0, 0, 0.5]))]))
    >>> result
    <ContactSet: patches 1, points 4, pairs 1>
    >>> result.patch_area, result.patch_normal.tolist()
    (array([1.]), [[0.0, 0.0, 1.0]])
    """

def draw(
    subject: AssemblyOrPath | Verdict | Region | Order | Settled | Transport | Places | Margin,
    out: str | Path | None = None,
    *,
    friction: float | None = None,
    down: ArrayLike | None = None,
    ground: str | Iterable[str] = (),
    floor: bool | float | None = None,
    what: Literal["assembly", "region", "changes", "thrust", "movement"] = "assembly",
    view: tuple[float, float] | None = None,
    names: bool | None = None,
    contacts: ContactSet | bool | None = None,
    moved: Mapping[str, Any] | None = None,
    turned: Mapping[str, Any] | None = None,
    tolerance: Tolerance | None = None,
    effort: float = 1.0,
    time_limit: float | None = None,
    progress: Callable[[str], None] | None = None,
) -> Figure:
    """Draw the parts with their motion or forces, the stable region, or the changes that help.

    The figure of a plan is a sheet with a picture per step. That of a margin has an arrow on each
    part, along which a movement raises the limit most, and beside it the assembly with the best
    change of `improve`, or the one that `make_stand` found.

    Parameters
    ----------
    subject : Assembly, path, Verdict, Region, Order, Settled, Transport, Places or Margin
        An answer is drawn unchanged. For an assembly, the answer is computed.
    out : path, optional
        File of the figure, ending in .svg, .png or .pdf.
    what : {"assembly", "region", "changes", "thrust", "movement"}
        Figure of an assembly: its verdict, its stable region, the changes that help, the lines of
        least and greatest thrust of a chain of parts, or the movement of the parts after a movement
        of supports, magnified, with hinges. The last two also apply to a `Verdict`.
    view : (float, float), optional
        Azimuth (to the right of -y) and elevation of the eye [deg], with gravity down.
    names : bool, optional
        Write the names of the parts; by default only for few parts.
    contacts : ContactSet or bool, optional
        Contacts of this assembly; by default they are detected from its geometry. True or False
        decides whether contact patches are drawn; by default only few patches are drawn.
    moved, turned : mapping, optional
        Movements of supports for the figure of a movement, as in `Verdict.support_movement`.
    friction : float, optional
        Coefficient of the contacts without a coefficient of their own [-].
    down : array_like, shape (3,), optional
        Direction of gravity, whose magnitude stays [-].
    ground : str or iterable of str
        Parts that are also held; ``*`` and ``?`` are wildcards.
    floor : bool or float, optional
        True adds a held table under the lowest point; a number is its height [length].
    tolerance : Tolerance, optional
        Tolerances of the detection: gap, angle and clearance. By default those of the
        assembly.
    effort : float
        Work limit; each further unit allows about ten times more work [-]. 0 is quick and
        1 is usual. Work is counted in operations, not in time.
    time_limit : float, optional
        Time limit [s]. The clock is read between steps, so an answer at the limit may
        differ from run to run.
    progress : callable, optional
        Function that is called with the name of each stage.

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    InputError
        If matplotlib is not installed, the assembly is not valid, or the ending of the file is
        unknown.

    See Also
    --------
    kilter.report : an interactive page.
    kilter.animate : a film.

    Examples
    --------
    >>> from kilter.scenes import scene
    >>> draw(scene("tower"), what="region").get_size_inches().tolist()
    [7.0, 4.3]
    """

def hold(
    assembly: AssemblyOrPath,
    *,
    friction: float | None = None,
    down: ArrayLike | None = None,
    ground: str | Iterable[str] = (),
    floor: bool | float | None = None,
    candidates: Iterable[str | Support] = ("grips",),
    straps: Iterable[Strap] | None = None,
    code: str | None = None,
    forward: ArrayLike = (1.0, 0.0, 0.0),
    most: int | None = None,
    contacts: ContactSet | None = None,
    tolerance: Tolerance | None = None,
    require: str = "settles",
    effort: float = 1.0,
    time_limit: float | None = None,
    progress: Callable[[str], None] | None = None,
    assume: str | None = None,
) -> Fixture:
    """Find the fewest supports with which an assembly holds, and prove that fewer are not enough.

    Parameters
    ----------
    assembly : Assembly, or path
        Assembly; `Assembly.without` omits parts that are not inserted yet.
    candidates : iterable of "grips", "props", "fingers" or Support
        Candidates: a grip on every part, a prop under every part, a finger on every flat
        face that is free, or the given supports.
    straps : iterable of Strap, optional
        Candidates of the only kind, in place of `candidates`: the answer has the fewest of these
        straps beside those of the assembly. The proof is one of equilibrium.
    code : str, optional
        With `straps`: the same straps must hold the load at every acceleration of this code of load
        securing, as in `kilter.transport`.
    forward : array_like, shape (3,)
        Direction of travel, for `code`.
    most : int, optional
        Largest number of supports to consider.
    require : {"equilibrium", "settles", "proved"}
        Level from which the answer is yes. The assembly must reach it with its supports.
    effort : float
        Work limit; each further unit allows about ten times more work [-]. It concerns the search
        of supports, too.
    friction : float, optional
        Coefficient of the contacts without a coefficient of their own [-].
    down : array_like, shape (3,), optional
        Direction of gravity, whose magnitude stays [-].
    ground : str or iterable of str
        Parts that are also held; ``*`` and ``?`` are wildcards.
    floor : bool or float, optional
        True adds a held table under the lowest point; a number is its height [length].
    contacts : ContactSet, optional
        Contacts of this assembly; by default they are detected from its geometry.
    tolerance : Tolerance, optional
        Tolerances of the detection: gap, angle and clearance. By default those of the
        assembly.
    time_limit : float, optional
        Time limit [s]. The clock is read between steps, so an answer at the limit may
        differ from run to run.
    progress : callable, optional
        Function that is called with the name of each stage.
    assume : {"drawn", "play", "fits", "joined"}, optional
        Rung of the ladder of assumptions about an inexact file: the drawn pose; parts move
        within their play until they rest; pairs that look fastened are joined, too; parts
        that touch are joined, too. The default is that of the saved choices, else play for
        files of simulators, else drawn.

    Raises
    ------
    InputError
        If no candidate exists, a candidate does not fit the assembly, the code does not exist, or
        it is given without straps.

    See Also
    --------
    kilter.plan : parts that are held while the assembly is built.
    kilter.fastened : joints between parts.

    Examples
    --------
    >>> from kilter.scenes.arches import arch
    >>> half = arch(9, ratio=0.3, friction=0.6).without("voussoir-4")
    >>> hold(half)
    <Fixture: grip on voussoir-3, grip on voussoir-5>
    >>> hold(half, most=1)
    <Fixture: undecided, 2 or more>
    """

def judge(
    model: Any,
    data: Any,
    *,
    creep: float = 0.0,
    loose_robots: bool = False,
    require: str = "settles",
    effort: float = 1.0,
    time_limit: float | None = None,
) -> Judged:
    """Decide whether the contacts of MuJoCo hold its bodies in the given state, and why not.

    The contacts are those of the engine's own collision detection at the positions of `data`.
    Motors, springs and applied forces count with the forces that they have at rest. Robots, which
    are bodies with motors on the world, are held. The last body of a robot's branch moves if its
    motor presses it against a loose body, such as the finger of a gripper. `data` does not change.

    Parameters
    ----------
    model : mujoco.MjModel
    data : mujoco.MjData
        The state; no call of ``mj_forward`` is needed.
    require : {"equilibrium", "settles", "proved", "strict"}
        Level from which `Judged.holds` is true. "equilibrium" is the quickest: it decides only
        whether forces at the contacts balance every body.
    creep : float
        Time for which the engine simulates the state from rest with several settings of its
        solver [s]; 0: no simulation. `Judged.creep` compares how far the bodies move.
    loose_robots : bool
        Whether robots move, with the forces of their motors as loads.
    effort : float
        Work limit; each further unit allows about ten times more work [-]. 0 is quick and
        1 is usual. Work is counted in operations, not in time.
    time_limit : float, optional
        Time limit [s]. The clock is read between steps, so an answer at the limit may
        differ from run to run.

    Returns
    -------
    Judged

    Raises
    ------
    InputError
        If `model` and `data` are not of MuJoCo, the model has no gravity, or an argument is
        invalid.

    See Also
    --------
    kilter.check_contacts : the same from arrays, for any engine.
    kilter.scene : a verdict from the geometry of a scene, without the engine's contacts.
    """

def load(
    source: Any,
    *,
    ground: str | Iterable[str] = (),
    floor: bool | float | None = None,
    without: str | Iterable[str] = (),
    down: ArrayLike | None = None,
    friction: float | None = None,
    units: str | None = None,
    density: float | None = None,
    keep_copies: bool = False,
    up: str | None = None,
    contacts: str | None = None,
    keyframe: str | None = None,
    state: str | None = None,
    model: str | None = None,
    base: str | None = None,
    loose_robots: bool = False,
    stud_pull: float | None = None,
    stud_shear: float | str | None = None,
    brick_sides: str | None = None,
    off: str | Iterable[str] = (),
    release: str | Iterable[str] = (),
) -> Assembly:
    """Read an assembly from a file, a folder, standard input (``-``) or an object.

    Every command has the same options. They are applied in the order `without`, `friction`,
    `down`, `ground`, `floor`.

    Parameters
    ----------
    source : path or object
        A kilter file or COMPAS assembly (.json), a mesh file (.obj, .stl, .3mf, .glb,
        .gltf, .ply, .off, .dae, .3dm), a STEP or IGES file (.step, .stp, .igs, .iges), a FreeCAD
        document (.FCStd), a scene of a simulator (.xml, .mjcf, .urdf, .sdf, .usd), a model of
        toy bricks (LDraw .ldr and .mpd, StableLego .json, BrickGPT .txt), a folder of meshes,
        or ``-`` for JSON on standard input.
        Or `kilter.Choices`, or the path of their file: the file that they name, with the saved
        options. The options given here win over them; a note of the assembly names what they
        replace.
        Or an object: a trimesh Trimesh or Scene, a pair of arrays (vertices, faces), a
        shape or assembly of build123d or CadQuery, a COMPAS Assembly, Block or Mesh, a
        model of MuJoCo or (model, data); a list of these, or a dict of them by name.
    units : {"m", "cm", "mm", "in"}, optional
        Length unit of a format that states none; default mm for STL, else m.
    density : float, optional
        Density of parts without density and mass [kg/m^3]; of all parts of STEP files.
    ground, without : str or iterable of str
        Names of the parts to hold, and of the parts to leave out; ``*`` and ``?`` are globs.
    floor : bool or float, optional
        True: a held table under the lowest point, with respect to the up direction of the file; a
        number: at that height [length unit]; False: no floor, also if the choices have a floor.
    down : array_like, shape (3,), optional
        Direction of gravity; its magnitude stays that of the file. A floor turns with the parts.
    up : {"x", "y", "z", "-x", "-y", "-z"}, optional
        The axis of the file that points up, against gravity: ``"y"`` turns gravity to [0, -1, 0],
        and a floor lies across this axis.
    friction : float, optional
        Friction coefficient of contacts that have no coefficient of their own [-].
    contacts : {"file", "geometry"}, optional
        "file": only the contacts that the file lists (interfaces of COMPAS, `contacts` of a
        kilter file); "geometry": all contacts are detected. By default, the contacts of a kilter
        file replace detection for their pairs. Interfaces of COMPAS are then ignored, with a note.
    keyframe : str, optional
        MuJoCo: name of the keyframe whose pose is used; default the first keyframe.
    state : str, optional
        MuJoCo: ``FILE`` or ``FILE:ROW``, the state of this row in place of a keyframe. The file is
        that of `numpy.save`, or a pickled array; a row is qpos, or time, qpos and qvel.
    model : str, optional
        LDraw: name of the model of the file that is built; default the first.
    base : {"fixed", "floating"}, optional
        URDF: whether the root link is held; default "fixed".
    loose_robots : bool
        MuJoCo and URDF: free the bodies that motors move, which are held by default. In URDF,
        joints with a `transmission` have motors.
    stud_pull : float, optional
        Bricks: largest pull at each point of a stud [N]; default .98.
    stud_shear : float or {"unlimited", "mu"}, optional
        Bricks: largest sideways force at each point of a stud: a number [N], no limit, or
        mu (f_n + pull); default "unlimited".
    brick_sides : {"lower-edge", "face", "none"}, optional
        Bricks: the points at which neighbours side by side push each other; default "lower-edge".
    keep_copies : bool
        CAD and meshes: keep the bodies that are in the file twice; by default a copy, or a step of
        a feature beside its result, is left out, with a note.
    off : str or iterable of str
        Choices: options whose saved values are ignored, as in ``off=["floor", "loose"]``.
    release : str or iterable of str
        Choices: saved held parts that are not held; ``*`` and ``?`` are wildcards.

    Raises
    ------
    InputError
        If the source cannot be read; the message names the fault, its place and the remedy.

    See Also
    --------
    kilter.load_answer : reads an answer, not an assembly.
    kilter.example : a built-in assembly.
    """

def margin(
    assembly: AssemblyOrPath,
    *,
    friction: float | None = None,
    down: ArrayLike | None = None,
    ground: str | Iterable[str] = (),
    floor: bool | float | None = None,
    push: Any = None,
    about: Any = None,
    pushes: bool = False,
    pushed: list[str] | None = None,
    loads: bool = False,
    ranges: Ranges | None = None,
    bracket: bool = False,
    improve: bool = False,
    make_stand: Sequence[str] | None = None,
    stand_tilt_deg: float = 2.0,
    contacts: ContactSet | None = None,
    tolerance: Tolerance | None = None,
    require: str = "equilibrium",
    effort: float = 1.0,
    time_limit: float | None = None,
    progress: Callable[[str], None] | None = None,
    assume: str | None = None,
) -> Margin:
    """Compute the margins of an assembly: tilt, least friction, load factor and pushes.

    Parameters
    ----------
    assembly : Assembly, or path
    push : array_like, shape (3,), optional
        The load factor of a body force in this direction, in units of each part's weight;
        else that of the given loads, if there are any.
    about : array_like, shape (3,), optional
        Also the tilt about this axis, across gravity, by the right-hand rule.
    pushes : bool
        Also the weakest push of each free part. Of more than 50 parts, those that move most
        easily.
    pushed : list of str, optional
        Only the pushes of these parts; with `improve`, only these parts are held in turn.
    loads : bool
        Also the load straight down that each free part takes, or each of `pushed`.
    ranges : Ranges, optional
        Also the worst tilt margin and load factor over these intervals.
    bracket : bool
        Also the load factors up to which no motion that obeys the contact law can start.
    improve : bool
        Also changes of the assembly that raise the tilt margin most, each tried; without a tilt
        margin those for the load factor, or for the least friction.
    make_stand : list of {"move", "mass", "size", "friction"}, optional
        Also the least change of these kinds after which the assembly stands: parts moved along
        their contacts, other masses, larger sizes across the contacts, more friction.
    stand_tilt_deg : float
        Tilt margin with which it then stands [deg].
    require : {"equilibrium", "settles", "proved"}
        Level from which the answer is yes. Above "equilibrium", `Margin.at_level` has the values up
        to which this level is reached. The default is lower than that of `check`, because each
        further value is a search.
    friction : float, optional
        Coefficient of the contacts without a coefficient of their own [-].
    down : array_like, shape (3,), optional
        Direction of gravity, whose magnitude stays [-].
    ground : str or iterable of str
        Parts that are also held; ``*`` and ``?`` are wildcards.
    floor : bool or float, optional
        True adds a held table under the lowest point; a number is its height [length].
    contacts : ContactSet, optional
        Contacts of this assembly; by default they are detected from its geometry.
    tolerance : Tolerance, optional
        Tolerances of the detection: gap, angle and clearance. By default those of the
        assembly.
    effort : float
        Work limit; each further unit allows about ten times more work [-]. 0 is quick and
        1 is usual. Work is counted in operations, not in time.
    time_limit : float, optional
        Time limit [s]. The clock is read between steps, so an answer at the limit may
        differ from run to run.
    progress : callable, optional
        Function that is called with the name of each stage.
    assume : {"drawn", "play", "fits", "joined"}, optional
        Rung of the ladder of assumptions about an inexact file: the drawn pose; parts move
        within their play until they rest; pairs that look fastened are joined, too; parts
        that touch are joined, too. The default is that of the saved choices, else play for
        files of simulators, else drawn.

    Raises
    ------
    InputError
        If a direction is of length zero, the axis is not across gravity, or a part is held or
        unknown, also one that a load pulls on; if `about` comes with bonds or loads, or `ranges`
        with bonds; if a kind of change is unknown, or `make_stand` comes with bonds, straps, joints
        or loads.

    See Also
    --------
    kilter.check : the verdict on the given direction and friction.
    kilter.transport : limits of the acceleration of a carrier.

    Examples
    --------
    >>> from kilter.scenes import scene
    >>> round(margin(scene("tower")).friction, 6)
    0.0
    """

def orient(
    assembly: AssemblyOrPath,
    *,
    friction: float | None = None,
    down: ArrayLike | None = None,
    ground: str | Iterable[str] = (),
    floor: bool | float | None = None,
    method: Method = "joint",
    contacts: ContactSet | None = None,
    tolerance: Tolerance | None = None,
    time_limit: float | None = None,
    progress: Callable[[str], None] | None = None,
    assume: str | None = None,
) -> Orientation:
    """Find the stable direction of gravity with the widest margin, or the nearest to stable.

    With friction: so that forces that hold it exist, in the middle of those directions.

    Parameters
    ----------
    assembly : Assembly, or path
        It has at least one held part, and no loads.
    method : {"joint", "walk"}
        For the nearest direction on the paper's diamond.
    friction : float, optional
        Coefficient of the contacts without a coefficient of their own [-].
    down : array_like, shape (3,), optional
        Direction of gravity, whose magnitude stays [-].
    ground : str or iterable of str
        Parts that are also held; ``*`` and ``?`` are wildcards.
    floor : bool or float, optional
        True adds a held table under the lowest point; a number is its height [length].
    contacts : ContactSet, optional
        Contacts of this assembly; by default they are detected from its geometry.
    tolerance : Tolerance, optional
        Tolerances of the detection: gap, angle and clearance. By default those of the
        assembly.
    time_limit : float, optional
        Time limit [s]. The clock is read between steps, so an answer at the limit may
        differ from run to run.
    progress : callable, optional
        Function that is called with the name of each stage.
    assume : {"drawn", "play", "fits", "joined"}, optional
        Rung of the ladder of assumptions about an inexact file: the drawn pose; parts move
        within their play until they rest; pairs that look fastened are joined, too; parts
        that touch are joined, too. The default is that of the saved choices, else play for
        files of simulators, else drawn.

    Raises
    ------
    TimeLimitReached
        At the time limit, with the verdict of the given direction.
    InputError
        If nothing is held, loads are given, or the geometry is not usable.

    See Also
    --------
    kilter.region : every stable direction of gravity.
    kilter.check : the verdict on a direction, with ``down``.

    Examples
    --------
    >>> from kilter.scenes import scene, stacks
    >>> orient(scene("paper-figure-11"))
    Orientation(found, down (-0.707107, 0, -0.707107), tilt margin 0 deg)
    >>> round(orient(stacks.block_on_slope(40.0, friction=0.5)).tilt_margin_deg, 1)
    26.5
    """

def place(
    assembly: AssemblyOrPath,
    part: Part,
    *,
    friction: float | None = None,
    down: ArrayLike | None = None,
    ground: str | Iterable[str] = (),
    floor: bool | float | None = None,
    at: ArrayLike | None = None,
    mass: float | Sequence[float] | None = None,
    center_within: float = 0.0,
    clear: float = 0.0,
    accuracy: float | None = None,
    contacts: ContactSet | None = None,
    tolerance: Tolerance | None = None,
    require: str = "settles",
    effort: float = 1.0,
    time_limit: float | None = None,
    progress: Callable[[str], None] | None = None,
    assume: str | None = None,
) -> Places:
    """Find where the next part stands on an assembly, or decide whether it stands at a place.

    Parameters
    ----------
    assembly : Assembly, or path
        Gravity acts along -z.
    part : Part
        The part to put down, in its orientation; its position does not matter. `box_to_place` makes
        a box. A map needs a box or another upright convex prism.
    at : array_like, shape (2,), optional
        Centre of the part in x and y [length unit]. Without it, all places are mapped.
    mass : float or (float, float), optional
        Mass of the part, or its least and largest mass [kg]; by default the mass of `part`.
    center_within : float
        Largest horizontal shift of the centre of mass along each axis of the part [sizes of the
        part]. The answer then holds for each mass and each centre within these limits.
    clear : float
        Distance that the part keeps from parts beside it in a map [length unit].
    accuracy : float, optional
        Largest width of the strip between places that stand and places that fall; by default a
        500th of the extent of the map [length unit].
    require : {"equilibrium", "settles", "proved", "strict"}
        Level from which a given place counts as standing. A map has the level equilibrium.
    friction : float, optional
        Coefficient of the contacts without a coefficient of their own [-].
    down : array_like, shape (3,), optional
        Direction of gravity, whose magnitude stays [-].
    ground : str or iterable of str
        Parts that are also held; ``*`` and ``?`` are wildcards.
    floor : bool or float, optional
        True adds a held table under the lowest point; a number is its height [length].
    contacts : ContactSet, optional
        Contacts of this assembly; by default they are detected from its geometry.
    tolerance : Tolerance, optional
        Tolerances of the detection: gap, angle and clearance. By default those of the
        assembly.
    effort : float
        Work limit; each further unit allows about ten times more work [-]. 0 is quick and
        1 is usual. Work is counted in operations, not in time.
    time_limit : float, optional
        Time limit [s]. The clock is read between steps, so an answer at the limit may
        differ from run to run.
    progress : callable, optional
        Function that is called with the name of each stage.
    assume : {"drawn", "play", "fits", "joined"}, optional
        Rung of the ladder of assumptions about an inexact file: the drawn pose; parts move
        within their play until they rest; pairs that look fastened are joined, too; parts
        that touch are joined, too. The default is that of the saved choices, else play for
        files of simulators, else drawn.

    Returns
    -------
    Places

    Raises
    ------
    TimeLimitReached
        At the time limit.
    InputError
        If gravity does not act along -z, no part is held, or an argument is invalid.

    See Also
    --------
    kilter.settle : moves drawn parts until they rest.
    kilter.check_plan : decides a given sequence of places.

    Examples
    --------
    >>> from kilter.scenes import scene
    >>> answer = place(scene("tower"), box_to_place([1, 1, 1], 1.0))
    >>> answer.stands, [level.height for level in answer.levels]
    (True, [5.5])

    With a centre of mass that is known to a tenth of the size, the margin is smaller by this tenth:

    >>> unsure = place(scene("tower"), box_to_place([1, 1, 1], 1.0), center_within=0.1)
    >>> round(answer.best.margin, 6), round(unsure.best.margin, 6)
    (0.5, 0.4)
    """

def plan(
    assembly: AssemblyOrPath,
    rules: PlanRules | None = None,
    *,
    friction: float | None = None,
    down: ArrayLike | None = None,
    ground: str | Iterable[str] = (),
    floor: bool | float | None = None,
    contacts: ContactSet | None = None,
    tolerance: Tolerance | None = None,
    require: str = "equilibrium",
    effort: float = 1.0,
    time_limit: float | None = None,
    progress: Callable[[str], None] | None = None,
    assume: str | None = None,
) -> Order:
    """Find an order in which an assembly can be put together, with a proof of each step.

    Parameters
    ----------
    assembly : Assembly, or path
        Finished assembly with at least one grounded part; the grounded parts are the base.
    rules : PlanRules, optional
        Allowed orders, held parts and paths, and the quantity to be minimised; by default up to 2
        parts are held, and their number is minimised.
    require : {"equilibrium", "settles", "proved"}
        Level from which the answer is yes. `Order.holds` requires it of every step. The default is
        lower than that of `check`, because the search decides half-built states at "equilibrium".
    effort : float
        Work limit; each further unit allows about ten times more work [-]. It concerns the search
        of the order, too.
    friction : float, optional
        Coefficient of the contacts without a coefficient of their own [-].
    down : array_like, shape (3,), optional
        Direction of gravity, whose magnitude stays [-].
    ground : str or iterable of str
        Parts that are also held; ``*`` and ``?`` are wildcards.
    floor : bool or float, optional
        True adds a held table under the lowest point; a number is its height [length].
    contacts : ContactSet, optional
        Contacts of this assembly; by default they are detected from its geometry.
    tolerance : Tolerance, optional
        Tolerances of the detection: gap, angle and clearance. By default those of the
        assembly.
    time_limit : float, optional
        Time limit [s]. The clock is read between steps, so an answer at the limit may
        differ from run to run.
    progress : callable, optional
        Function that is called with the name of each stage.
    assume : {"drawn", "play", "fits", "joined"}, optional
        Rung of the ladder of assumptions about an inexact file: the drawn pose; parts move
        within their play until they rest; pairs that look fastened are joined, too; parts
        that touch are joined, too. The default is that of the saved choices, else play for
        files of simulators, else drawn.

    Raises
    ------
    InputError
        If no part is grounded, a name matches no part,
        the precedence has a cycle, no thread joins the parts of a screw, a part is in
        two groups, or the sequence does not name each part exactly once.

    See Also
    --------
    kilter.states : verdicts on subsets of the parts, without an order.
    kilter.hold : supports of the finished assembly.

    Examples
    --------
    >>> from kilter.scenes import scene
    >>> found = plan(scene("tower"))
    >>> found, [step.part for step in found.steps]
    (<Order: found, 5 steps, 0 with parts held>, ['cube-1', 'cube-2', 'cube-3', 'cube-4', 'cube-5'])
    """

def region(
    assembly: AssemblyOrPath,
    *,
    friction: float | None = None,
    down: ArrayLike | None = None,
    ground: str | Iterable[str] = (),
    floor: bool | float | None = None,
    gap_deg: float = 0.1,
    rests: bool = False,
    contacts: ContactSet | None = None,
    tolerance: Tolerance | None = None,
    time_limit: float | None = None,
    progress: Callable[[str], None] | None = None,
    assume: str | None = None,
) -> Region:
    """Find every direction of gravity for which an assembly stays together.

    Parameters
    ----------
    assembly : Assembly, or path
        It has at least one held part.
    gap_deg : float
        How far apart the inner and the outer cone may be, with friction in space [deg].
    rests : bool
        Also which of its axis, lines and rays are strict minima of energy (`Region.rests`).
    friction : float, optional
        Coefficient of the contacts without a coefficient of their own [-].
    down : array_like, shape (3,), optional
        Direction of gravity, whose magnitude stays [-].
    ground : str or iterable of str
        Parts that are also held; ``*`` and ``?`` are wildcards.
    floor : bool or float, optional
        True adds a held table under the lowest point; a number is its height [length].
    contacts : ContactSet, optional
        Contacts of this assembly; by default they are detected from its geometry.
    tolerance : Tolerance, optional
        Tolerances of the detection: gap, angle and clearance. By default those of the
        assembly.
    time_limit : float, optional
        Time limit [s]. The clock is read between steps, so an answer at the limit may
        differ from run to run.
    progress : callable, optional
        Function that is called with the name of each stage.
    assume : {"drawn", "play", "fits", "joined"}, optional
        Rung of the ladder of assumptions about an inexact file: the drawn pose; parts move
        within their play until they rest; pairs that look fastened are joined, too; parts
        that touch are joined, too. The default is that of the saved choices, else play for
        files of simulators, else drawn.

    Raises
    ------
    TimeLimitReached
        At the time limit, with the verdict of the given direction, if nothing else is known. With
        friction the region that is known by then is returned, with its `gap_deg`.
    InputError
        If nothing is held, loads are given, the geometry is not usable, or `rests` are requested
        of parts that rub.

    See Also
    --------
    kilter.orient : the best direction only.
    kilter.common_region : the directions for which several assemblies hold.

    Examples
    --------
    >>> from kilter.scenes import scene, stacks
    >>> found = region(scene("paper-figure-10"))
    >>> found
    Region(fan, half angle 45 deg)
    >>> found.contains([[-1, 0, -1], [0, 0, 1]])
    array([ True, False])
    >>> rough = region(stacks.block_on_slope(0.0, friction=0.5))
    >>> rough.exact, round(rough.half_angle_deg, 1), rough.gap_deg < 0.1
    (False, 26.5, True)
    """

def report(
    assembly: AssemblyOrPath | Order | Places,
    out: str | Path | None = None,
    *,
    friction: float | None = None,
    down: ArrayLike | None = None,
    ground: str | Iterable[str] = (),
    floor: bool | float | None = None,
    title: str = "",
    margins: bool = False,
    moved: Mapping[str, Any] | None = None,
    turned: Mapping[str, Any] | None = None,
    command: str = "",
    contacts: ContactSet | None = None,
    tolerance: Tolerance | None = None,
    effort: float = 1.0,
    time_limit: float | None = None,
    progress: Callable[[str], None] | None = None,
) -> Report:
    """Build an offline page: the assembly in 3D, its motion and forces, the gravity ball.

    The page of a plan shows its steps as a film and as a strip of pictures, with the held parts.
    The page of a map of places shows the assembly and the map; the part follows the pointer.

    Parameters
    ----------
    assembly : Assembly, path, Order, or Places
        An `Order` of `kilter.plan` is shown unchanged; nothing is computed again. The page of
        `Places` of `kilter.place` is that of their assembly, with the map as a layer.
    out : path, optional
        File of the page, ending in .html.
    title : str
        Title of the page; by default the name of the file.
    margins : bool
        Compute margins even for more than 20 free parts; up to 20 the page always has them.
    moved, turned : mapping, optional
        Movements of supports, as in `Verdict.support_movement`: the page plays the movement that
        follows, magnified, with its hinges.
    command : str
        Command that reproduces the page, shown on it.
    friction : float, optional
        Coefficient of the contacts without a coefficient of their own [-].
    down : array_like, shape (3,), optional
        Direction of gravity, whose magnitude stays [-].
    ground : str or iterable of str
        Parts that are also held; ``*`` and ``?`` are wildcards.
    floor : bool or float, optional
        True adds a held table under the lowest point; a number is its height [length].
    contacts : ContactSet, optional
        Contacts of this assembly; by default they are detected from its geometry.
    tolerance : Tolerance, optional
        Tolerances of the detection: gap, angle and clearance. By default those of the
        assembly.
    effort : float
        Work limit; each further unit allows about ten times more work [-]. 0 is quick and
        1 is usual. Work is counted in operations, not in time.
    time_limit : float, optional
        Time limit [s]. The clock is read between steps, so an answer at the limit may
        differ from run to run.
    progress : callable, optional
        Function that is called with the name of each stage.

    Raises
    ------
    InputError
        If no part is held, the geometry is not usable, there are more than 50,000 parts, or the
        page cannot be written.

    See Also
    --------
    kilter.draw : a picture for a document.
    kilter.view : the workbench, which changes the assembly.

    Examples
    --------
    >>> from kilter.scenes import scene
    >>> report(scene("tower")).verdict
    'stable'
    """

def scene(
    assembly: AssemblyOrPath,
    *,
    friction: float | None = None,
    down: ArrayLike | None = None,
    ground: str | Iterable[str] = (),
    floor: bool | float | None = None,
    settle: bool = False,
    contacts: ContactSet | None = None,
    tolerance: Tolerance | None = None,
    require: str = "settles",
    effort: float = 1.0,
    time_limit: float | None = None,
    progress: Callable[[str], None] | None = None,
    assume: str | None = None,
) -> SceneReport:
    """Decide for each object of a scene whether it is at rest, floats, overlaps or falls.

    Clusters of objects that do not touch each other are judged separately, so that a fault of an
    object does not hide the states of the others.

    Parameters
    ----------
    assembly : Assembly, or path
        At least one part must be held.
    require : {"equilibrium", "settles", "proved", "strict"}
        Level from which the answer is yes. `SceneReport.at_rest` is true from this level.
    effort : float
        Work limit; each further unit allows about ten times more work [-]. It concerns each
        cluster.
    time_limit : float, optional
        Time limit [s]. Clusters that are not judged until then are open.
    settle : bool
        Whether to bring the objects to rest first, as `kilter.settle` does. The report is about
        the new poses; `SceneReport.drawn` has the old.
    friction : float, optional
        Coefficient of the contacts without a coefficient of their own [-].
    down : array_like, shape (3,), optional
        Direction of gravity, whose magnitude stays [-].
    ground : str or iterable of str
        Parts that are also held; ``*`` and ``?`` are wildcards.
    floor : bool or float, optional
        True adds a held table under the lowest point; a number is its height [length].
    contacts : ContactSet, optional
        Contacts of this assembly; by default they are detected from its geometry.
    tolerance : Tolerance, optional
        Tolerances of the detection: gap, angle and clearance. By default those of the
        assembly.
    progress : callable, optional
        Function that is called with the name of each stage.
    assume : {"drawn", "play", "fits", "joined"}, optional
        Rung of the ladder of assumptions about an inexact file: the drawn pose; parts move
        within their play until they rest; pairs that look fastened are joined, too; parts
        that touch are joined, too. The default is that of the saved choices, else play for
        files of simulators, else drawn.

    Returns
    -------
    SceneReport

    Raises
    ------
    InputError
        If no part is held, if an argument is invalid, or if the geometry is not usable.

    See Also
    --------
    kilter.check : a single verdict on the whole assembly.
    kilter.settle : moves the objects until they rest.

    Examples
    --------
    >>> from kilter import Assembly, Box, Part
    >>> table = Part("table", Box([4, 4, 1]), [0, 0, -0.5], grounded=True)
    >>> cubes = [Part(name, Box([1, 1, 1]), [x, 0, z]) for name, x, z in
    ...          [("at rest", -1.5, 0.5), ("floating", 0, 0.6), ("sunk", 1.5, 0.25)]]
    >>> report = scene(Assembly([table, *cubes]))
    >>> report
    <SceneReport: 4 objects, 1 at-rest, 1 held, 1 floats, 1 overlaps>
    >>> round(report["floating"].gap, 12), report["sunk"].gap, report["sunk"].other
    (0.1, -0.25, 'table')
    """

def settle(
    assembly: AssemblyOrPath,
    *,
    friction: float | None = None,
    down: ArrayLike | None = None,
    ground: str | Iterable[str] = (),
    floor: bool | float | None = None,
    reach: float | None = None,
    keep: str | Iterable[str] = (),
    nearest: bool = False,
    ease: bool = False,
    contacts: ContactSet | None = None,
    tolerance: Tolerance | None = None,
    require: str = "settles",
    effort: float = 1.0,
    time_limit: float | None = None,
    progress: Callable[[str], None] | None = None,
    assume: str | None = None,
) -> Settled:
    """Bring the parts of an assembly to rest: a pose that it can reach without gaining energy.

    Overlapping parts are pushed apart; then parts fall, tip, slide and roll until they rest or
    leave the scene. It is no claim about dynamics: a thrown or bouncing part may come to rest
    elsewhere.

    Parameters
    ----------
    assembly : Assembly, or path
        At least one part is held. Held parts do not move.
    reach : float, optional
        Largest way of a part [length unit]. By default it has no limit; with `nearest`, it is three
        times the widest gap or overlap of the drawn pose, and the answer states it.
    keep : str or iterable of str
        Parts that must not move although they are not held; ``*`` and ``?`` are wildcards.
    nearest : bool
        Whether to search for a pose at rest by the least motion instead.
    ease : bool
        Whether parts at rest slide on, by at most a tenth of their size, to where they need little
        friction: in a simulator with soft contacts, friction that holds a part creeps.
    require : {"equilibrium", "settles", "proved", "strict"}
        Level from which the answer is yes. `Settled.at_rest` is true from this level.
    friction : float, optional
        Coefficient of the contacts without a coefficient of their own [-].
    down : array_like, shape (3,), optional
        Direction of gravity, whose magnitude stays [-].
    ground : str or iterable of str
        Parts that are also held; ``*`` and ``?`` are wildcards.
    floor : bool or float, optional
        True adds a held table under the lowest point; a number is its height [length].
    contacts : ContactSet, optional
        Contacts of this assembly; by default they are detected from its geometry.
    tolerance : Tolerance, optional
        Tolerances of the detection: gap, angle and clearance. By default those of the
        assembly.
    effort : float
        Work limit; each further unit allows about ten times more work [-]. 0 is quick and
        1 is usual. Work is counted in operations, not in time.
    time_limit : float, optional
        Time limit [s]. The clock is read between steps, so an answer at the limit may
        differ from run to run.
    progress : callable, optional
        Function that is called with the name of each stage.
    assume : {"drawn", "play", "fits", "joined"}, optional
        Rung of the ladder of assumptions about an inexact file: the drawn pose; parts move
        within their play until they rest; pairs that look fastened are joined, too; parts
        that touch are joined, too. The default is that of the saved choices, else play for
        files of simulators, else drawn.

    Returns
    -------
    Settled

    Raises
    ------
    TimeLimitReached
        At the time limit.
    InputError
        If no part is held, or an argument is invalid.

    See Also
    --------
    kilter.check : the verdict on the drawn pose.
    kilter.place : the places where a next part stands.

    Examples
    --------
    >>> from kilter import Box, Part
    >>> table = Part("table", Box(4, 4, 1), [0, 0, -0.5], grounded=True)
    >>> box = Part("box", Box(1, 1, 1), [0, 0, 0.75])
    >>> answer = settle(Assembly([table, box]))
    >>> answer.state, answer.level, answer.distance.round(6).tolist()
    ('at-rest', 'proved', [0.0, 0.25])
    >>> answer.moved[0].way[0].how, answer["box"].pose.position.round(6)
    ('fell', array([0. , 0. , 0.5]))
    """

def settle_states(
    scene: Any,
    states: str | Path | ArrayLike,
    *,
    output: str | Path | None = None,
    reach: float | None = None,
    keep: str | Iterable[str] = (),
    nearest: bool = False,
    ease: bool = False,
    processes: int = 1,
    progress: Callable[[int, int], None] | None = None,
    tolerance: Tolerance | None = None,
    require: str = "settles",
    effort: float = 1.0,
    time_limit: float | None = None,
    **reading: Any,
) -> SettledStates:
    """Bring many states of a MuJoCo scene to rest, as `kilter.settle` does each of them.

    Parameters
    ----------
    scene : path or MjModel
        An MJCF file, a file of choices about one, or a model.
    states : path or array_like, shape (n, width)
        A row for each state: qpos; qpos and qvel; or time, qpos and qvel, with or without
        activations. A file is that of `numpy.save`, or holds a pickled array.
    output : path, optional
        A NumPy file for the new states. A later run continues an interrupted one.
    reach, keep, nearest, ease
        See `kilter.settle`.
    processes : int
        Number of worker processes.
    time_limit : float, optional
        Time limit for each state [s].
    progress : callable, optional
        Called with the number of finished states, and the number of all.
    **reading
        How the scene is read, as of `kilter.load`: `ground`, `floor`, `friction` and so on.
    tolerance : Tolerance, optional
        Tolerances of the detection: gap, angle and clearance. By default those of the
        assembly.
    require : {"equilibrium", "settles", "proved", "strict"}
        Level from which the answer is yes.
    effort : float
        Work limit; each further unit allows about ten times more work [-]. 0 is quick and
        1 is usual. Work is counted in operations, not in time.

    Returns
    -------
    SettledStates

    Raises
    ------
    InputError
        If the scene or the states cannot be read, do not belong together, or no body is free; or
        the output cannot be written, or has rows of another run.

    See Also
    --------
    kilter.settle : one state, with the complete answer.
    kilter.judge : why the bodies of one state move, by the contacts of MuJoCo.

    Examples
    --------
    >>> import mujoco
    >>> box = '<body pos="0 0 .2"><freejoint/><geom type="box" size=".1 .1 .1"/></body>'
    >>> scene = f'<mujoco><worldbody><geom type="plane" size="1 1 1"/>{box}</worldbody></mujoco>'
    >>> model = mujoco.MjModel.from_xml_string(scene)
    >>> answer = settle_states(model, [[0, 0, 0.2, 1, 0, 0, 0], [0.5, 0, 0.1, 1, 0, 0, 0]])
    >>> answer, answer.qpos[:, 2].round(9).tolist()
    (<SettledStates: 2 states, 2 at-rest>, [0.1, 0.1])
    """

def states(
    assembly: AssemblyOrPath,
    *,
    friction: float | None = None,
    down: ArrayLike | None = None,
    ground: str | Iterable[str] = (),
    floor: bool | float | None = None,
    accelerations: Iterable[ArrayLike] = (),
    contacts: ContactSet | None = None,
    tolerance: Tolerance | None = None,
    time_limit: float | None = None,
    progress: Callable[[str], None] | None = None,
    assume: str | None = None,
) -> States:
    """Prepare verdicts on all states of an assembly that is being built.

    Parameters
    ----------
    assembly : Assembly, or path
        Finished assembly; its grounded parts are held in every state in which they are present.
    time_limit : float, optional
        Time limit [s]. It ends the contact search, as in `kilter.contacts`.
    accelerations : iterable of array_like, shape (3,)
        Accelerations of the carrier at which a state must hold, besides at rest [m/s^2].
    friction : float, optional
        Coefficient of the contacts without a coefficient of their own [-].
    down : array_like, shape (3,), optional
        Direction of gravity, whose magnitude stays [-].
    ground : str or iterable of str
        Parts that are also held; ``*`` and ``?`` are wildcards.
    floor : bool or float, optional
        True adds a held table under the lowest point; a number is its height [length].
    contacts : ContactSet, optional
        Contacts of this assembly; by default they are detected from its geometry.
    tolerance : Tolerance, optional
        Tolerances of the detection: gap, angle and clearance. By default those of the
        assembly.
    progress : callable, optional
        Function that is called with the name of each stage.
    assume : {"drawn", "play", "fits", "joined"}, optional
        Rung of the ladder of assumptions about an inexact file: the drawn pose; parts move
        within their play until they rest; pairs that look fastened are joined, too; parts
        that touch are joined, too. The default is that of the saved choices, else play for
        files of simulators, else drawn.

    Raises
    ------
    InputError
        If the geometry is not usable, or an acceleration leaves the parts in free fall.

    See Also
    --------
    kilter.plan : a search for an order.
    kilter.check : the complete answer for one state.

    Examples
    --------
    >>> from kilter.scenes import scene
    >>> arch = states(scene("arch"))
    >>> arch.of().stable, arch.of("springer*").stable
    (True, True)
    >>> without = [name for name in arch.assembly.names if name != "voussoir-10"]
    >>> arch.of(without).stable
    False
    >>> arch.of(without, held=["voussoir-9", "voussoir-11"]).stable
    True
    """

def transport(
    assembly: AssemblyOrPath,
    *,
    friction: float | None = None,
    down: ArrayLike | None = None,
    ground: str | Iterable[str] = (),
    floor: bool | float | None = None,
    accelerate: ArrayLike | None = None,
    turn: CarrierMotion | None = None,
    code: str | None = None,
    forward: ArrayLike = (1.0, 0.0, 0.0),
    path: CarrierPath | None = None,
    polar: bool = True,
    collapse: bool = False,
    fc: float = 1.35,
    mu_range: tuple[float, float] | None = None,
    contacts: ContactSet | None = None,
    tolerance: Tolerance | None = None,
    require: str = "settles",
    effort: float = 1.0,
    time_limit: float | None = None,
    progress: Callable[[str], None] | None = None,
    assume: str | None = None,
) -> Transport:
    """Compute the accelerations of a carrier under which an assembly stays in place.

    Parameters
    ----------
    assembly : Assembly, or path
        Its frame is fixed in the carrier, and its held parts belong to the carrier. Loads and
        bonds are fixed in the carrier.
    accelerate : array_like, shape (3,), optional
        Is this acceleration of the carrier carried [m/s^2]?
    turn : CarrierMotion, optional
        Is this motion carried?
    code : str, optional
        Are the accelerations of this rule of load securing carried? See
        `kilter.analysis.transport.transport`.
    forward : array_like, shape (3,)
        Direction of travel, for `code`.
    path : CarrierPath, optional
        How many times as fast may the carrier follow this path?
    polar : bool
        Without a question: also the boundary of all horizontal accelerations.
    collapse : bool
        Without a question: also the collapse multipliers of horizontal forces, with participating
        mass and spectral acceleration (`kilter.analysis.transport.collapse`).
    fc : float
        Confidence factor FC of the spectral accelerations, at least 1 [-].
    mu_range : (float, float), optional
        Factors between which every friction coefficient varies. The least friction is the worst
        case of every limit, exactly; a level above "equilibrium" is decided at both ends.
    require : {"equilibrium", "settles", "proved"}
        Level from which the answer is yes. `Transport.carried` is true from this level.
    friction : float, optional
        Coefficient of the contacts without a coefficient of their own [-].
    down : array_like, shape (3,), optional
        Direction of gravity, whose magnitude stays [-].
    ground : str or iterable of str
        Parts that are also held; ``*`` and ``?`` are wildcards.
    floor : bool or float, optional
        True adds a held table under the lowest point; a number is its height [length].
    contacts : ContactSet, optional
        Contacts of this assembly; by default they are detected from its geometry.
    tolerance : Tolerance, optional
        Tolerances of the detection: gap, angle and clearance. By default those of the
        assembly.
    effort : float
        Work limit; each further unit allows about ten times more work [-]. 0 is quick and
        1 is usual. Work is counted in operations, not in time.
    time_limit : float, optional
        Time limit [s]. The clock is read between steps, so an answer at the limit may
        differ from run to run.
    progress : callable, optional
        Function that is called with the name of each stage.
    assume : {"drawn", "play", "fits", "joined"}, optional
        Rung of the ladder of assumptions about an inexact file: the drawn pose; parts move
        within their play until they rest; pairs that look fastened are joined, too; parts
        that touch are joined, too. The default is that of the saved choices, else play for
        files of simulators, else drawn.

    Raises
    ------
    InputError
        If several questions are given, a vector is invalid or leaves the plane of a planar
        assembly, the rule does not exist, the interval of friction is empty or negative, or the
        confidence factor is below 1.

    See Also
    --------
    kilter.margin : limits of tilt and push at rest.
    kilter.check : the verdict at rest.

    Examples
    --------
    >>> from kilter.scenes import stacks
    >>> answer = transport(stacks.block_on_slope(0.0, friction=0.4), polar=False)
    >>> round(answer.least.g, 6)
    0.4
    >>> question = transport(stacks.block_on_slope(0.0, friction=0.4), accelerate=[3.0, 0, 0])
    >>> question.carried, round(question.cases[0].factor, 4)
    (True, 1.308)
    """
