"""Figures of answers: the assembly with its motion or forces, the stable region on the sphere.

Each function takes an answer and returns a matplotlib figure, which a notebook displays. The
figures compute nothing that the answer does not contain. Gravity points down on the page.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from kilter.arrays import Array
from kilter.rigid import quaternion_to_matrix, rotation_between
from kilter.show.canvas import legend, new_figure, title
from kilter.show.overlay import (
    draw_fall,
    draw_forces,
    draw_gravity,
    draw_motion,
    draw_names,
    draw_patches,
    draw_straps,
)
from kilter.show.painter import Camera
from kilter.show.solids import draw_parts, moved_points
from kilter.show.sphere import draw_region

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from kilter.analysis.verdict.verdict import Verdict
    from kilter.assembly import Assembly

__all__ = ["VIEW", "camera_of", "draw_assembly", "draw_picture", "draw_region", "picture_limits"]


VIEW = (-32.0, 22.0)
"""Default azimuth and elevation of the eye [deg]."""
FRONT = (0.0, 0.0)
"""Azimuth and elevation for planar assemblies [deg]: x to the right, z up."""
WIDTH, HEIGHT = 7.0, 5.6
"""Size of the figure [inch]."""
SPACE = (0.89, 0.76)
"""Width and height of the picture [size of the figure]."""
MARGIN = 0.06
"""Margin around the assembly [size of the picture]."""
HELD_IN_VIEW = 0.35
"""Distance beyond the free parts at which held parts are cut off [size of the free parts]."""
ARROW = 0.24
"""Length of the longest arrow, and displacement of the farthest ghost [size of the picture]."""
NAMED = 14
"""Largest number of parts whose names are written by default."""
PATCHES = 30
"""Largest number of contact patches that are drawn by default."""


def draw_assembly(
    verdict: Verdict,
    *,
    view: tuple[float, float] | None = None,
    names: bool | None = None,
    contacts: bool | None = None,
    fall: Array | None = None,
) -> Figure:
    """Draw the parts with their impending motion, or with the contact forces that balance them.

    Arguments: `view`: azimuth (to the right of -y) and elevation of the eye [deg], with gravity
    down; `fall` (N, 6): end of the fall of a balanced assembly: shift [length unit] and rotation
    vector [rad] of each part. Raises `InputError` if matplotlib is not installed.
    """
    assembly = verdict.assembly
    contacts = len(verdict.contact_set) <= PATCHES if contacts is None else contacts
    picture = draw_picture(assembly, view)
    figure, axes, camera, size, entries, _ = picture
    if contacts:
        entries += draw_patches(axes, verdict, camera)
    entries += draw_straps(axes, assembly, camera)
    drawn = set(axes.get_children())
    if verdict.moving:
        entries += draw_motion(axes, verdict, camera, ARROW * size)
    elif verdict.forces is not None:
        radius = assembly.geometry.radius[verdict.program.free]
        longest = min(ARROW * size, 2 * float(radius.max(initial=0.0)) or ARROW * size)
        entries += draw_forces(axes, verdict, camera, longest)
    if fall is not None:
        entries += draw_fall(axes, verdict, camera, fall)
    show_whole(figure, axes, [each for each in axes.get_children() if each not in drawn])
    return picture.completed(assembly, verdict.sentence, verdict.verdict, names=names)


class PartsPicture(NamedTuple):
    """A figure with the parts of an assembly, to which an answer adds its marks."""

    figure: Figure
    axes: Axes
    camera: Camera
    size: float
    """Larger side of the picture [length unit]."""
    entries: list[tuple[Any, str]]
    """Entries of the legend."""
    faces: list[tuple[int, Array]]
    """Part and outline of each visible face."""

    def completed(
        self, assembly: Assembly, sentence: str, verdict: str = "", *, names: bool | None = None
    ) -> Figure:
        """Add the names of few parts, gravity, the sentence and the legend; return the figure."""
        if len(assembly.parts) <= NAMED if names is None else names:
            draw_names(self.axes, assembly, self.faces)
        draw_gravity(self.axes, self.camera)
        title(self.figure, sentence, verdict)
        legend(self.figure, self.entries)
        return self.figure


def draw_picture(
    assembly: Assembly, view: tuple[float, float] | None, motion: Array | None = None
) -> PartsPicture:
    """Draw the parts of an assembly into a new figure.

    Arguments: `view`: azimuth and elevation of the eye [deg]; None for the default view; `motion`
    (N, 6): small motion of the parts after which they are drawn.
    """
    figure = new_figure(WIDTH, HEIGHT)
    axes = figure.add_axes((0.09, 0.11, *SPACE))
    axes.set_axis_off()
    camera = camera_of(assembly, view)
    low, high = picture_limits(assembly, camera, _picture_shape(figure), motion)
    size = float((high - low).max())
    axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), aspect="equal")
    entries, faces = draw_parts(axes, assembly, camera, size, motion=motion)
    return PartsPicture(figure, axes, camera, size, entries, faces)


def camera_of(assembly: Assembly, view: tuple[float, float] | None) -> Camera:
    """Camera for a view, which also turns the assembly so that gravity points down on the page."""
    azimuth, elevation = view or (FRONT if assembly.planar else VIEW)
    return Camera.at(azimuth, elevation, _upright(assembly))


def side_view(assembly: Assembly, across: Array) -> tuple[float, float]:
    """The view along a horizontal axis, shape (3,), as azimuth and elevation of the eye [deg]."""
    x, y, _ = _upright(assembly) @ across
    azimuth = float(np.degrees(np.arctan2(x, -y)))
    return azimuth - 180 * np.sign(azimuth) * (abs(azimuth) > 90), 0.0


def _upright(assembly: Assembly) -> Array:
    """Rotation matrix that turns an assembly so that gravity acts along -z."""
    if np.allclose(assembly.down[:2], 0.0) and assembly.down[2] > 0:
        # upside down: the shortest rotation is not unique, so turn about the axis of sight
        return np.diag([-1.0, 1.0, -1.0])
    return quaternion_to_matrix(rotation_between(assembly.down, [0.0, 0.0, -1.0]))


def picture_limits(
    assembly: Assembly, camera: Camera, shape: Array, motion: Array | None = None
) -> tuple[Array, Array]:
    """Lower left and upper right corner of a picture, around free parts and nearby held parts.

    Arguments: `shape` (2,): width and height of the picture, in any unit; `motion` (N, 6): small
    motion of the parts, which the picture shows before and after it.
    """
    geometry = assembly.geometry
    corners, owner = geometry.vertices, geometry.vertex_part
    if motion is not None:
        corners = np.append(corners, moved_points(assembly, motion, corners, owner), axis=0)
        owner = np.append(owner, owner)
    flat = camera.flat(corners)
    free = ~geometry.grounded[owner]
    wanted = flat[free] if free.any() else flat
    low, high = wanted.min(axis=0), wanted.max(axis=0)
    reach = HELD_IN_VIEW * float((high - low).max())
    low = np.maximum(flat.min(axis=0), low - reach)
    high = np.minimum(flat.max(axis=0), high + reach)
    return _fitting(low, high, shape, 1 + 2 * MARGIN)


def _picture_shape(figure: Figure) -> Array:
    """Width and height of the picture in a figure [inch]."""
    return np.asarray(np.array(SPACE) * figure.get_size_inches())


def _fitting(low: Array, high: Array, shape: Array, margin: float) -> tuple[Array, Array]:
    """Corners of the least picture of a shape around a rectangle with a margin."""
    middle, half = (low + high) / 2, (high - low) / 2 * margin
    half = shape * max(float((half / shape).max()), 1e-300)
    return middle - half, middle + half


def show_whole(figure: Figure, axes: Axes, artists: Iterable[Artist]) -> None:
    """Widen the limits of a picture so that arrows and displaced parts are not cut."""
    limits = np.array([axes.get_xlim(), axes.get_ylim()]).T
    boxes = np.array([artist.get_window_extent().get_points() for artist in artists])
    boxes = boxes[np.isfinite(boxes).all(axis=(1, 2))] if len(boxes) else boxes
    if not len(boxes):
        return
    corners = axes.transData.inverted().transform(
        [boxes[:, 0].min(axis=0), boxes[:, 1].max(axis=0)]
    )
    low, high = np.minimum(corners[0], limits[0]), np.maximum(corners[1], limits[1])
    if (low < limits[0]).any() or (high > limits[1]).any():
        low, high = _fitting(low, high, _picture_shape(figure), 1 + MARGIN / 2)
        axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]))
