"""`kilter.scene`: the state of each object of a scene.

Objects that do not touch each other do not affect each other. So a scene is divided into clusters:
connected components of the contact graph over the free parts. Each cluster is judged by itself.

1. A cluster without a contact to a held part floats. Its height is that of a fall to the first
   contact (`falling_distance`); all of its objects have this height.
2. `kilter.check` judges each other cluster. If the cluster holds, its objects are at rest at the
   level of the verdict, with its certificate.
3. If it does not hold, the moving objects fall. A moving object in free fall floats.
4. If overlaps leave it undecided, the overlapping objects are the fault; of other open pairs,
   their moving objects are open.
5. The other objects of the cluster are judged again, while the objects with a fault are held where
   they are drawn and overlaps have no contact. `SceneObject.if_held` names these objects.

An overlap of two free parts is reported once: for the part with the higher lowest point, of equally
high parts for the smaller part.
"""

from __future__ import annotations

from kilter.analysis.scene_states.played_scene import played_scene
from kilter.analysis.scene_states.scene_report import SceneReport
from kilter.analysis.scene_states.settled_scene import settled_scene
from kilter.assembly.question import Question, question
from kilter.contact import detect
from kilter.tell.levels import require_level


@question(own_rungs=True)
def scene(
    asked: Question,
    *,
    settle: bool = False,
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
    require = require_level(asked.require, strict=True)
    asked.assembly.require_grounded()
    if settle:
        return settled_scene(asked.but(require=require))
    contacts = detect.touching(asked)
    return played_scene(asked.but(contacts=contacts, require=require))
