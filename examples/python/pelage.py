"""pelage.h by ctypes, as far as the examples beside this file use it: a library, contexts, hairs and targets.

Arrays go in as anything that ctypes or NumPy makes a flat array of, and come out as NumPy arrays that the library has written
into in place; without NumPy as flat ctypes arrays. Calls that fail raise Error with the library's sentence. Objects are
destroyed by their destroy(), or with their context.
"""

import ctypes

try:
    import numpy
except ImportError:
    numpy = None

# The constants and structs of pelage.h. Every struct begins with its size, by which the library checks that this file and the
# header agree.
PELAGE_OK = 0
PELAGE_ABI_VERSION = 0
PELAGE_BUILTIN_WAVY = 1
PELAGE_RENDER_CLEAR = 1
PELAGE_OUTPUT_NEAREST_DEPTH = 1
PELAGE_OUTPUT_COVERAGE = 2
PELAGE_OUTPUT_MOTION = 4
PELAGE_OUTPUT_IDS = 8
PELAGE_NO_STRAND = 0xFFFFFFFF


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


class Strands(Described):
    _fields_ = [
        ("struct_size", ctypes.c_uint32),
        ("curve", ctypes.c_uint32),
        ("positions", ctypes.POINTER(ctypes.c_float)),
        ("point_count", ctypes.c_uint64),
        ("counts", ctypes.POINTER(ctypes.c_uint32)),
        ("strand_count", ctypes.c_uint64),
        ("radii", ctypes.c_void_p),
        ("colours", ctypes.c_void_p),
        ("coordinates", ctypes.c_void_p),
        ("root_radius", ctypes.c_float),
        ("tip_radius", ctypes.c_float),
    ]


class ClumpSettings(Described):
    _fields_ = [
        ("struct_size", ctypes.c_uint32),
        ("seed", ctypes.c_uint32),
        ("followers", ctypes.c_uint32),
        ("root_radius", ctypes.c_float),
        ("tip_factor", ctypes.c_float),
        ("stray_fraction", ctypes.c_float),
        ("stray_strength", ctypes.c_float),
        ("reserved", ctypes.c_uint32),
    ]


