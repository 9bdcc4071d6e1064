"""Flies motor speeds from standard input in RotorPy and prints attitude and velocity.

Input: lines `name value...` of parameters, then `fly dt`, then one line of rotor speeds (rad/s)
per step. RotorPy is used with x forward or north, y left or west, z up; so are the numbers here.
Output per step: w x y z of the attitude and x y z of the velocity.
"""

import sys

import numpy as np
from rotorpy.vehicles.multirotor import Multirotor

GRAVITY = 9.80665


def read_parameters(lines):
    parameters = {}
    for line in lines:
        name, *values = line.split()
        parameters[name] = [float(value) for value in values]
        if name == "fly":
            return parameters
    raise SystemExit("the input has no line `fly dt`")


def vehicle(parameters):
    one = {name: values[0] for name, values in parameters.items()}
    count = int(one["motors"])
    hubs = np.array(parameters["hubs"]).reshape(count, 3)
    drag = parameters["drag"]
    inertia = parameters["inertia"]
    return {
        "mass": one["mass"],
        "Ixx": inertia[0], "Iyy": inertia[1], "Izz": inertia[2],
        "Ixy": 0.0, "Ixz": 0.0, "Iyz": 0.0,
        "c_Dx": drag[0], "c_Dy": drag[1], "c_Dz": drag[2],
        "num_rotors": count,
        "rotor_pos": {f"r{i}": hub for i, hub in enumerate(hubs)},
        "rotor_directions": np.array(parameters["spins"]),
        "rotor_speed_min": 0.0, "rotor_speed_max": 1e9,
        "k_eta": one["thrust"], "k_m": one["torque"],
        "k_d": one["across"], "k_z": one["along"],
        "tau_m": one["lag"],
    }


def main():
    lines = iter(sys.stdin)
    parameters = read_parameters(lines)
    commands = [np.array([float(x) for x in line.split()]) for line in lines if line.strip()]
    state = {
        "x": np.zeros(3), "v": np.zeros(3), "q": np.array([0.0, 0.0, 0.0, 1.0]),
        "w": np.zeros(3), "wind": np.array(parameters["wind"]), "rotor_speeds": commands[0],
    }
    drone = Multirotor(
        vehicle(parameters), state, aero=True,
        integrator_kwargs={"method": "RK45", "rtol": 1e-7, "atol": 1e-9},
    )
    drone.g = GRAVITY
    drone.weight = np.array([0.0, 0.0, -drone.mass * GRAVITY])
    for speeds in commands:
        state = drone.step(state, {"cmd_motor_speeds": speeds}, parameters["fly"][0])
        x, y, z, w = state["q"]
        print(w, x, y, z, *state["v"])


main()
