"""The options of reading a file, declared once: names, values, help, and their types.

The command line has an option for each field with a declaration. `kilter.files.reading.Reading`
applies them, `kilter.load` has most of them as keywords, and a file of choices saves them.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from kilter.values.declaration import option

HELD = "Held parts, gravity, friction and materials"
TOUCH = "Contacts and their tolerances"
SAVED = "Saved choices"


@dataclass(frozen=True)
class ReadingOptions:
    """The user's options for reading a file that change the assembly; a proof lists them.

    The options of `load`, and those of `kilter.fastened`: pairs of part names to join
    (`fasten`), whether to join pairs that look fastened, whether to join pairs that overlap.
    Each entry of `bond` has two part names and a pull [N]. `floor` is a height [length unit] or
    `LOWEST`.

    `mass` has name patterns and masses [kg], `load` names of parts and the components of a force at
    the centre of mass [N]. `accelerate` is the acceleration of a carrier to which the held parts
    belong, as text: m/s^2, or g as in "0.5g"; the assembly then feels gravity less it.

    `entries` are the keys of choices without an option, as JSON data (`kilter.files.own.choices`).
    `saved` names the options that come from choices: the parts that they name may be missing.
    `off` names the saved options that are ignored, and `release` saved held parts that are not
    held (`kilter.files.own.choices_writing`). After a merge with choices, `release` applies to the
    parts that the saved wildcards of `ground` match.
    """

    ground: tuple[str, ...] = option(
        "--ground NAME...",
        "Hold these parts, so that they cannot move. Repeatable; * and ? are wildcards.",
        HELD,
        default=(),
    )
    floor: float | str | None = option(
        "--floor [HEIGHT]",
        "Add a held table under the lowest point, or at this height (file units). It lies "
        "across the up direction of the file.",
        HELD,
        reads="height_of",
    )
    without: tuple[str, ...] = option(
        "--without NAME...",
        "Leave these parts out, for a half-built assembly. Repeatable; * and ? are wildcards.",
        HELD,
        default=(),
    )
    down: tuple[float, float, float] | None = option(
        "--down X Y Z",
        "Direction of gravity. Its size in the file is kept. A floor turns with the parts.",
        HELD,
    )
    friction: float | None = option(
        "--friction MU",
        "Friction coefficient of contacts without a coefficient of their own; it replaces the"
        " default of the file. 30% and 17deg are 0.3 and tan 17 deg.",
        HELD,
        reads="friction_of",
    )
    units: str | None = option(
        "--units m|cm|mm|in",
        "Unit of length of a file that does not name its unit; mm by default for STL, else m.",
        HELD,
    )
    density: float | None = option(
        "--density KG/M3",
        "Density of the parts without a density in the file, or of all parts of a STEP file "
        "[kg/m^3]; 1000 by default. Names such as steel or oak are known.",
        HELD,
        reads="density_of",
    )
    fasten: tuple[tuple[str, str], ...] = option(
        "--fasten NAME NAME",
        "Join two parts rigidly. Repeatable. With * and ? every two matching parts that touch"
        ' are joined, as in --fasten "bolt*" "nut*"; held parts must have their full name.',
        HELD,
        default=(),
    )
    fasten_suggested: bool = option(
        "--fasten-suggested",
        "Join all pairs that look fastened, and list them: screws in threads, press fits, "
        "inserts and other overlaps.",
        HELD,
    )
    fasten_overlaps: bool = option(
        "--fasten-overlaps", "Join all pairs of parts that overlap, and list them.", HELD
    )
    assume: str | None = option(
        "--assume drawn|play|fits|joined",
        "What counts beside the drawn pose. drawn: nothing. play: parts move within their play "
        "until they rest. fits: and threads, press fits and inserts are joined. joined: and parts "
        "that touch or overlap are joined. play by default for files of simulators, else drawn.",
        TOUCH,
    )
    keep_copies: bool = option(
        "--keep-copies",
        "CAD and mesh files only: keep bodies that are in the file twice; by default a copy, or a "
        "step of a feature beside its result, is left out.",
        HELD,
    )
    up: str | None = option(
        "--up x|y|z|-x|-y|-z", "The axis of the file that points up; z by default.", HELD
    )
    contacts: str | None = option(
        "--contacts file|geometry",
        "file: use only the contacts in the file (interfaces of COMPAS). geometry: detect all"
        " contacts.",
        TOUCH,
    )
    keyframe: str | None = option(
        "--keyframe NAME",
        "MJCF only: use the pose of this keyframe; the first keyframe by default.",
        HELD,
    )
    state: str | None = option(
        "--state FILE[:ROW]",
        "MJCF only: use the state in this row of a file of states (.npy, .npz, or a pickled array "
        "such as .pruned_init); row 0 by default. A row is qpos, or a full state.",
        HELD,
    )
    model: str | None = option(
        "--model NAME", "LDraw only: build this model of the file; the first by default.", HELD
    )
    base: str | None = option(
        "--base fixed|floating", "URDF only: whether the root link is held; fixed by default.", HELD
    )
    loose_robots: bool = option(
        "--loose-robots",
        "MJCF and URDF: free the bodies that motors move; by default they are held.",
        HELD,
    )
    stud_pull: float | None = option(
        "--stud-pull N",
        "Bricks only: pull that each of the three or four points of a stud resists [N]; 0.98 "
        "N by default.",
        HELD,
    )
    stud_shear: float | str | None = option(
        "--stud-shear unlimited|mu|N",
        "Bricks only: sideways force that each point of a stud resists: any force, friction "
        "only (mu), or up to this force [N]; unlimited by default.",
        HELD,
        reads="number_or_word",
    )
    brick_sides: str | None = option(
        "--brick-sides lower-edge|face|none",
        "Bricks only: where neighbours in a layer can push each other; lower-edge by default.",
        HELD,
    )
    bond: tuple[tuple[str, str, float], ...] = option(
        "--bond NAME NAME T",
        "Bond two parts: each contact point between them also resists a pull up to T [N] and "
        "any shear force. Repeatable; * and ? as in --fasten.",
        HELD,
        default=(),
    )
    entries: Mapping[str, Any] = field(default_factory=dict)
    saved: tuple[str, ...] = ()
    off: tuple[str, ...] = option(
        "--off OPTION...",
        "Ignore the saved values of these options: --off floor loose, or --no-floor "
        "--no-loose. Repeatable.",
        SAVED,
        default=(),
        reads="option_name",
    )
    release: tuple[str, ...] = option(
        "--release NAME...",
        "Do not hold these parts, which the saved choices hold. Repeatable; * and ? are wildcards.",
        SAVED,
        default=(),
    )
    mass: tuple[tuple[str, float], ...] = option(
        "--mass NAME=KG",
        'Mass of a part, in place of its density: --mass "bolt*=0.2". Repeatable; * and ? are'
        " wildcards.",
        HELD,
        default=(),
        reads="mass_of",
    )
    load: tuple[tuple[str, float, float, float], ...] = option(
        "--load NAME=FX,FY,FZ",
        "Add a force at the centre of mass of a part [N]: --load lid=0,0,-20. Repeatable; * "
        "and ? are wildcards.",
        HELD,
        default=(),
        reads="load_of",
    )
    accelerate: tuple[str, str, str] | None = option(
        "--accelerate X Y Z",
        "The held parts belong to a carrier with this acceleration, in m/s^2, or in g as 0.5g.",
        HELD,
    )
