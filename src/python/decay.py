#!/usr/bin/env python3
"""The library from Python: how fast impacts take the vibration away, for three mass ratios at once."""
from concurrent.futures import ThreadPoolExecutor

import numpy as np

import impact_damper


def decay(mass_ratio):
    run = impact_damper.run(mass_ratio=mass_ratio, restitution=0.6, x0=6, until_amplitude=0.5)
    return run.half_cycles["zero_crossing"], run.half_cycles["amplitude"]


mass_ratios = [0.01, 0.02, 0.04]
with ThreadPoolExecutor() as pool:  # runs release the interpreter lock, so they run in parallel
    for mass_ratio, (time, amplitude) in zip(mass_ratios, pool.map(decay, mass_ratios)):
        slope = np.polyfit(time, amplitude, 1)[0]
        print(f"mass ratio {mass_ratio}: amplitude 0.5 at time {time[-1]:.3f}, slope {slope / mass_ratio:.4f} mass ratios")
