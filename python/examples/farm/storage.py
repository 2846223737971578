"""Folders on any file system of fsspec: a local path, or an URL such as s3://bucket/skies."""

import os
from typing import Dict, Optional

import fsspec
from fsspec.implementations.local import LocalFileSystem


class Storage:
    """A folder; names are relative to it, with `/` between their parts."""

    def __init__(self, url: str) -> None:
        # Listings are not kept: other processes write.
        self.fs, root = fsspec.core.url_to_fs(url, use_listings_cache=False)
        self.root = root.rstrip("/")
        self.is_local = isinstance(self.fs, LocalFileSystem)

    def path(self, name: str) -> str:
        return f"{self.root}/{name}"

    def sizes(self) -> Dict[str, int]:
        """All files below the folder, and their sizes in bytes."""
        found = self.fs.find(self.root, detail=True)
        return {path[len(self.root) + 1 :]: int(info["size"] or 0) for path, info in found.items()}

    def beginnings(self, names: list[str], length: int) -> Dict[str, bytes]:
        """The first bytes of each file; files that cannot be read are missing."""
        paths = [self.path(name) for name in names]
        ends = [length] * len(paths)
        parts = self.fs.cat_ranges(paths, [0] * len(paths), ends, on_error="return")
        return {name: part for name, part in zip(names, parts) if isinstance(part, bytes)}

    def read(self, name: str) -> bytes:
        content = self.fs.cat_file(self.path(name))
        assert isinstance(content, bytes)
        return content

    def read_if_there(self, name: str) -> Optional[bytes]:
        try:
            return self.read(name)
        except (FileNotFoundError, NotADirectoryError, IsADirectoryError):
            return None

    def write(self, name: str, content: bytes) -> None:
        """Writes a file that appears whole or not at all."""
        path = self.path(name)
        if not self.is_local:
            # Object stores replace an object in one step.
            self.fs.pipe_file(path, content)
            return
        folder = os.path.dirname(path)
        os.makedirs(folder, exist_ok=True)
        # A killed worker leaves it; the next attempt replaces it.
        temporary = os.path.join(folder, f".farm-{os.path.basename(path)}")
        with open(temporary, "wb") as file:
            file.write(content)
        os.replace(temporary, path)

    def remove(self, name: str) -> None:
        try:
            self.fs.rm_file(self.path(name))
        except FileNotFoundError:
            pass
