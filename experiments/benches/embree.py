"""How fast is Embree 4 (robust mode) on the scenes that the truth bench wrote?

    GNOMON_DUMP=dump/ cargo bench --bench truth
    pip install embreex numpy        # any C compiler beside it
    python3 experiments/benches/embree.py dump/

Prints, on one thread: the build, one ray at a time, and coherent packets of 16, as processor time.
The packets are called from C, since a call from Python costs more than a ray; the C code declares
the few functions of the public Embree 4 interface that it needs.
"""

import ctypes
import glob
import os
import subprocess
import sys
import tempfile

C_CODE = r"""
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

typedef struct RTCDeviceTy *RTCDevice; typedef struct RTCSceneTy *RTCScene;
typedef struct RTCGeometryTy *RTCGeometry;
RTCDevice rtcNewDevice(const char *); RTCScene rtcNewScene(RTCDevice);
void rtcSetSceneFlags(RTCScene, int); void rtcCommitScene(RTCScene); void rtcReleaseScene(RTCScene);
RTCGeometry rtcNewGeometry(RTCDevice, int); void rtcCommitGeometry(RTCGeometry);
void *rtcSetNewGeometryBuffer(RTCGeometry, int, unsigned, int, size_t, size_t);
unsigned rtcAttachGeometry(RTCScene, RTCGeometry); void rtcReleaseGeometry(RTCGeometry);

typedef struct __attribute__((aligned(16))) {
  float ox, oy, oz, tnear, dx, dy, dz, time, tfar; unsigned mask, id, flags;
} Ray;
typedef struct __attribute__((aligned(64))) {
  float ox[16], oy[16], oz[16], tnear[16], dx[16], dy[16], dz[16], time[16], tfar[16];
  unsigned mask[16], id[16], flags[16];
} Ray16;
typedef struct __attribute__((aligned(16))) {
  int flags, feature_mask; void *context, *filter, *occluded; float min_width;
} Args;
void rtcOccluded1(RTCScene, Ray *, Args *);
void rtcOccluded16(const int *, RTCScene, Ray16 *, Args *);

static RTCScene scene;

static double now(void) {
  struct timespec t; clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t); return t.tv_sec * 1e3 + t.tv_nsec / 1e6;
}

double build(RTCDevice device, const float *points, size_t n, const unsigned *triangles, size_t m) {
  double start = now();
  scene = rtcNewScene(device);
  rtcSetSceneFlags(scene, 1 << 2 /* robust */);
  RTCGeometry geometry = rtcNewGeometry(device, 0 /* triangles */);
  memcpy(rtcSetNewGeometryBuffer(geometry, 1, 0, 0x9003, 12, n), points, 12 * n);
  memcpy(rtcSetNewGeometryBuffer(geometry, 0, 0, 0x5003, 12, m), triangles, 12 * m);
  rtcCommitGeometry(geometry); rtcAttachGeometry(scene, geometry); rtcReleaseGeometry(geometry);
  rtcCommitScene(scene);
  return now() - start;
}

double single(const float *rays, size_t n, size_t *blocked) {
  Args args = {0, -1, 0, 0, 0, 0}; double start = now(); *blocked = 0;
  for (size_t i = 0; i < n; i++) {
    const float *r = rays + 6 * i;
    Ray ray = {r[0], r[1], r[2], 0, r[3], r[4], r[5], 0, 1, -1u, 0, 0};
    rtcOccluded1(scene, &ray, &args);
    *blocked += ray.tfar < 0;
  }
  return now() - start;
}

double packets(const float *rays, size_t n, size_t *blocked) {
  Args args = {1 << 16 /* coherent */, -1, 0, 0, 0, 0}; double start = now(); *blocked = 0;
  for (size_t i = 0; i < n; i += 16) {
    Ray16 p; int valid[16] __attribute__((aligned(64)));
    for (int k = 0; k < 16; k++) {
      const float *r = rays + 6 * (i + k < n ? i + k : n - 1);
      valid[k] = i + k < n ? -1 : 0;
      p.ox[k] = r[0]; p.oy[k] = r[1]; p.oz[k] = r[2]; p.dx[k] = r[3]; p.dy[k] = r[4]; p.dz[k] = r[5];
      p.tnear[k] = 0; p.tfar[k] = 1; p.time[k] = 0; p.mask[k] = -1u; p.id[k] = 0; p.flags[k] = 0;
    }
    rtcOccluded16(valid, scene, &p, &args);
    for (int k = 0; k < 16; k++) *blocked += valid[k] && p.tfar[k] < 0;
  }
  return now() - start;
}
"""


def library():
    """Compiles the loops against the Embree that embreex brings along."""
    import embreex

    beside = os.path.join(os.path.dirname(embreex.__file__), "..", "embreex.libs")
    (embree,) = glob.glob(os.path.join(beside, "libembree4*"))
    ctypes.CDLL(glob.glob(os.path.join(beside, "libtbb*"))[0], ctypes.RTLD_GLOBAL)
    device = ctypes.CDLL(embree, ctypes.RTLD_GLOBAL)
    folder = tempfile.mkdtemp()
    source, shared = os.path.join(folder, "loops.c"), os.path.join(folder, "loops.so")
    with open(source, "w", encoding="ascii") as file:
        file.write(C_CODE)
    subprocess.run(["cc", "-O3", "-march=native", "-shared", "-fPIC", source, "-o", shared], check=True)
    loops = ctypes.CDLL(shared)
    for function in (loops.build, loops.single, loops.packets):
        function.restype = ctypes.c_double
    device.rtcNewDevice.restype = ctypes.c_void_p
    return loops, ctypes.c_void_p(device.rtcNewDevice(b"threads=1,isa=avx512"))


def median(values):
    return sorted(values)[len(values) // 2]


def main(folder):
    import numpy

    loops, device = library()
    pointer = lambda array: array.ctypes.data_as(ctypes.c_void_p)
    for vertices in sorted(glob.glob(os.path.join(folder, "*.vertices"))):
        name = vertices[: -len(".vertices")]
        points = numpy.fromfile(vertices, "<f4")
        triangles = numpy.fromfile(name + ".triangles", "<u4")
        size = ctypes.c_size_t
        build = lambda: loops.build(
            device, pointer(points), size(len(points) // 3), pointer(triangles), size(len(triangles) // 3)
        )
        print(f"{os.path.basename(name)}: build {median([build() for _ in range(5)]):.1f} ms")
        for file in sorted(glob.glob(name + ".*.rays")):
            rays = numpy.fromfile(file, "<f4")
            count, blocked = len(rays) // 6, size()
            for label, way in (("one ray", loops.single), ("packets of 16", loops.packets)):
                times = [way(pointer(rays), size(count), ctypes.byref(blocked)) for _ in range(7)]
                light = os.path.basename(file).split(".")[-2]
                print(
                    f"  {light}: {label}, robust: {median(times):.1f} ms (best {min(times):.1f}), "
                    f"{count / median(times) / 1e3:.2f} M rays a second, {blocked.value} blocked"
                )


if __name__ == "__main__":
    main(sys.argv[1])
