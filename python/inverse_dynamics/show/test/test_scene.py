# SPDX-License-Identifier: Apache-2.0
"""The robot as it is drawn: shapes, meshes, skeletons."""

import base64
from pathlib import Path

import numpy as np
import pytest

from inverse_dynamics.errors import RobotError
from inverse_dynamics.installation import ament
from inverse_dynamics.installation.extras import EXTRAS, how_to_install
from inverse_dynamics.show import scene as scenes
from inverse_dynamics.show.meshes import (
    MeshError,
    MeshPart,
    find_mesh,
    read_mesh,
    simplified,
)
from inverse_dynamics.show.scene import (
    MOST_TRIANGLES,
    encoded_mesh,
    read_scene,
    scene_of,
)

ARM = """<robot name="arm">
<link name="base">{base}</link><link name="upper">{upper}</link><link name="fore">{upper}</link>
<joint name="a" type="continuous"><parent link="base"/><child link="upper"/>
<origin xyz="0 0 0.3"/><axis xyz="0 1 0"/></joint>
<joint name="b" type="continuous"><parent link="upper"/><child link="fore"/>
<origin xyz="0.4 0 0"/><axis xyz="0 1 0"/></joint>
</robot>"""
BOX = '<visual><geometry><box size="0.1 0.1 0.1"/></geometry></visual>'


def mesh(name, more=""):
    return f'<visual>{more}<geometry><mesh filename="{name}" scale="0.001 0.001 0.002"/></geometry></visual>'


def sphere(count=40):
    """A sphere of radius 100 about (10, 0, 0), stored as STL stores it: three corners per triangle."""
    u, v = np.meshgrid(np.linspace(0, 2 * np.pi, 2 * count + 1), np.linspace(0, np.pi, count + 1))
    grid = 100 * np.stack([np.cos(u) * np.sin(v), np.sin(u) * np.sin(v), np.cos(v)], axis=-1)
    a, b, c, d = grid[:-1, :-1], grid[:-1, 1:], grid[1:, 1:], grid[1:, :-1]
    corners = np.concatenate([np.stack([a, b, c], 2), np.stack([a, c, d], 2)]).reshape(-1, 3)
    return MeshPart(corners + np.array([10, 0, 0]), np.arange(len(corners)).reshape(-1, 3), None)


def write_stl(file, part):
    """Binary STL."""
    triangles = part.vertices[part.triangles].astype("<f4")
    record = np.zeros(len(triangles), dtype=[("n", "<f4", 3), ("v", "<f4", (3, 3)), ("a", "<u2")])
    record["v"] = triangles
    file.write_bytes(bytes(80) + len(triangles).to_bytes(4, "little") + record.tobytes())


def decoded_mesh(shape):
    """Vertices (V, 3) m and triangles (T, 3) of a shape of kind mesh."""
    steps = np.frombuffer(base64.b64decode(shape["vertices"]), dtype="<i2").reshape(-1, 3)
    triangles = np.frombuffer(base64.b64decode(shape["triangles"]), dtype="<u2").reshape(-1, 3)
    return np.array(shape["middle"]) + shape["step"] * steps, triangles


def kinds(link):
    return [shape["kind"] for shape in link["shapes"]]


def test_a_robot_without_shapes_is_drawn_as_its_joints_and_links():
    links = scene_of(ARM.format(base="", upper=""), ["a", "b"], Path()).links
    assert kinds(links[0]) == ["cylinder", "sphere"]
    assert links[0]["shapes"][0]["size"][1] == pytest.approx(0.3)  # the way to the next joint
    assert sorted(kinds(links[1])) == ["cylinder", "cylinder", "sphere"]
    assert kinds(links[2]) == ["cylinder"]
    drum = np.reshape(links[2]["shapes"][0]["pose"], (4, 4)).T
    np.testing.assert_allclose(drum[:3, 2], [0, 1, 0])  # about the axis of the joint


def test_shapes_are_drawn_without_a_skeleton():
    links = scene_of(ARM.format(base=BOX, upper=""), ["a", "b"], Path()).links
    assert [kinds(link) for link in links] == [["box"], [], []]


def test_a_mesh_that_is_missing_gives_its_link_a_skeleton_and_a_note(tmp_path):
    file = tmp_path / "arm.urdf"
    file.write_text(ARM.format(base=BOX, upper=mesh("package://gone/upper.stl")))
    scene = read_scene(file, ["a", "b"])
    assert [kinds(link) for link in scene.links] == [
        ["box"],
        ["cylinder", "cylinder", "sphere"],
        ["cylinder"],
    ]
    (note,) = scene.notes
    assert note.startswith(
        "2 links drawn as a skeleton: mesh package://gone/upper.stl: no such file"
    )


