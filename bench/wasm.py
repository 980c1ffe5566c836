#!/usr/bin/env python3
"""The package for browsers and node beside the library: what a whole decay takes in each, as a ratio.

    wasm.py TIMER PACKAGE SCENE...       TIMER is decay_time

Both run by turns, in processes of their own, and what took least counts. The results are the same to the last bit
(make wasm-check), so the error is, too. Half cycles are recorded.
"""
import subprocess
import sys
from pathlib import Path

ROUNDS, COUNT = 7, 50
HERE = Path(__file__).resolve().parent


def timed(*command) -> tuple:
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True, check=True)
    time, end = map(float, done.stdout.split())
    return time, end


def main(timer: Path, package: Path, scenes: list):
    print("| scene | library | node | ratio |\n|---|---|---|---|")
    for scene in scenes:
        native, node = [], []
        for _ in range(ROUNDS):
            native.append(timed(timer, scene, COUNT))
            node.append(timed("node", HERE / "decay_time.mjs", package, scene, COUNT))
        if len({end for _, end in native + node}) != 1:
            sys.exit(f"{scene}: the decays end at different times")
        one, other = min(native)[0], min(node)[0]
        print(f"| {Path(scene).stem} | {one:.2f} ms | {other:.2f} ms | {other / one:.1f} |")


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]), sys.argv[3:])
