#!/usr/bin/env python3
"""Guides that swing, followed by hair on the GPU, and what is written beside the colour: depth, coverage, motion, ids.

    python3 examples/python/moving.py [--library target/release/libpelage.so] [--out motion.ppm] [--steps N]

Prints a line a step, and writes the last step's motion: red to the right, green downwards, grey where there is none.
"""

import argparse
import math
import pathlib
import sys

import pelage

SIDE = 192
GUIDES, POINTS, LENGTH = 12, 9, 0.6
IDENTITY = (1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1)
ALL = (
    pelage.PELAGE_OUTPUT_NEAREST_DEPTH
    | pelage.PELAGE_OUTPUT_COVERAGE
    | pelage.PELAGE_OUTPUT_MOTION
    | pelage.PELAGE_OUTPUT_IDS
)


def guides(angle):
    """Guides that hang in a row and are bent aside by an angle, three numbers a point."""
    positions = []
    for guide in range(GUIDES):
        for point in range(POINTS):
            along = LENGTH * point / (POINTS - 1)
            bent = angle * point / (POINTS - 1)
            left = 0.05 * (guide - (GUIDES - 1) / 2)
            positions += [left + along * math.sin(bent), LENGTH / 2 - along * math.cos(bent), 0.0]
    return positions


def moved(x, z=0.0):
    """A transform that moves by x and z."""
    return IDENTITY[:12] + (x, 0.0, z, 1)


def flat(values):
    """A flat list of what may be a NumPy array."""
    return values.ravel().tolist() if hasattr(values, "ravel") else list(values)


def run(library, steps):
    """Draws the steps, and yields what each shows."""
    with pelage.Context(library) as context:
        hair = context.guided_clumps(guides(0.0), [POINTS] * GUIDES, 0.002, followers=60, root_radius=0.03)
        # A second copy behind, which stands where it is while the first one comes nearer.
        target = context.target(SIDE, SIDE, ALL)
        view = library.perspective((0, 0, 1.6), (0, 0, 0), (0, 1, 0), 0.6, 1.0, 0.1, 10.0)
        sun = pelage.Light(direction=(-0.3, -0.6, -0.8), power=(3.0, 3.0, 3.0))
        for step in range(steps):
            if step > 0:
                hair.update_guides(guides(0.15 * step))
            near, before = 0.05 * step, 0.05 * max(step - 1, 0)
            hair.set_instances(moved(0, near) + moved(0.1, -0.3), moved(0, before) + moved(0.1, -0.3))
            context.render([hair], [sun], view, target, ambient=(0.1, 0.1, 0.1))
            yield [flat(read()) for read in (target.nearest_depth, target.coverage, target.motion, target.ids)]


def ppm(motion, coverage):
    """The bytes of a PPM file: 4 pixels of motion are the brightest."""
    body = bytearray()
    for at in range(SIDE * SIDE):
        for axis in range(2):
            level = 0.5 + motion[2 * at + axis] / 8.0 if coverage[at] > 0.0 else 0.25
            body.append(int(255.0 * min(max(level, 0.0), 1.0) + 0.5))
        body.append(64)
    return f"P6\n{SIDE} {SIDE}\n255\n".encode() + bytes(body)


def main():
    default = pathlib.Path(__file__).resolve().parents[2] / "target/release/libpelage.so"
    arguments = argparse.ArgumentParser(description="Moves guides, and reads outputs beside the colour.")
    arguments.add_argument("--library", default=default)
    arguments.add_argument("--out", default="motion.ppm")
    arguments.add_argument("--steps", type=int, default=4)
    given = arguments.parse_args()
    try:
        library = pelage.Library(given.library)
        for number, (depth, coverage, motion, ids) in enumerate(run(library, given.steps)):
            hit = [at for at in range(SIDE * SIDE) if ids[2 * at + 1] != pelage.PELAGE_NO_STRAND]
            fastest = max((math.hypot(motion[2 * at], motion[2 * at + 1]) for at in hit), default=0.0)
            strands = len({ids[2 * at + 1] for at in hit})
            copies = len({ids[2 * at] >> 16 for at in hit})
            nearest = min((depth[at] for at in hit), default=1.0)
            print(
                f"step {number}: {len(hit)} pixels of {strands} strands in {copies} copies, covered {sum(coverage):.0f}, "
                f"nearest at depth {nearest:.4f}, up to {fastest:.2f} px of motion"
            )
            pathlib.Path(given.out).write_bytes(ppm(motion, coverage))
    except (pelage.Error, OSError) as error:
        sys.exit(str(error))


if __name__ == "__main__":
    main()