class HairInfo(Described):
    _fields_ = [
        ("struct_size", ctypes.c_uint32),
        ("curve", ctypes.c_uint32),
        ("strand_count", ctypes.c_uint64),
        ("point_count", ctypes.c_uint64),
        ("low", ctypes.c_float * 3),
        ("high", ctypes.c_float * 3),
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
            raise Error(f"the library's ABI has version {version}, this file was written for {PELAGE_ABI_VERSION}")

    def version(self):
        return self._library.pelage_version().decode()

    def call(self, name, *arguments):
        """Calls a function that returns a PelageResult."""
        if getattr(self._library, "pelage_" + name)(*arguments) != PELAGE_OK:
            raise Error(self._library.pelage_last_error().decode())

    def perspective(self, eye, target, up, vertical_fov, aspect, near, far):
        """A view from `eye` towards `target`, three numbers each."""
        view = View()
        lens = [ctypes.c_double(value) for value in (vertical_fov, aspect, near, far)]
        self.call("view_perspective", doubles(eye), doubles(target), doubles(up), *lens, ctypes.byref(view))
        return view


def array(kind, values):
    """A ctypes array of what may be a NumPy array of any shape, or a flat sequence."""
    values = values.ravel().tolist() if hasattr(values, "ravel") else list(values)
    return (kind * len(values))(*values)


def doubles(values):
    return array(ctypes.c_double, values)


def empty(shape, kind):
    """An array that the library is to fill: its address, its bytes, and itself."""
    count = 1
    for side in shape:
        count *= side
    size = ctypes.c_uint64(count * ctypes.sizeof(kind))
    if numpy is None:
        made = (kind * count)()
        return made, size, made
    made = numpy.empty(shape, numpy.dtype(kind))
    return made.ctypes.data_as(ctypes.c_void_p), size, made


class _Object:
    """What a handle is for."""

    def __init__(self, library, kind, handle):
        self.library, self._kind, self.handle = library, kind, handle

    def _call(self, name, *arguments):
        self.library.call(f"{self._kind}_{name}", self.handle, *arguments)

    def destroy(self):
        """Destroys the object, and a context with all that was made on it."""
        self._call("destroy")


class Hair(_Object):
    def info(self):
        info = HairInfo()
        self._call("info", ctypes.byref(info))
        return info

    def points(self):
        """Points x 3, as the CPU gave them last."""
        address, size, values = empty((self.info().point_count, 3), ctypes.c_float)
        self._call("points", address, size)
        return values

    def update_points(self, positions):
        """Three numbers a point."""
        given = array(ctypes.c_float, positions)
        self._call("update_points", given, ctypes.c_uint64(len(given) // 3))

    def update_guides(self, positions):
        """Three numbers a point of the guides, of a hair that remembers them."""
        given = array(ctypes.c_float, positions)
        self._call("update_guides", given, ctypes.c_uint64(len(given) // 3))

    def rest(self):
        """The points have not moved since the frame before."""
        self._call("rest")

    def set_transform(self, world_from_object):
        """Sixteen numbers, column-major."""
        self._call("set_transform", doubles(world_from_object))

    def set_previous_transform(self, world_from_object):
        """Where the hair was in the frame before; None: where it is."""
        self._call("set_previous_transform", None if world_from_object is None else doubles(world_from_object))

    def set_instances(self, object_from_instance, previous=None):
        """Sixteen numbers a copy; none: the hair itself, once."""
        now = doubles(object_from_instance)
        before = None if previous is None else doubles(previous)
        if before is not None and len(before) != len(now):
            raise Error(f"{len(now)} numbers now, {len(before)} before")
        self._call("set_instances", now, before, ctypes.c_uint32(len(now) // 16))


class Target(_Object):
    def __init__(self, library, handle, width, height):
        super().__init__(library, "target", handle)
        self.width, self.height = width, height

    def colour(self):
        """Height x width x 4 floats, linear and premultiplied."""
        address, size, values = empty((self.height, self.width, 4), ctypes.c_float)
        self._call("read_colour", address, size)
        return values

    def _output(self, which, each, kind):
        address, size, values = empty((self.height, self.width, each), kind)
        self._call("read_output", ctypes.c_uint32(which), address, size)
        return values

    def nearest_depth(self):
        """Clip depth of the nearest fibre: height x width x 1."""
        return self._output(PELAGE_OUTPUT_NEAREST_DEPTH, 1, ctypes.c_float)

    def coverage(self):
        """The part of a pixel that hair covers: height x width x 1."""
        return self._output(PELAGE_OUTPUT_COVERAGE, 1, ctypes.c_float)

    def motion(self):
        """Pixels to the right and downwards since the frame before: height x width x 2."""
        return self._output(PELAGE_OUTPUT_MOTION, 2, ctypes.c_float)

    def ids(self):
        """Hair with instance, and strand: height x width x 2, PELAGE_NO_STRAND where there is none."""
        return self._output(PELAGE_OUTPUT_IDS, 2, ctypes.c_uint32)


class Context(_Object):
    """A device of the library's own, with all that is made on it; `with` destroys it at the end."""

    def __init__(self, library, **fields):
        handle = Handle()
        library.call("context_create", ctypes.byref(ContextDescriptor(**fields)), ctypes.byref(handle))
        super().__init__(library, "context", handle)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.destroy()

    def _make(self, name, *arguments):
        handle = Handle()
        self.library.call(name, self.handle, *arguments, ctypes.byref(handle))
        return handle

    def builtin(self, groom, strands):
        handle = self._make("hair_create_builtin", ctypes.c_uint32(groom), ctypes.c_uint64(strands))
        return Hair(self.library, "hair", handle)

    def guided_clumps(self, positions, counts, radius, **settings):
        """Hair around guides that can be moved; `settings` as of PelageClumpSettings."""
        given, points = array(ctypes.c_float, positions), array(ctypes.c_uint32, counts)
        guides = Strands(
            positions=given,
            point_count=len(given) // 3,
            counts=points,
            strand_count=len(points),
            root_radius=radius,
            tip_radius=radius,
        )
        clumps = ClumpSettings(**{"followers": 4, "tip_factor": 0.5, **settings})
        handle = self._make("hair_create_guided_clumps", ctypes.byref(guides), ctypes.byref(clumps))
        return Hair(self.library, "hair", handle)

    def target(self, width, height, outputs=0):
        image = TargetDescriptor(width=width, height=height, outputs=outputs)
        return Target(self.library, self._make("target_create", ctypes.byref(image)), width, height)

    def render(self, hairs, lights, view, target, ambient=(0.0, 0.0, 0.0)):
        frame = Frame(
            hair_count=len(hairs),
            hairs=(Handle * len(hairs))(*(hair.handle for hair in hairs)),
            light_count=len(lights),
            lights=(Light * len(lights))(*lights),
            view=ctypes.pointer(view),
            ambient=ambient,
        )
        self.library.call("render", self.handle, ctypes.byref(frame), target.handle, ctypes.c_uint32(PELAGE_RENDER_CLEAR))
