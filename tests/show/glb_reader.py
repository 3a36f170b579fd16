"""Reader of GLB files, written from the glTF standard."""

import json

import numpy as np

KINDS = {5126: "<f4", 5125: "<u4"}
WIDTHS = {"SCALAR": 1, "VEC3": 3, "VEC4": 4}


class Film:
    """A GLB file, decoded."""

    def __init__(self, data: bytes) -> None:
        assert data[:4] == b"glTF"
        assert int.from_bytes(data[8:12], "little") == len(data)
        size = int.from_bytes(data[12:16], "little")
        self.head = json.loads(data[20 : 20 + size])
        self.binary = data[28 + size :]
        [self.animation] = self.head["animations"]
        self.names = [node["name"] for node in self.head["nodes"]]

    def rows(self, number: int) -> np.ndarray:
        one = self.head["accessors"][number]
        view = self.head["bufferViews"][one["bufferView"]]
        assert view["byteOffset"] % 4 == 0
        width = WIDTHS[one["type"]]
        kind = np.dtype(KINDS[one["componentType"]])
        found = np.frombuffer(self.binary, kind, one["count"] * width, view["byteOffset"])
        assert view["byteLength"] == found.nbytes
        return found.reshape(one["count"], width)

    def channel(self, name: str, path: str) -> tuple[np.ndarray, np.ndarray, str]:
        node = self.names.index(name)
        [one] = [
            c for c in self.animation["channels"] if c["target"] == {"node": node, "path": path}
        ]
        sampler = self.animation["samplers"][one["sampler"]]
        times = self.rows(sampler["input"])[:, 0]
        assert (np.diff(times) > 0).all()
        return times, self.rows(sampler["output"]), sampler["interpolation"]
