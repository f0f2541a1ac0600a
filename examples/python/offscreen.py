#!/usr/bin/env python3
"""Renders a built-in hairstyle into an array, by pelage.h through ctypes: no compiler and no package is needed.

    python3 examples/python/offscreen.py [--library target/release/libpelage.so] [--out picture.ppm] [--strands N]

The picture is a NumPy array of height x width x 4 floats, linear and premultiplied, which the library writes into in
place; without NumPy it is a flat ctypes array.
"""

import argparse
import ctypes
import pathlib
import sys

try:
    import numpy
except ImportError:
    numpy = None

WIDTH, HEIGHT = 480, 640

# The constants and structs of pelage.h that are used here. Every struct begins with its size, by which the library checks
# that this file and the header agree.
PELAGE_OK = 0
PELAGE_ABI_VERSION = 0
PELAGE_BUILTIN_WAVY = 1
PELAGE_RENDER_CLEAR = 1


class Described(ctypes.Structure):
    """A struct that begins with its size; as PELAGE_..._INIT, but for the fields that are given."""

    def __init__(self, **fields):
        super().__init__(struct_size=ctypes.sizeof(self), **fields)


class ContextDescriptor(Described):
    _fields_ = [
        ("struct_size", ctypes.c_uint32),
        ("force_software", ctypes.c_uint32),
        ("validation", ctypes.c_uint32),
        ("reserved", ctypes.c_uint32),
        ("byte_budget", ctypes.c_uint64),
    ]


class TargetDescriptor(Described):
    _fields_ = [
        ("struct_size", ctypes.c_uint32),
        ("width", ctypes.c_uint32),
        ("height", ctypes.c_uint32),
        ("format", ctypes.c_uint32),
        ("with_depth", ctypes.c_uint32),
        ("outputs", ctypes.c_uint32),
    ]


class View(Described):
    _fields_ = [
        ("struct_size", ctypes.c_uint32),
        ("flags", ctypes.c_uint32),
        ("view_from_world", ctypes.c_double * 16),
        ("clip_from_view", ctypes.c_double * 16),
        ("previous_view_from_world", ctypes.c_double * 16),
        ("previous_clip_from_view", ctypes.c_double * 16),
        ("jitter", ctypes.c_float * 2),
        ("previous_jitter", ctypes.c_float * 2),
        ("rectangle", ctypes.c_uint32 * 4),
    ]


class Light(Described):
    _fields_ = [
        ("struct_size", ctypes.c_uint32),
        ("kind", ctypes.c_uint32),
        ("direction", ctypes.c_double * 3),
        ("position", ctypes.c_double * 3),
        ("power", ctypes.c_float * 3),
        ("reserved", ctypes.c_uint32),
        ("shadow", ctypes.c_void_p),
    ]


class Handle(ctypes.Structure):
    """A context, a hair or a target."""

    _fields_ = [("id", ctypes.c_uint64)]


class Frame(Described):
    _fields_ = [
        ("struct_size", ctypes.c_uint32),
        ("hair_count", ctypes.c_uint32),
        ("hairs", ctypes.POINTER(Handle)),
        ("lights", ctypes.POINTER(Light)),
        ("view", ctypes.POINTER(View)),
        ("transparency", ctypes.c_void_p),
        ("light_count", ctypes.c_uint32),
        ("ambient", ctypes.c_float * 3),
    ]


class Error(Exception):
    """A call that failed; its text is the library's sentence."""


class Library:
    """The shared library: its functions, checked."""

    def __init__(self, path):
        self._library = ctypes.CDLL(str(path))
        self._library.pelage_last_error.restype = ctypes.c_char_p
        self._library.pelage_version.restype = ctypes.c_char_p
        version = self._library.pelage_abi_version()
        if version != PELAGE_ABI_VERSION:
            raise Error(f"the library's ABI has version {version}, this program was written for {PELAGE_ABI_VERSION}")

    def version(self):
        return self._library.pelage_version().decode()

    def call(self, name, *arguments):
        """Calls a function that returns a PelageResult."""
        if getattr(self._library, "pelage_" + name)(*arguments) != PELAGE_OK:
            raise Error(self._library.pelage_last_error().decode())


def make(library, name, *arguments):
    """Calls a function that fills a handle, its last argument."""
    handle = Handle()
    library.call(name, *arguments, ctypes.byref(handle))
    return handle


def doubles(*values):
    return (ctypes.c_double * len(values))(*values)


def render(library, strands):
    """The picture: HEIGHT x WIDTH x 4 floats."""
    device = ContextDescriptor()
    context = make(library, "context_create", ctypes.byref(device))
    try:
        wavy = ctypes.c_uint32(PELAGE_BUILTIN_WAVY)
        hair = make(library, "hair_create_builtin", context, wavy, ctypes.c_uint64(strands))
        image = TargetDescriptor(width=WIDTH, height=HEIGHT)
        target = make(library, "target_create", context, ctypes.byref(image))

        # The head's origin lies between the ears; it looks along +z, in metres.
        eye, middle, up = doubles(0.6, 0.15, -0.75), doubles(0.0, -0.06, 0.0), doubles(0.0, 1.0, 0.0)
        lens = [ctypes.c_double(value) for value in (0.5, WIDTH / HEIGHT, 0.1, 10.0)]
        view = View()
        library.call("view_perspective", eye, middle, up, *lens, ctypes.byref(view))
        sun = Light(direction=doubles(-0.9, -0.8, 0.2), power=(3.0, 3.0, 3.0))
        frame = Frame(
            hair_count=1,
            hairs=ctypes.pointer(hair),
            light_count=1,
            lights=ctypes.pointer(sun),
            view=ctypes.pointer(view),
            ambient=(0.05, 0.05, 0.05),
        )
        library.call("render", context, ctypes.byref(frame), target, ctypes.c_uint32(PELAGE_RENDER_CLEAR))

        if numpy is not None:
            pixels = numpy.empty((HEIGHT, WIDTH, 4), numpy.float32)
            address = pixels.ctypes.data_as(ctypes.c_void_p)
        else:
            pixels = (ctypes.c_float * (HEIGHT * WIDTH * 4))()
            address = pixels
        library.call("target_read_colour", target, address, ctypes.c_uint64(HEIGHT * WIDTH * 16))
        return pixels
    finally:
        # And with it the hair and the target.
        library.call("context_destroy", context)


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
        library = Library(given.library)
        pixels = render(library, given.strands)
    except (Error, OSError) as error:
        sys.exit(str(error))
    kind = f"a NumPy array of {pixels.shape}, {pixels.dtype}" if numpy is not None else "a ctypes array: no NumPy here"
    pathlib.Path(given.out).write_bytes(ppm(pixels))
    print(f"pelage {library.version()}: {given.strands} strands in {kind}; wrote {given.out}")


if __name__ == "__main__":
    main()
