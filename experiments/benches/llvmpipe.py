"""How fast does Mesa's llvmpipe draw the depth map that the raster bench wrote?

    apt-get install libegl1 libegl-mesa0 libgl1-mesa-dri libgles2   # Debian's names; and numpy
    GNOMON_DUMP=dump/ cargo bench --bench raster                    # calls this script
    python3 experiments/benches/llvmpipe.py dump/terrain-point-2048 2048

Draws STEM.clip (f32 x, y, z, w) over STEM.triangles (u32) into a 32-bit float depth texture, without
colour, on a surfaceless EGL context of OpenGL ES 3. Prints `way milliseconds` a line: processor time
on one thread (LP_NUM_THREADS=0) and wall time on two; then how its map differs from STEM.depth.
"""

import ctypes
import os
import subprocess
import sys
import time

VERTEX = b"#version 300 es\nin vec4 p; void main() { gl_Position = p; }\n"
FRAGMENT = b"#version 300 es\nvoid main() {}\n"
ROUNDS = 3


def context():
    """A current surfaceless context of OpenGL ES 3; returns the GL library."""
    egl, gl = ctypes.CDLL("libEGL.so.1"), ctypes.CDLL("libGLESv2.so.2")
    for name in ("eglGetPlatformDisplay", "eglCreateContext"):
        getattr(egl, name).restype = ctypes.c_void_p
    surfaceless, none = 0x31DD, 0x3038
    display = ctypes.c_void_p(egl.eglGetPlatformDisplay(surfaceless, None, None))
    assert egl.eglInitialize(display, None, None), "no surfaceless EGL"
    egl.eglBindAPI(0x30A0)
    attributes = (ctypes.c_int * 3)(0x3098, 3, none)
    made = ctypes.c_void_p(egl.eglCreateContext(display, None, None, attributes))
    assert made.value, "no context without a config"
    assert egl.eglMakeCurrent(display, None, None, made), "the context is not made current"
    gl.glGetString.restype = ctypes.c_char_p
    return gl


def program(gl):
    made = gl.glCreateProgram()
    for kind, text in ((0x8B31, VERTEX), (0x8B30, FRAGMENT)):
        shader = gl.glCreateShader(kind)
        gl.glShaderSource(shader, 1, ctypes.byref(ctypes.c_char_p(text)), None)
        gl.glCompileShader(shader)
        gl.glAttachShader(made, shader)
    gl.glBindAttribLocation(made, 0, b"p")
    gl.glLinkProgram(made)
    linked = ctypes.c_int()
    gl.glGetProgramiv(made, 0x8B82, ctypes.byref(linked))
    assert linked.value, "the shaders do not link"
    gl.glUseProgram(made)


def upload(gl, target, data):
    name = ctypes.c_uint()
    gl.glGenBuffers(1, ctypes.byref(name))
    gl.glBindBuffer(target, name)
    gl.glBufferData(target, ctypes.c_ssize_t(len(data)), data, 0x88E4)


def depth_target(gl, size):
    texture, frame = ctypes.c_uint(), ctypes.c_uint()
    gl.glGenTextures(1, ctypes.byref(texture))
    gl.glBindTexture(0x0DE1, texture)
    gl.glTexStorage2D(0x0DE1, 1, 0x8CAC, size, size)  # DEPTH_COMPONENT32F
    gl.glGenFramebuffers(1, ctypes.byref(frame))
    gl.glBindFramebuffer(0x8D40, frame)
    gl.glFramebufferTexture2D(0x8D40, 0x8D00, 0x0DE1, texture, 0)
    assert gl.glCheckFramebufferStatus(0x8D40) == 0x8CD5, "no depth-only framebuffer"
    return texture


