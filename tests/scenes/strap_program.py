"""Least share of the strength of straps by a program of its own, in numpy and scipy.linprog.

The program takes only contact points, normals and coefficients from kilter. The forces of straps
are computed here from their paths, piece by piece. Friction is in a pyramid inside Coulomb's cone,
which gives an upper bound of the share, or in a pyramid around it, which gives a lower bound.
"""

import itertools
import math

import numpy as np
from scipy.optimize import linprog

import kilter

__all__ = ["least_share"]


def strap_forces(strap: kilter.Strap) -> list[tuple[str, np.ndarray, np.ndarray]]:
    """Part, point and force at each point of a strap, by a walk from the tensioned end."""
    entries = [(name, np.asarray(point, float)) for name, point in strap.to_dict()["path"]]
    walk = entries[::-1] if strap.tensioned == "last" else entries
    pull, before, result = strap.tension, None, []
    for k, (name, point) in enumerate(walk):
        after = walk[k + 1][1] - point if k + 1 < len(walk) else None
        force = np.zeros(3)
        if before is not None:
            force = pull * (before - point) / math.dist(before, point)
        if before is not None and after is not None:
            cosine = (point - before) @ after / math.dist(before, point) / np.linalg.norm(after)
            pull *= math.exp(-strap.mu * math.acos(min(max(cosine, -1.0), 1.0)))
        if after is not None:
            force = force + pull * after / np.linalg.norm(after)
        result.append((name, point, force))
        before = point
    return result


def unit_pull(strap: kilter.Strap) -> list[tuple[str, np.ndarray, np.ndarray]]:
    """Part, point and force at the ends of each piece of a strap that pulls with 1 N."""
    path = [(name, np.asarray(p, float)) for name, p in strap.to_dict()["path"]]
    forces = []
    for (first, a), (last, b) in itertools.pairwise(path):
        along = (b - a) / math.dist(a, b)
        forces += [(first, a, along), (last, b, -along)]
    return forces


def least_share(assembly: kilter.Assembly, *, around: bool, sides: int = 48) -> float:
    """Least factor of all tensions and capacities at which forces balance; infinite for none."""
    touching = kilter.contacts(assembly)
    names = [part.name for part in assembly if not part.grounded]
    place = {name: 6 * k for k, name in enumerate(names)}
    centers = dict(zip(assembly.names, assembly.geometry.center, strict=True))
    masses = dict(zip(assembly.names, assembly.geometry.mass, strict=True))
    columns: list[np.ndarray] = []

    def column(forces: list[tuple[str, np.ndarray, np.ndarray]]) -> np.ndarray:
        """Forces and torques of some point forces on all free parts."""
        entry = np.zeros(6 * len(names))
        for name, point, force in forces:
            if name in place:
                at = place[name]
                entry[at : at + 3] += force
                entry[at + 3 : at + 6] += np.cross(point - centers[name], force)
        return entry

    angle = 2 * np.pi * np.arange(sides) / sides
    for k in range(len(touching.points)):
        patch = touching.point_patch[k]
        a, b = (assembly.names[i] for i in touching.patch_parts[patch])
        normal, mu = touching.normals[k], touching.patch_mu[patch]
        size = mu / math.cos(math.pi / sides) if around else mu
        first = np.cross(normal, np.eye(3)[np.abs(normal).argmin()])
        first /= np.linalg.norm(first)
        second = np.cross(normal, first)
        for t in angle:
            force = normal + size * (math.cos(t) * first + math.sin(t) * second)
            point = touching.points[k]
            columns.append(column([(b, point, force), (a, point, -force)]))
    tensioned = [strap for strap in assembly.straps if strap.tension is not None]
    direct = [strap for strap in assembly.straps if strap.tension is None]
    straps = sum((column(strap_forces(strap)) for strap in tensioned), np.zeros(6 * len(names)))
    weight = column([(name, centers[name], masses[name] * assembly.gravity) for name in names])
    unit = np.abs(weight).max()
    pulls = [column(unit_pull(strap)) for strap in direct]
    # s is in units of `scale`: all forces are then over the weight
    scale = unit / max([*np.abs(straps), *(strap.capacity for strap in direct)])
    matrix = np.column_stack([*columns, *pulls, straps * scale / unit])
    limits = np.zeros((len(pulls), matrix.shape[1]))  # each pull is at most s LC
    limits[:, len(columns) : -1] = np.eye(len(pulls))
    limits[:, -1] = [-strap.capacity * scale / unit for strap in direct]
    cost = np.zeros(matrix.shape[1])
    cost[-1] = 1.0
    answer = linprog(cost, limits, np.zeros(len(pulls)), matrix, -weight / unit, method="highs")
    return float(answer.fun * scale) if answer.status == 0 else math.inf
