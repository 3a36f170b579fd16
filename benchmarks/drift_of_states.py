"""Simulate states of a MuJoCo model for 2 s, and print how far each object moves.

    python drift_of_states.py scene.xml states.npy          states: rows qpos
    python drift_of_states.py scene.xml states.npy --seconds 5
    python drift_of_states.py scene.xml states.npy --finer 20       a twentieth of the time step

The friction of soft contacts creeps under load; with shorter steps, MuJoCo also removes this creep.
It needs NumPy and MuJoCo only, of any version, so that an audit can run it by several interpreters.
Objects are bodies with a joint that no motor drives. Joints with motors stay in place, like those
of a robot whose controller holds it. The first line of the output is the version of MuJoCo. Each
further line belongs to a state: the displacement of the centre of mass of each object [m], and its
rotation [deg], both between the first and the last moment, as JSON; and the objects with a contact
of the engine that lies outside of them (`outside`), which is a fault of its collision detection.
"""

import argparse
import json

import mujoco
import numpy as np

MOTORS_AT_JOINTS = (int(mujoco.mjtTrn.mjTRN_JOINT), int(mujoco.mjtTrn.mjTRN_JOINTINPARENT))
WITHOUT_SLIP = 20
"""Number of iterations in each shorter step that remove the creep of soft friction."""
OUTSIDE = 1e-3
"""Distance of a contact from the bounding sphere of its geom from which it is false [m]."""
WIDTHS = {0: (7, 6), 1: (4, 3), 2: (1, 1), 3: (1, 1)}
"""Numbers of positions and of velocities of a joint: free, ball, slide, hinge."""


def driven_joints(model):
    """Joints that a motor drives; shape (n,)."""
    at_joints = np.isin(model.actuator_trntype, MOTORS_AT_JOINTS)
    return np.unique(model.actuator_trnid[at_joints, 0])


def places(model, joints):
    """Indices of the positions and of the velocities of some joints."""
    positions, velocities = [], []
    for joint in joints:
        wide, quick = WIDTHS[int(model.jnt_type[joint])]
        positions += range(model.jnt_qposadr[joint], model.jnt_qposadr[joint] + wide)
        velocities += range(model.jnt_dofadr[joint], model.jnt_dofadr[joint] + quick)
    return np.array(positions, dtype=int), np.array(velocities, dtype=int)


def false_contacts(model, data):
    """Bodies with a contact outside of the bounding sphere of the geom that it belongs to."""
    found = set()
    for geoms in (data.contact.geom1, data.contact.geom2):
        away = np.linalg.norm(data.contact.pos - data.geom_xpos[geoms], axis=1)
        radii = model.geom_rbound[geoms]
        false = geoms[(radii > 0) & (away > radii + OUTSIDE)]
        found.update(model.geom_bodyid[false].tolist())
    return found


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("model", help="MJCF file")
    parser.add_argument("states", help=".npy file, shape (n, nq)")
    parser.add_argument("--seconds", type=float, default=2.0, help="simulated time [s]")
    parser.add_argument("--finer", type=float, default=1.0, help="divisor of the time step")
    options = parser.parse_args()
    model = mujoco.MjModel.from_xml_path(options.model)
    if options.finer > 1:
        model.opt.timestep /= options.finer
        model.opt.noslip_iterations = WITHOUT_SLIP
    held = driven_joints(model)
    positions, velocities = places(model, held)
    loose = np.setdiff1d(np.arange(model.njnt), held)
    bodies = np.unique(model.jnt_bodyid[loose])
    names = [mujoco.mj_id2name(model, mujoco.mjtObj.mjOBJ_BODY, int(body)) for body in bodies]
    print(json.dumps(mujoco.__version__), flush=True)
    for state in np.load(options.states):
        data = mujoco.MjData(model)
        data.qpos[:] = state
        mujoco.mj_forward(model, data)
        centers, turns = data.xipos[bodies].copy(), data.xquat[bodies].copy()
        outside = set()
        while data.time < options.seconds:
            mujoco.mj_step(model, data)
            outside |= false_contacts(model, data)
            data.qpos[positions], data.qvel[velocities] = state[positions], 0.0
        mujoco.mj_kinematics(model, data)
        mujoco.mj_comPos(model, data)
        moved = np.linalg.norm(data.xipos[bodies] - centers, axis=1)
        cosine = np.clip(np.abs(np.sum(data.xquat[bodies] * turns, axis=1)), 0.0, 1.0)
        turned = np.degrees(2 * np.arccos(cosine))
        row = {
            "moved": {name: moved[k] for k, name in enumerate(names)},
            "turned_deg": {name: turned[k] for k, name in enumerate(names)},
            "outside": [names[k] for k, body in enumerate(bodies) if int(body) in outside],
        }
        print(json.dumps(row), flush=True)


if __name__ == "__main__":
    main()