def colour_target(gl, size):
    texture, frame = ctypes.c_uint(), ctypes.c_uint()
    gl.glGenTextures(1, ctypes.byref(texture))
    gl.glBindTexture(0x0DE1, texture)
    gl.glTexStorage2D(0x0DE1, 1, 0x8236, size, size)  # R32UI
    gl.glGenFramebuffers(1, ctypes.byref(frame))
    gl.glBindFramebuffer(0x8D40, frame)
    gl.glFramebufferTexture2D(0x8D40, 0x8CE0, 0x0DE1, texture, 0)


COPY = b"""#version 300 es
precision highp float; precision highp sampler2D;
uniform sampler2D map; out uint bits;
void main() { bits = floatBitsToUint(texelFetch(map, ivec2(gl_FragCoord.xy), 0).x); }
"""
COVER = b"""#version 300 es
void main() { gl_Position = vec4(vec2(gl_VertexID & 1, gl_VertexID >> 1) * 4.0 - 1.0, 0.0, 1.0); }
"""


def read_back(gl, texture, size):
    """The depths as floats, by way of an integer colour target."""
    import numpy

    global VERTEX, FRAGMENT
    VERTEX, FRAGMENT = COVER, COPY
    program(gl)
    colour_target(gl, size)
    gl.glBindTexture(0x0DE1, texture)
    for name in (0x2801, 0x2800):
        gl.glTexParameteri(0x0DE1, name, 0x2600)
    gl.glDisable(0x0B71)
    gl.glDisableVertexAttribArray(0)
    gl.glDrawArrays(4, 0, 3)
    bits = numpy.empty((size, size, 4), numpy.uint32)
    gl.glReadPixels(0, 0, size, size, 0x8D99, 0x1405, bits.ctypes.data_as(ctypes.c_void_p))
    assert gl.glGetError() == 0, "the map is not read back"
    return bits[:, :, 0].copy().view(numpy.float32)


def draw(stem, size, wall):
    gl = context()
    clip, triangles = (open(stem + end, "rb").read() for end in (".clip", ".triangles"))
    program(gl)
    upload(gl, 0x8892, clip)
    upload(gl, 0x8893, triangles)
    gl.glEnableVertexAttribArray(0)
    gl.glVertexAttribPointer(0, 4, 0x1406, 0, 0, None)
    texture = depth_target(gl, size)
    gl.glViewport(0, 0, size, size)
    gl.glEnable(0x0B71)
    gl.glDepthFunc(0x0201)
    clock = time.perf_counter if wall else time.process_time
    best = []
    for _ in range(ROUNDS):
        start = clock()
        gl.glClear(0x0100)
        gl.glDrawElements(4, len(triangles) // 4, 0x1405, None)
        gl.glFinish()
        best.append((clock() - start) * 1e3)
    assert gl.glGetError() == 0, "GL reports an error"
    return gl, texture, sorted(best)[ROUNDS // 2]


def compare(gl, texture, stem, size):
    import numpy

    theirs = read_back(gl, texture, size)
    ours = numpy.fromfile(stem + ".depth", "<f4").reshape(size, size)
    covered = numpy.count_nonzero((theirs < 1) != (ours < 1))
    far = numpy.abs(theirs.astype(float) - ours)
    print(
        f"llvmpipe ({gl.glGetString(0x1F01).decode()}): coverage differs at {covered} texels, "
        f"depth by more than 1e-4 at {numpy.count_nonzero(far > 1e-4)} texels"
    )


def main(stem, size, *way):
    if not way:
        for threads, way in (("0", "one"), ("2", "two")):
            environment = dict(os.environ, LP_NUM_THREADS=threads, LIBGL_ALWAYS_SOFTWARE="1")
            subprocess.run([sys.executable, __file__, stem, size, way], env=environment, check=True)
        return
    gl, texture, ms = draw(stem, int(size), way[0] == "two")
    name = "llvmpipe, two threads, wall" if way[0] == "two" else "llvmpipe, one thread"
    print(f"{name} {ms:.2f}")
    if way[0] == "one":
        compare(gl, texture, stem, int(size))


if __name__ == "__main__":
    main(*sys.argv[1:])
