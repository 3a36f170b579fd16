"""Slow independent oracle: contacts by brute force over triangles, verdicts by an LP.

It shares nothing with the library but the vertices and triangles of `Assembly.geometry`.
"""

import itertools
from dataclasses import dataclass

import numpy as np
from scipy.optimize import linprog

PLANE = 1e-9
"""Largest distance of coplanar facets [length unit]; scenes have sizes of order 1."""


@dataclass
class Touching:
    """Contact points: parts a and b, position, unit normal from a to b."""

    a: np.ndarray
    b: np.ndarray
    x: np.ndarray
    n: np.ndarray
    mu: np.ndarray
    gap: np.ndarray
    pairs: set
    pressed: list
    """Bonds by area: parts a and b, the middle of a piece of the area, the force on b."""


def touching(assembly, *, scale=1.0):
    """Contact points of all opposing coplanar pairs of triangles; given contacts too."""
    geometry = assembly.geometry
    corners = geometry.vertices[geometry.triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    low, high = corners.min(axis=1) - PLANE * scale, corners.max(axis=1) + PLANE * scale
    part = geometry.triangle_part
    given = {frozenset(map(assembly.index_of, c.parts)) for c in assembly.contacts}
    stress = {frozenset(map(assembly.index_of, bond.parts)): bond for bond in assembly.bonds}
    rows, pressed = [], []
    for t in range(len(corners)):
        near = (low <= high[t]).all(axis=1) & (high >= low[t]).all(axis=1) & (part > part[t])
        near &= normals @ normals[t] < -1 + 1e-9
        near &= np.abs((corners[:, 0] - corners[t, 0]) @ normals[t]) < PLANE * scale
        for s in np.flatnonzero(near):
            if frozenset((part[t], part[s])) in given:
                continue
            points = clip(corners[t], corners[s][::-1], normals[t])
            if len(points) > 2 and area(points) > 1e-9 * scale**2:
                gap = np.abs((corners[s] - corners[t, 0]) @ normals[t]).max()
                mu = friction_of(assembly, part[t], part[s])
                rows += [(part[t], part[s], p, normals[t], mu, gap) for p in points]
                if bond := stress.get(frozenset((part[t], part[s]))):
                    force = -bond.pull_per_area * area(points) * normals[t]
                    pressed.append((part[t], part[s], middle(points), force))
    for c in assembly.contacts:
        a, b = map(assembly.index_of, c.parts)
        mu = friction_of(assembly, a, b) if c.mu is None else c.mu
        rows += [(a, b, p, c.normal, mu, 0.0) for p in c.points]
    if assembly.planar:
        rows = [row for row in rows if abs(row[3][1]) < 0.5]
    a, b, x, n, mu, gap = ([row[k] for row in rows] for k in range(6))
    pairs = {(int(i), int(j)) for i, j in zip(a, b, strict=True)}
    return Touching(
        np.array(a, dtype=int), np.array(b, dtype=int),
        np.array(x).reshape(-1, 3), np.array(n).reshape(-1, 3),
        np.array(mu), np.array(gap), pairs, pressed,
    )  # fmt: skip


def friction_of(assembly, a, b):
    names = {assembly.names[a], assembly.names[b]}
    own = [pair.mu for pair in assembly.friction_pairs if set(pair.parts) == names]
    return own[0] if own else assembly.friction


def clip(subject, window, normal):
    """Intersection of two convex polygons, both counterclockwise about `normal`."""
    points = list(subject)
    for p, q in zip(window, np.roll(window, -1, axis=0), strict=True):
        inward = np.cross(normal, q - p)
        inward /= np.linalg.norm(inward)
        inside = [float((x - p) @ inward) for x in points]
        kept = []
        for k, x in enumerate(points):
            j = (k + 1) % len(points)
            if inside[k] >= -1e-12:
                kept.append(x)
            if (inside[k] > 1e-12 and inside[j] < -1e-12) or (
                inside[k] < -1e-12 and inside[j] > 1e-12
            ):
                t = inside[k] / (inside[k] - inside[j])
                kept.append(x + t * (points[j] - x))
        points = kept
        if not points:
            break
    return np.array(points)


def area(points):
    p = points - points[0]
    return 0.5 * float(np.linalg.norm(np.cross(p[:-1], p[1:]).sum(axis=0)))


def middle(points):
    """Centroid of a convex polygon, from the triangles about its first corner."""
    fan = [(points[0], p, q) for p, q in itertools.pairwise(points[1:])]
    sizes = [float(np.linalg.norm(np.cross(p - o, q - o))) for o, p, q in fan]
    return np.average(np.mean(fan, axis=1), axis=0, weights=sizes)


def given_load(assembly, pressed):
    """Loads, and bonds at full strength as loads, in units of |g|; shape (N, 6)."""
    center = assembly.geometry.center
    forces = [
        (k, load.force, load.torque, center[k] if load.point is None else load.point)
        for load in assembly.loads
        for k in [assembly.index_of(load.part)]
    ]
    for a, b, x, force in pressed:
        forces += [(a, -force, np.zeros(3), x), (b, force, np.zeros(3), x)]
    load = np.zeros((len(center), 6))
    for k, force, torque, x in forces:
        load[k] += np.append(force, torque + np.cross(x - center[k], force))
    return load / np.linalg.norm(assembly.gravity)


def program(assembly):
    """Rows of J dp >= 0 and the load w in units of |g|, without held parts."""
    geometry = assembly.geometry
    c = touching(assembly)
    jacobian = np.zeros((len(c.a), len(geometry.mass), 6))
    rows = np.arange(len(c.a))
    for sign, part in ((-1.0, c.a), (1.0, c.b)):
        jacobian[rows, part, :3] += sign * c.n
        jacobian[rows, part, 3:] += sign * np.cross(c.x - geometry.center[part], c.n)
    load = np.zeros((len(geometry.mass), 6))
    load[:, :3] = geometry.mass[:, None] * assembly.down
    load += given_load(assembly, c.pressed)
    free = ~geometry.grounded
    axes = [0, 2, 4] if assembly.planar else list(range(6))
    jacobian = jacobian[:, free][:, :, axes].reshape(len(c.a), int(free.sum()) * len(axes))
    return jacobian, load[free][:, axes].reshape(-1)


def lp9(assembly):
    """Optimal z and an optimal dp of the displacement program, for gravity of length 1."""
    jacobian, load = program(assembly)
    result = linprog(
        -load, A_ub=-jacobian if len(jacobian) else None,
        b_ub=np.zeros(len(jacobian)) if len(jacobian) else None, bounds=(-1, 1), method="highs-ds",
        options={"primal_feasibility_tolerance": 1e-10, "dual_feasibility_tolerance": 1e-10},
    )  # fmt: skip
    assert result.status == 0
    return float(result.fun), result.x


def imbalance(assembly):
    """Least |J^T f + w|_1 over f >= 0, in units of the weight and of the size of the parts."""
    jacobian, load = program(assembly)
    geometry = assembly.geometry
    size = geometry.size[~geometry.grounded].max()
    per_part = 3 if assembly.planar else 6
    unit = np.ones(per_part)
    unit[2 if assembly.planar else 3 :] = size
    scale = np.tile(unit, len(load) // per_part) * np.abs(load).sum()
    matrix, right = (jacobian / scale).T, -load / scale
    m, n = matrix.shape
    result = linprog(
        np.concatenate([np.zeros(n), np.ones(2 * m)]),
        A_eq=np.hstack([matrix, np.eye(m), -np.eye(m)]), b_eq=right, bounds=(0, None),
        method="highs-ds", options={"primal_feasibility_tolerance": 1e-10},
    )  # fmt: skip
    assert result.status == 0
    return float(result.fun)


def stable(assembly):
    """Whether contact forces without friction balance every part (to 1e-8 of the weight)."""
    return imbalance(assembly) < 1e-8


def least_motion(assembly):
    """Optimum of the displacement program of least 2-norm, by projection onto its optimal face."""
    import clarabel
    from scipy import sparse

    jacobian, load = program(assembly)
    z, _ = lp9(assembly)
    n = len(load)
    rows = np.vstack([-load, -jacobian, np.eye(n), -np.eye(n)])
    right = np.concatenate([[z], np.zeros(len(jacobian)), np.ones(2 * n)])
    cones = [clarabel.ZeroConeT(1), clarabel.NonnegativeConeT(len(rows) - 1)]
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    solver = clarabel.DefaultSolver(
        sparse.csc_matrix(np.eye(n)), np.zeros(n), sparse.csc_matrix(rows), right, cones, settings
    )
    return np.array(solver.solve().x)


def gauss(assembly):
    """First accelerations of the free parts in 3D, in units of |g|; shape (n, 6)."""
    import clarabel
    from scipy import linalg, sparse

    jacobian, load = program(assembly)
    geometry = assembly.geometry
    free = np.flatnonzero(~geometry.grounded)
    blocks = [linalg.block_diag(geometry.mass[k] * np.eye(3), geometry.inertia[k]) for k in free]
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    solver = clarabel.DefaultSolver(
        sparse.csc_matrix(np.triu(linalg.block_diag(*blocks))), -load,
        sparse.csc_matrix(-jacobian), np.zeros(len(jacobian)),
        [clarabel.NonnegativeConeT(len(jacobian))], settings,
    )  # fmt: skip
    return np.array(solver.solve().x).reshape(-1, 6)


def neutral(assembly):
    """Dimensions of the neutral motions: two-sided, and additional one-sided motions."""
    jacobian, load = program(assembly)
    scaled = load / np.abs(load).max()
    two_sided = null_space(np.vstack([jacobian, scaled]))
    found = two_sided
    while True:  # LPs with costs outside the span found so far
        rest = null_space(found.T) if found.shape[1] else np.eye(len(load))
        new = [_costless(jacobian, scaled, cost) for cost in _trials(rest)]
        new = [dp for dp in new if np.abs(rest.T @ dp).max(initial=0) > 1e-7]
        if not new:
            return two_sided.shape[1], found.shape[1] - two_sided.shape[1]
        found = np.linalg.qr(np.column_stack([found, rest @ (rest.T @ new[0])]))[0]


def _trials(rest):
    random = np.random.default_rng(0).normal(size=(rest.shape[1], 4))
    for column in np.hstack([rest, rest @ random]).T:
        yield column
        yield -column


def _costless(jacobian, load, cost):
    result = linprog(
        -cost, A_ub=-jacobian, b_ub=np.zeros(len(jacobian)), A_eq=load[None], b_eq=[0],
        bounds=(-1, 1), method="highs-ds",
    )  # fmt: skip
    return result.x


def null_space(matrix):
    _, s, vt = np.linalg.svd(matrix)
    rank = int((s > 1e-9 * max(s.max(initial=0), 1)).sum())
    return vt[rank:].T


def frictional(assembly, *, push=None, sides=32):
    """Imbalance or load factor with friction, for inscribed friction pyramids (exact if planar).

    Without `push`: the least imbalance over the weight. With `push`: the largest load factor of a
    body force along `push`, in units of each part's weight.
    """
    geometry = assembly.geometry
    c = touching(assembly)
    around = np.arange(sides) * 2 * np.pi / sides
    u = np.cross(c.n, [0.0, 1.0, 0.0])
    along_y = np.linalg.norm(u, axis=1) < 1e-9
    u[along_y] = [1.0, 0.0, 0.0]
    u /= np.linalg.norm(u, axis=1, keepdims=True)
    v = np.cross(c.n, u)
    if assembly.planar:
        around = np.array([0.0, np.pi])
    tangent = np.cos(around)[:, None, None] * u + np.sin(around)[:, None, None] * v
    rays = c.n + c.mu[:, None] * tangent
    size = float(geometry.size[~geometry.grounded].max())
    rows = np.zeros((len(around), len(c.a), len(geometry.mass), 6))
    points = np.arange(len(c.a))
    for sign, part in ((-1.0, c.a), (1.0, c.b)):
        rows[:, points, part, :3] += sign * rays
        rows[:, points, part, 3:] += sign * np.cross(c.x - geometry.center[part], rays) / size
    weight = np.zeros((2, len(geometry.mass), 6))
    weight[0, :, :3] = geometry.mass[:, None] * assembly.down
    if push is not None:
        weight[1, :, :3] = geometry.mass[:, None] * np.asarray(push, dtype=float)
    for load in assembly.loads:
        weight[0, assembly.index_of(load.part), :3] += load.force / np.linalg.norm(assembly.gravity)
    free = ~geometry.grounded
    axes = [0, 2, 4] if assembly.planar else list(range(6))
    count = int(free.sum()) * len(axes)
    matrix = rows[:, :, free][..., axes].reshape(-1, count)
    load, side = (weight[:, free][..., axes] / geometry.mass[free].sum()).reshape(2, count)
    if push is not None:
        cost = np.zeros(len(matrix) + 1)
        cost[-1] = -1.0
        equations = np.column_stack([matrix.T, side])
    else:
        cost = np.concatenate([np.zeros(len(matrix)), np.ones(2 * count)])
        equations = np.hstack([matrix.T, np.eye(count), -np.eye(count)])
    result = linprog(cost, A_eq=equations, b_eq=-load, bounds=(0, None), method="highs")
    if push is not None and result.status != 0:
        return None
    assert result.status == 0
    return abs(float(result.fun))


def solids(assembly):
    """Vertices, triangles, face normals and edge directions of each part, without duplicates."""
    g = assembly.geometry
    found = []
    for k in range(len(g.mass)):
        v = g.vertices[g.vertex_start[k] : g.vertex_start[k + 1]]
        t = g.triangles[g.triangle_start[k] : g.triangle_start[k + 1]] - g.vertex_start[k]
        n = np.cross(v[t[:, 1]] - v[t[:, 0]], v[t[:, 2]] - v[t[:, 0]])
        n /= np.linalg.norm(n, axis=1, keepdims=True)
        e = (v[np.roll(t, -1, axis=1)] - v[t]).reshape(-1, 3)
        found.append((v, t, distinct(n), distinct(e / np.linalg.norm(e, axis=1, keepdims=True))))
    return found


def distinct(directions):
    return np.unique(directions.round(9) + 0.0, axis=0)


def overlapping(assembly, *, scale=1.0):
    """Pairs of parts with common volume; at least one part of a pair is convex."""
    parts = solids(assembly)
    convex = [
        bool(all(((v - v[f[0]]) @ np.cross(v[f[1]] - v[f[0]], v[f[2]] - v[f[0]])).max() < 1e-9
                 * scale for f in t))
        for v, t, _, _ in parts
    ]  # fmt: skip
    wrong = []
    for i, j in itertools.combinations(range(len(parts)), 2):
        if assembly.parts[i].grounded and assembly.parts[j].grounded:
            continue
        p, q = parts[i][0], parts[j][0]
        slack = 1e-9 * scale
        if (p.min(axis=0) >= q.max(axis=0) - slack).any() or (
            q.min(axis=0) >= p.max(axis=0) - slack
        ).any():
            continue
        assert convex[i] or convex[j]
        if convex[i] and convex[j]:
            apart = separated(p, q, parts[i][2:], parts[j][2:], slack)
        else:
            shell, body = (parts[i], parts[j]) if convex[j] else (parts[j], parts[i])
            apart = outside(shell, body, slack)
        if not apart:
            wrong.append((assembly.names[i], assembly.names[j]))
    return wrong


def outside(shell, body, slack):
    """Whether a convex body is outside a shell: no triangle cuts it, its middle is outside."""
    v, t = shell[:2]
    for f in t:
        normal = np.cross(v[f[1]] - v[f[0]], v[f[2]] - v[f[0]])[None]
        edges = np.roll(v[f], -1, axis=0) - v[f]
        if not separated(v[f], body[0], (normal, edges), body[2:], slack):
            return False
    return abs(winding(v[t], body[0].mean(axis=0))) < 0.5


def winding(triangles, point):
    p, q, r = np.moveaxis(triangles - point, 1, 0)
    a, b, c = (np.linalg.norm(x, axis=1) for x in (p, q, r))
    dot = [(x * y).sum(axis=1) for x, y in ((p, q), (q, r), (r, p))]
    top = (p * np.cross(q, r)).sum(axis=1)
    bottom = a * b * c + dot[0] * c + dot[1] * a + dot[2] * b
    return float(np.arctan2(top, bottom).sum() / (2 * np.pi))


def separated(p, q, faces_p, faces_q, slack):
    """Whether a plane along a face, or along an edge of each body, separates two convex bodies."""
    (normals_p, edges_p), (normals_q, edges_q) = faces_p, faces_q
    crosses = np.cross(edges_p[:, None], edges_q[None]).reshape(-1, 3)
    directions = np.vstack([normals_p, normals_q, crosses])
    length = np.linalg.norm(directions, axis=1)
    directions = directions[length > 1e-7] / length[length > 1e-7, None]
    a, b = p @ directions.T, q @ directions.T
    gap = np.maximum(a.min(axis=0) - b.max(axis=0), b.min(axis=0) - a.max(axis=0))
    return bool(gap.max() > -slack)
