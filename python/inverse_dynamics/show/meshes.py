# SPDX-License-Identifier: Apache-2.0
"""Meshes of a robot description (STL, DAE, OBJ), made small enough for a page.

    for part in read_mesh(Path("forearm.dae"), most=4000):
        part.vertices, part.triangles, part.color

Read by trimesh (DAE: with pycollada), which are optional: without them a robot's skeleton is drawn.
"""

from __future__ import annotations

import io
import os
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any
from urllib.parse import unquote

import numpy as np

from inverse_dynamics.errors import RobotError
from inverse_dynamics.installation.ament import package_roots
from inverse_dynamics.installation.extras import require
from inverse_dynamics.robots.reading import read_bytes

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from inverse_dynamics.arrays import Floats

    Triangles = NDArray[np.int64]

FORMATS = (".stl", ".dae", ".obj")
_MOST_VERTICES = 60_000  # an index of the page has 16 bits


class MeshError(RobotError):
    """A mesh can't be read."""


@dataclass(frozen=True)
class MeshPart:
    """Triangles of one colour; color: None where the file states none."""

    vertices: Floats  # (V, 3) m
    triangles: Triangles  # (T, 3) indices of vertices
    color: list[float] | None


def find_mesh(name: str, directory: Path) -> Path:
    """The file that a URDF in a directory calls a mesh. Raises MeshError.

    package://PACKAGE/FILE is looked for as package_roots() says [installation/ament.py].
    """
    scheme, separator, rest = name.partition("://")
    path = unquote(rest) if separator else name
    if scheme == "package" and separator:
        package, _, inside = path.partition("/")
        candidates = [root / inside for root in package_roots(package, directory)]
    elif separator and scheme != "file":
        raise MeshError(f"mesh {name}: expected a file or package://PACKAGE/FILE, got {scheme}://")
    else:
        candidates = [directory / path]
    for candidate in candidates:
        if candidate.suffix.lower() in FORMATS and os.path.isfile(candidate):
            return candidate
    if Path(path).suffix.lower() not in FORMATS:
        raise MeshError(f"mesh {name}: expected a file of the format STL, DAE or OBJ")
    raise MeshError(f"mesh {name}: no such file; source the workspace that holds it")


def read_mesh(file: Path, most: int) -> list[MeshPart]:
    """Parts of at most `most` triangles together. Raises MeshError, MissingPackageError.

    Lengths are those of the file, in m where a DAE states another unit. Files that it refers to aren't read.
    """
    scene = _load(file)
    parts = []
    for node in scene.graph.nodes_geometry:
        pose, name = scene.graph[node]
        geometry = scene.geometry[name]
        triangles = np.asarray(getattr(geometry, "faces", ()), dtype=np.int64)
        if not len(triangles):
            continue
        vertices = np.asarray(geometry.vertices) @ pose[:3, :3].T + pose[:3, 3]
        textured_obj = file.suffix.lower() == ".obj" and geometry.visual.kind == "texture"
        color = None if textured_obj else _color(geometry)  # an OBJ's materials aren't read
        parts.append(MeshPart(_metres(scene) * vertices, triangles, color))
    if not parts or not all(np.all(np.isfinite(part.vertices)) for part in parts):
        raise MeshError(f"{file}: expected triangles with finite coordinates")
    total = sum(len(part.triangles) for part in parts)
    parts = [simplified(part, max(12, most * len(part.triangles) // total)) for part in parts]
    parts = [part for part in parts if len(part.triangles)]
    if not parts:
        raise MeshError(f"{file}: expected triangles with an area")
    return parts


def _load(file: Path) -> Any:
    """A file as a scene of trimesh."""
    require("a mesh of the robot", "trimesh")
    import trimesh

    kind = file.suffix[1:].lower()
    if kind == "dae":
        require("a mesh of the format DAE", "collada")
    data = read_bytes(file, "a mesh", MeshError)
    if kind == "dae" and (
        b"\0" in data  # UTF-16, in which the next line would see nothing
        or b"<!" in data.replace(b"<!--", b"")
        or not data.lstrip(b"\xef\xbb\xbf \t\r\n").startswith(b"<")
    ):
        raise MeshError(f"{file}: expected a COLLADA document without a document type")
    if kind == "obj":
        data = _tidied_obj(data)
    try:
        # From memory and without a resolver: materials and textures elsewhere aren't opened.
        return trimesh.load_scene(io.BytesIO(data), file_type=kind, process=False)
    except Exception as error:  # of damaged files, whatever their readers raise
        raise MeshError(f"{file}: isn't a mesh of the format {kind.upper()}") from error


def _tidied_obj(data: bytes) -> bytes:
    """The same text in UTF-8 without a byte order mark, with spaces for tabs and lines that end in LF."""
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError:
        text = data.decode("latin-1")  # only names and comments aren't ASCII, and they aren't used
    return text.replace("\t", " ").replace("\r\n", "\n").replace("\r", "\n").encode()


def _metres(scene: Any) -> float:
    """Of one unit of length; only DAE states one, as '0.001 * meters'."""
    number = str(scene.units or "").partition(" * ")[0]
    try:
        return float(number)
    except ValueError:
        return 1.0


def _color(geometry: Any) -> list[float] | None:
    visual = geometry.visual
    material = getattr(visual, "material", None)
    if material is None and not getattr(visual, "defined", False):
        return None
    color = getattr(visual if material is None else material, "main_color", None)
    return None if color is None else [round(float(c) / 255, 3) for c in color[:3]]


def simplified(part: MeshPart, most: int) -> MeshPart:
    """The part with at most `most` triangles: vertices that share a cell of a grid become their mean.

    The grid is as fine as that allows; 20 bisections of its width find it.
    """
    low, extent = part.vertices.min(axis=0), float(np.ptp(part.vertices, axis=0).max()) or 1.0
    # also joins corners that were stored once per triangle
    found = _clustered(part, low, 1e-6 * extent)
    if _fits(found, most):
        return found
    fine, coarse = 1e-6 * extent, 2.0 * extent
    found = _clustered(part, low, coarse)
    for _ in range(20):
        width = float(np.sqrt(fine * coarse))
        attempt = _clustered(part, low, width)
        if _fits(attempt, most):
            coarse, found = width, attempt
        else:
            fine = width
    return found


def _fits(part: MeshPart, most: int) -> bool:
    return len(part.triangles) <= most and len(part.vertices) <= _MOST_VERTICES


def _clustered(part: MeshPart, low: Floats, width: float) -> MeshPart:
    cells = np.floor((part.vertices - low) / width + 0.5).astype(np.int64)
    keys, cluster, counts = np.unique(cells, axis=0, return_inverse=True, return_counts=True)
    cluster = cluster.reshape(-1)
    sums = [np.bincount(cluster, weights=column, minlength=len(keys)) for column in part.vertices.T]
    vertices = np.stack(sums, axis=1) / counts[:, None]
    a, b, c = triangles = cluster[part.triangles].T
    triangles = triangles.T[(a != b) & (b != c) & (c != a)]
    _, first = np.unique(np.sort(triangles, axis=1), axis=0, return_index=True)
    triangles = triangles[np.sort(first)]
    used, index = np.unique(triangles, return_inverse=True)
    return MeshPart(vertices[used], index.reshape(-1, 3), part.color)
