"""Tasks of equal cost, from the sizes in the files' headers."""

import re
import struct
from typing import Dict, List, Optional

# Bytes at the beginning of a file that hold the sizes of nearly all.
HEADER = 4096
SUFFIXES = (".hdr", ".exr", ".png", ".jpg", ".jpeg")


def pixels(header: bytes, file_bytes: int) -> int:
    """Pixels of an image by the beginning of its file; estimated at two bytes a pixel if unknown."""
    found = radiance(header) or exr(header) or png(header)
    return found or max(file_bytes // 2, 1)


def radiance(header: bytes) -> Optional[int]:
    if not header.startswith(b"#?"):
        return None
    size = re.search(rb"\n[-+][XY] (\d{1,6}) [-+][XY] (\d{1,6})\n", header)
    return int(size[1]) * int(size[2]) if size else None


def png(header: bytes) -> Optional[int]:
    if not header.startswith(b"\x89PNG\r\n\x1a\n") or len(header) < 24:
        return None
    width, height = struct.unpack(">II", header[16:24])
    return int(width) * int(height)


def exr(header: bytes) -> Optional[int]:
    """The data window: an attribute is a name, a type, a length and a value."""
    name = b"dataWindow\0box2i\0\x10\0\0\0"
    start = header.find(name) + len(name)
    if not header.startswith(b"\x76\x2f\x31\x01") or start < len(name) or len(header) < start + 16:
        return None
    left, top, right, bottom = struct.unpack("<iiii", header[start : start + 16])
    size = (right - left + 1) * (bottom - top + 1)
    return size if size > 0 else None


def batches(costs: Dict[str, int], most: int, workers: int) -> List[List[str]]:
    """Tasks that cost at most `most` each, or hold one panorama; at least eight a worker, largest first."""
    most = min(most, sum(costs.values()) // (8 * workers))
    made: List[List[str]] = []
    room = 0
    for name, cost in sorted(costs.items(), key=lambda item: (-item[1], item[0])):
        if cost > room:
            made.append([])
            room = most
        made[-1].append(name)
        room -= cost
    return made


def memory(cost: int) -> int:
    """Bytes that a worker needs for a panorama of this cost; bakes take about 40 a texel."""
    return 256 * 2**20 + 64 * cost
