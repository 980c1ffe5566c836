#!/usr/bin/env python3
"""Makes data/examples/mast_measured.csv: a decay of the mast as a transducer would have recorded it.

    make_record.py > mast_measured.csv
    make_record.py KEY=VALUE...         other numbers than those of NUMBERS

Runge and Kutta's fourth-order rule with rigid walls, impacts bisected within a step; no code is shared with the program.
"""
import math
import random
import sys

NUMBERS = {
    "mass": 40.0, "stiffness": 16000.0, "secondary_mass": 1.6,  # kg, N/m, kg: as in mast.json
    "clearance": 11.5, "restitution": 0.52, "damping_ratio": 0.003,  # mm: what mast.json does not know
    "initial_displacement": 58.0, "seconds": 24.0, "samples_per_second": 100.0,
    "derivative": 0,  # of the displacement that is recorded: 2 is an acceleration, by its mean between two samples
    "noise": 0.08, "offset": 1.5, "drift": 1.0,  # mm, mm/s or mm/s^2, as all that follows
    "resolution": 0.01, "range": 55.0,  # the transducer's steps, and where it clips
    "gap_from": 9.0, "gap_to": 9.35,  # s, without samples
    "time_factor": 1.0, "seed": 1,
}


def decay(n):
    """Displacement in mm and velocity in mm/s at each sample."""
    nu, zeta, e = n["secondary_mass"] / n["mass"], n["damping_ratio"], n["restitution"]
    unit = math.sqrt(n["mass"] / n["stiffness"])
    step = 0.004
    state = (n["initial_displacement"] / n["clearance"], 0.0, 0.0, 0.0)
    stuck = 0  # -1: to the left wall, 1: to the right one

    def rates(s):
        x, v, _, w = s
        a = -(x + 2 * zeta * v) / (1 + nu if stuck else 1)
        return (v, a, 0.0, 0.0) if stuck else (v, a, w, -a)

    def stepped(s, h):
        def plus(f, k):
            return tuple(p + f * q for p, q in zip(s, k))
        a = rates(s)
        b = rates(plus(h / 2, a))
        c = rates(plus(h / 2, b))
        d = rates(plus(h, c))
        return tuple(p + h / 6 * (k + 2 * l + 2 * m + o) for p, k, l, m, o in zip(s, a, b, c, d))

    def goes_on(s):
        return rates(s)[1] * stuck < 0 if stuck else 0 <= s[2] <= 1

    def last_of(h):
        low, high = 0.0, h
        for _ in range(50):
            middle = (low + high) / 2
            if goes_on(stepped(state, middle)):
                low = middle
            else:
                high = middle
        return high

    if rates(state)[1] > 0:
        stuck = -1  # the wall pushes the mass
    time, samples = 0.0, []
    for i in range(int(n["seconds"] * n["samples_per_second"]) + 1):
        until = i / n["samples_per_second"] / unit
        while time < until:
            h = min(step, until - time)
            following = stepped(state, h)
            if goes_on(following):
                state, time = following, time + h
                continue
            h = last_of(h)
            x, v, y, w = stepped(state, h)
            time += h
            if stuck:
                state, stuck = (x, v, 0.0 if stuck < 0 else 1.0, 0.0), 0
                continue
            wall = -1 if y < 0.5 else 1
            v, w = v + nu * (1 + e) * w / (1 + nu), -e * w
            state = (x, v, 0.0 if wall < 0 else 1.0, w)
            push = -rates(state)[1] * wall  # of the relative acceleration, into the wall
            if push > 0 and abs(w) < 1e-3 * push:
                state, stuck = (x, v + nu * w / (1 + nu), state[2], 0.0), wall
        samples.append((state[0] * n["clearance"], state[1] * n["clearance"] / unit))
    return samples


def main():
    n = dict(NUMBERS)
    for word in sys.argv[1:]:
        key, value = word.split("=")
        n[key] = type(NUMBERS[key])(value)
    noise = random.Random(n["seed"])
    rate, derivative = n["samples_per_second"], n["derivative"]
    samples, begin = [each[min(derivative, 1)] for each in decay(n)], 0
    if derivative == 2:
        samples, begin = [(after - before) * rate for before, after in zip(samples, samples[1:])], 0.5
    print("t_s," + ("x_mm", "v_mm_per_s", "a_mm_per_s2")[derivative])
    for i, x in enumerate(samples):
        t = (i + begin) / rate
        x += n["offset"] + n["drift"] * t / n["seconds"] + noise.gauss(0, n["noise"])
        x = max(-n["range"], min(n["range"], round(x / n["resolution"]) * n["resolution"]))
        if not n["gap_from"] <= t < n["gap_to"]:
            t *= n["time_factor"]
            print(f"{t:.2f},{x:.2f}" if rate == 100 and n["time_factor"] == 1 else f"{t:.6f},{x:.2f}")


if __name__ == "__main__":
    main()