def test_a_mesh_that_is_drawn_twice_is_read_once(tmp_path, monkeypatch):
    read = []
    part = sphere(4)
    monkeypatch.setattr(scenes, "read_mesh", lambda file, most: read.append((file, most)) or [part])
    (tmp_path / "upper.stl").touch()
    file = tmp_path / "arm.urdf"
    file.write_text(ARM.format(base=mesh("upper.stl"), upper=mesh("upper.stl")))
    drawn = [shape for link in read_scene(file, ["a", "b"]).links for shape in link["shapes"]]
    count = sum(shape["kind"] == "mesh" for shape in drawn)
    assert count >= 2
    assert read == [(tmp_path / "upper.stl", MOST_TRIANGLES // count)]
    monkeypatch.setattr(scenes, "MOST_MESHES", count - 1)
    (note,) = read_scene(file, ["a", "b"]).notes
    assert f"expected at most {count - 1} meshes, got {count}" in note


def test_without_the_reader_the_note_says_how_to_get_it(tmp_path, monkeypatch):
    monkeypatch.setattr("inverse_dynamics.installation.extras.is_installed", lambda module: False)
    write_stl(tmp_path / "upper.stl", sphere(4))
    file = tmp_path / "arm.urdf"
    file.write_text(ARM.format(base="", upper=mesh("upper.stl")))
    scene = read_scene(file, ["a", "b"])
    assert f"a mesh of the robot needs trimesh: {how_to_install('trimesh')}" in scene.notes[0]
    assert EXTRAS["trimesh"] == "meshes"
    assert all(kinds(link) for link in scene.links[1:])


@pytest.mark.parametrize(
    "name", ["upper.stl", "file://{}/upper.stl", "package://arm_description/upper.stl"]
)
def test_meshes_are_found_scaled_and_coloured(tmp_path, name):
    pytest.importorskip("trimesh")
    package = tmp_path / "arm_description"
    package.mkdir()
    write_stl(package / "upper.stl", sphere(60))
    file = package / "arm.urdf"
    red = '<material name="red"><color rgba="1 0 0 1"/></material>'
    file.write_text(ARM.format(base="", upper=mesh(name.format(package), red)))
    scene = read_scene(file, ["a", "b"])
    assert scene.notes == ()
    (shape,) = scene.links[1]["shapes"]
    assert shape["kind"] == "mesh"
    assert shape["color"] == [1.0, 0.0, 0.0]
    vertices, triangles = decoded_mesh(shape)
    assert len(triangles) <= MOST_TRIANGLES // 2
    np.testing.assert_allclose(vertices.max(axis=0), [0.11, 0.1, 0.2], atol=3e-3)
    np.testing.assert_allclose(vertices.min(axis=0), [-0.09, -0.1, -0.2], atol=3e-3)


def test_collada_and_obj_are_read_with_unit_and_colour(tmp_path):
    trimesh = pytest.importorskip("trimesh")
    pytest.importorskip("collada")
    box = trimesh.creation.box(extents=[100.0, 200.0, 300.0])
    box.visual.face_colors = [0, 128, 255, 255]
    text = box.export(file_type="dae").decode()
    text = text.replace('name="meter" meter="1"', 'name="millimeter" meter="0.001"')
    text = text.replace('<unit meter="1.0"', '<unit meter="0.001"').replace(
        'meter="1"', 'meter="0.001"'
    )
    (tmp_path / "box.dae").write_text(text)
    (tmp_path / "box.obj").write_text(box.export(file_type="obj", include_color=False))
    (part,) = read_mesh(tmp_path / "box.dae", 1000)
    unit = 0.001 if "0.001" in text else 1.0
    np.testing.assert_allclose(np.ptp(part.vertices, axis=0), unit * np.array([100, 200, 300]))
    assert part.color == pytest.approx([0, 0.5, 1], abs=0.01)
    (part,) = read_mesh(tmp_path / "box.obj", 1000)
    np.testing.assert_allclose(np.ptp(part.vertices, axis=0), [100, 200, 300])
    assert len(part.triangles) == 12


OBJ_CORNERS = "".join(f"v {x} {y} {z}\n" for x in (0, 1) for y in (0, 2) for z in (0, 3))
OBJ_TEXTURE = "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvn 1 0 0\n"
OBJ_FACES = ((1, 2, 4, 3), (5, 7, 8, 6), (1, 5, 6, 2), (3, 4, 8, 7), (1, 3, 7, 5), (2, 6, 8, 4))


def obj_box(corner: str = "{0}", before: str = "", offset: int = 0) -> str:
    """An OBJ file; corner: how a corner is written, of its index and its place 1 to 4 in the face."""
    faces = "".join(
        f"f {' '.join(corner.format(c + offset, k) for k, c in enumerate(face, 1))}\n"
        for face in OBJ_FACES
    )
    return OBJ_CORNERS + before + faces


OBJ_FILES = {
    "quads": obj_box(),
    "without its materials": "mtllib not there.mtl\no Box\n"
    + obj_box(before="g a b\nusemtl grey\ns off\n"),
    "texture and normals": obj_box("{0}/{1}/1", OBJ_TEXTURE),
    "normals": obj_box("{0}//1", OBJ_TEXTURE),
    "indices from the end": obj_box(offset=-9),
    "CR LF": obj_box("{0}/{1}/1", OBJ_TEXTURE).replace("\n", "\r\n"),
    "CR": obj_box().replace("\n", "\r"),
    "tabs": obj_box().replace(" ", "\t"),
    "byte order mark": f"\ufeff{obj_box()}",
    "names in Latin-1": "# Gehäuse\n" + obj_box(before="g Gehäuse\n"),
}


@pytest.mark.parametrize("kind", OBJ_FILES)
def test_obj_files_as_programs_write_them_are_read(tmp_path, kind):
    pytest.importorskip("trimesh")
    file = tmp_path / "box.obj"
    file.write_bytes(OBJ_FILES[kind].encode("latin-1" if "Latin" in kind else "utf-8"))
    (part,) = read_mesh(file, 1000)
    assert len(part.triangles) == 12
    corners = part.vertices[part.triangles]
    areas = np.linalg.norm(
        np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1
    )
    assert areas.sum() / 2 == pytest.approx(2 * (1 * 2 + 2 * 3 + 3 * 1))
    assert part.color is None


@pytest.mark.parametrize("encoding", ["utf-8", "utf-16-le"])
def test_a_mesh_with_a_document_type_is_refused(tmp_path, encoding):
    pytest.importorskip("trimesh")
    file = tmp_path / "evil.dae"
    text = (
        '<?xml version="1.0"?><!DOCTYPE a [<!ENTITY b SYSTEM "/etc/passwd">]><COLLADA>&b;</COLLADA>'
    )
    file.write_bytes(text.encode(encoding))
    with pytest.raises(MeshError, match="without a document type") as error:
        read_mesh(file, 100)
    assert "root:" not in str(error.value)


def test_triangles_without_an_area_are_refused(tmp_path):
    pytest.importorskip("trimesh")
    file = tmp_path / "flat.stl"
    corners = np.array([[0.0, 0, 0], [0, 0, 0], [1, 0, 0]])
    write_stl(file, MeshPart(corners, np.array([[0, 1, 2]]), None))
    with pytest.raises(MeshError, match="expected triangles with an area"):
        read_mesh(file, 100)


@pytest.mark.parametrize("data", [b"", b"solid", b"\xff" * 200, b"<COLLADA/>", b"v 1 2\nf 1 2 3\n"])
@pytest.mark.parametrize("kind", ["stl", "dae", "obj"])
def test_a_damaged_mesh_is_refused_in_one_line(tmp_path, kind, data):
    pytest.importorskip("trimesh")
    file = tmp_path / f"bad.{kind}"
    file.write_bytes(data)
    with pytest.raises(RobotError) as error:
        read_mesh(file, 100)
    assert str(file) in str(error.value)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize("name", ["/etc/passwd", "../secret", "http://host/a.stl", "package://"])
def test_what_is_no_mesh_is_not_opened(tmp_path, name):
    with pytest.raises(MeshError, match="expected a file"):
        find_mesh(name, tmp_path)


@pytest.mark.parametrize("most", [12, 100, 2000, 10**6])
def test_a_simplified_mesh_keeps_the_shape(most):
    whole = sphere(50)
    small = simplified(whole, most)
    assert 0 < len(small.triangles) <= min(most, len(whole.triangles))
    assert small.triangles.max() < len(small.vertices)
    radius = np.linalg.norm(small.vertices - [10, 0, 0], axis=1)
    tolerance = 0.5 if most == 10**6 else 250 / np.sqrt(most)
    np.testing.assert_allclose(radius, 100, atol=min(tolerance, 60))


def test_a_mesh_comes_through_its_text():
    part = simplified(sphere(20), 500)
    vertices, triangles = decoded_mesh(encoded_mesh(part.vertices, part.triangles))
    np.testing.assert_array_equal(triangles, part.triangles)
    np.testing.assert_allclose(vertices, part.vertices, atol=100 / 32767)


def test_meshes_of_installed_packages_are_found_without_a_sourced_workspace(tmp_path, monkeypatch):
    share = tmp_path / "wheel/share/arm"
    share.mkdir(parents=True)
    (share / "upper.stl").touch()
    monkeypatch.delenv("AMENT_PREFIX_PATH", raising=False)
    monkeypatch.setattr(ament, "package_share", lambda name: tmp_path / "wheel/share" / name)
    assert find_mesh("package://arm/upper.stl", tmp_path) == share / "upper.stl"
