"""Reads an EXR file with OpenEXR's own bindings and compares every channel, bit for bit, with raw planes.

Usage: python read_back.py FILE.exr FOLDER, where FOLDER holds one little-endian f32 plane per channel,
top row first, called as the channel. Needs the PyPI packages openexr and numpy. Exits with 1 on any
difference.
"""

import pathlib
import sys

import numpy
import OpenEXR

path, folder = sys.argv[1], pathlib.Path(sys.argv[2])
with OpenEXR.File(path, separate_channels=True) as file:
    assert len(file.parts) == 1, f"{len(file.parts)} parts"
    assert "gnomon" in file.header(), "the text attribute is missing"
    channels = {name: channel.pixels for name, channel in file.channels().items()}
expected = {plane.name: plane.read_bytes() for plane in folder.iterdir()}
assert channels.keys() == expected.keys(), f"channels {sorted(channels)}, expected {sorted(expected)}"
for name, pixels in channels.items():
    assert pixels.dtype == numpy.float32, f"{name} is {pixels.dtype}"
    assert pixels.astype("<f4").tobytes() == expected[name], f"{name} differs"
print(f"{len(channels)} channels of {pixels.shape[1]} x {pixels.shape[0]}: equal")
