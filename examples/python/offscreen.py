#!/usr/bin/env python3
"""Renders a built-in hairstyle into an array, by pelage.h through ctypes: no compiler and no package is needed.

    python3 examples/python/offscreen.py [--library target/release/libpelage.so] [--out picture.ppm] [--strands N]

The picture is a NumPy array of height x width x 4 floats, linear and premultiplied, which the library writes into in
place; without NumPy it is a flat ctypes array.
"""

import argparse
import pathlib
import sys

import pelage
from pelage import numpy

WIDTH, HEIGHT = 480, 640


def render(library, strands):
    """The picture: HEIGHT x WIDTH x 4 floats."""
    with pelage.Context(library) as context:
        hair = context.builtin(pelage.PELAGE_BUILTIN_WAVY, strands)
        target = context.target(WIDTH, HEIGHT)
        # The head's origin lies between the ears; it looks along +z, in metres.
        view = library.perspective((0.6, 0.15, -0.75), (0, -0.06, 0), (0, 1, 0), 0.5, WIDTH / HEIGHT, 0.1, 10.0)
        sun = pelage.Light(direction=(-0.9, -0.8, 0.2), power=(3.0, 3.0, 3.0))
        context.render([hair], [sun], view, target, ambient=(0.05, 0.05, 0.05))
        return target.colour()


def ppm(pixels):
    """The bytes of a PPM file: hair over a grey wall, in the sRGB curve."""
    header = f"P6\n{WIDTH} {HEIGHT}\n255\n".encode()
    if numpy is not None:
        over = (pixels[..., :3] + (1.0 - pixels[..., 3:]) * 0.18).clip(0.0, 1.0).astype(numpy.float64)
        curve = numpy.where(over <= 0.0031308, 12.92 * over, 1.055 * over ** (1.0 / 2.4) - 0.055)
        return header + (255.0 * curve + 0.5).astype(numpy.uint8).tobytes()

    def srgb(value):
        v = min(max(value, 0.0), 1.0)
        return int(255.0 * (12.92 * v if v <= 0.0031308 else 1.055 * v ** (1.0 / 2.4) - 0.055) + 0.5)

    body = bytearray()
    for at in range(0, len(pixels), 4):
        wall = (1.0 - pixels[at + 3]) * 0.18
        body.extend(srgb(pixels[at + channel] + wall) for channel in range(3))
    return header + bytes(body)


def main():
    default = pathlib.Path(__file__).resolve().parents[2] / "target/release/libpelage.so"
    arguments = argparse.ArgumentParser(description="Renders a built-in hairstyle into an array.")
    arguments.add_argument("--library", default=default)
    arguments.add_argument("--out", default="offscreen.ppm")
    arguments.add_argument("--strands", type=int, default=50_000)
    given = arguments.parse_args()
    try:
        library = pelage.Library(given.library)
        pixels = render(library, given.strands)
    except (pelage.Error, OSError) as error:
        sys.exit(str(error))
    kind = f"a NumPy array of {pixels.shape}, {pixels.dtype}" if numpy is not None else "a ctypes array: no NumPy here"
    pathlib.Path(given.out).write_bytes(ppm(pixels))
    print(f"pelage {library.version()}: {given.strands} strands in {kind}; wrote {given.out}")


if __name__ == "__main__":
    main()
