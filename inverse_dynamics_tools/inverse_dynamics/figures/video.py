# SPDX-License-Identifier: Apache-2.0
"""A film for slides: the robot moving through a recorded motion beside its torques, as an animated GIF.

write_video(evaluation, Path("ur10.gif"))

The robot is drawn by MuJoCo without a screen, from the shapes of its description (as in the report's 3D view). The
environment variable MUJOCO_GL says by what: osmesa (in software, the default), egl or glfw.
"""

from __future__ import annotations

import os
from contextlib import contextmanager
from ctypes.util import find_library
from importlib import import_module
from io import BytesIO
from typing import TYPE_CHECKING, Any

import numpy as np

from inverse_dynamics.base.extras import require
from inverse_dynamics.base.files import file_written_whole
from inverse_dynamics.base.progress import no_progress
from inverse_dynamics.errors import UserError
from inverse_dynamics.figures import palette
from inverse_dynamics.figures.scene import decoded_mesh, read_scene

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path

    from numpy.typing import NDArray
    from PIL.Image import Image

    from inverse_dynamics.base.arrays import Floats
    from inverse_dynamics.base.progress import Progress
    from inverse_dynamics.evaluation.evaluation import Evaluation

_HEIGHT = 480  # pixels of the film
_ROBOT_WIDTH = 360
_PLOT_WIDTH = 520
_FRAMES_PER_SECOND = 10  # GIF counts in hundredths of a second
_COLORS = 64
_FIELD_OF_VIEW = 36.0  # degrees, from top to bottom
_CURSOR = palette.LIGHT["cursor"]


class VideoError(UserError):
    """Pictures of the robot can't be made here, or not of this robot."""


def require_packages() -> None:
    """Raise MissingPackageError unless everything that films a robot is installed."""
    require("a video", "mujoco", "matplotlib", "PIL", "OpenGL")


def write_video(
    evaluation: Evaluation,
    file: Path,
    *,
    title: str = "",
    seconds: float = 10.0,
    progress: Progress = no_progress,
) -> None:
    """Write an animated GIF of the whole motion, in at most `seconds`; what is there is replaced.

    title: stands for the robot's name. Raises VideoError where nothing can be drawn, OutputError.
    """
    if file.suffix.lower() != ".gif":
        raise UserError(f"{file}: expected the name of a .gif file, the only format of videos")
    require_packages()
    duration = float(evaluation.time[-1])
    count = max(2, round(min(seconds, duration) * _FRAMES_PER_SECOND))
    times = np.linspace(0.0, duration, count)
    speed = duration / (count / _FRAMES_PER_SECOND)
    background, columns = _plot(evaluation, times, title or evaluation.robot.name, speed)
    frames = []
    for k, robot in enumerate(_pictures(evaluation, times)):
        progress("filming", k, count)
        frames.append(_compose(background, robot, columns[k]))
    progress("filming", count, count)
    _write_gif(frames, file)


def _compose(background: Image, robot: NDArray[np.uint8], column: int) -> Image:
    """A frame: the robot, its plots, and the time as a line through them."""
    from PIL import Image, ImageDraw

    frame = background.copy()
    frame.paste(Image.fromarray(robot), (0, 0))
    ImageDraw.Draw(frame).line([(column, 34), (column, _HEIGHT - 30)], fill=_CURSOR, width=2)
    return frame


def _write_gif(frames: Sequence[Image], file: Path) -> None:
    """All frames with the same colours and without dithering: still parts then cost nothing."""
    from PIL import Image

    sample = frames[:: max(1, len(frames) // 6)]
    sheet = Image.new("RGB", (frames[0].width, _HEIGHT * len(sample)))
    for k, frame in enumerate(sample):
        sheet.paste(frame, (0, k * _HEIGHT))
    palette = sheet.quantize(_COLORS, method=Image.Quantize.MEDIANCUT)
    few = [frame.quantize(palette=palette, dither=Image.Dither.NONE) for frame in frames]
    with file_written_whole(file) as work:
        few[0].save(
            work,
            format="GIF",
            save_all=True,
            append_images=few[1:],
            duration=round(1000 / _FRAMES_PER_SECOND),
            loop=0,
            optimize=False,
        )


# ---- torques ---------------------------------------------------------------------------------------------------------


def _plot(
    evaluation: Evaluation, times: Floats, title: str, speed: float
) -> tuple[Image, list[int]]:
    """The still part of the film, and the column of pixels that belongs to each time."""
    import matplotlib as mpl
    from matplotlib.figure import Figure
    from PIL import Image

    from inverse_dynamics.figures.plots import COMPUTED, MEASURED, make_printable

    n, dpi = len(evaluation.joint_names), 100
    style: Any = {
        "text.parse_math": False,
        "font.size": 7,
        "axes.spines.top": False,
        "axes.spines.right": False,
        "axes.titley": 1.0,
    }
    with mpl.rc_context(style):
        figure = Figure(figsize=(_PLOT_WIDTH / dpi, _HEIGHT / dpi), dpi=dpi)
        all_axes = figure.subplots(n, 1, sharex=True, squeeze=False)[:, 0]
        figure.subplots_adjust(left=0.085, right=0.98, top=0.865, bottom=0.075, hspace=0.62)
        for j, axes in enumerate(all_axes):
            axes.plot(evaluation.time, evaluation.measured[:, j], **MEASURED, label="measured")
            axes.plot(evaluation.time, evaluation.computed[:, j], **COMPUTED, label="computed")
            name = f"{evaluation.joint_names[j]} [{evaluation.units[j]}]"
            axes.set_title(name, loc="left", fontsize=7, pad=2)
            axes.locator_params(axis="y", nbins=3)
        all_axes[-1].set_xlim(0.0, evaluation.time[-1])
        all_axes[-1].set_xlabel("time [s]", labelpad=1)
        figure.text(0.02, 0.95, title, fontsize=11, fontweight="bold")
        figure.text(
            0.02, 0.917, f"shown {speed:.2g} times as fast", fontsize=7, color=palette.MUTED
        )
        handles, labels = all_axes[0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="upper right", ncols=2, frameon=False, fontsize=8)
        make_printable(figure)
        data = BytesIO()
        figure.savefig(data, format="png", dpi=dpi)
        points = all_axes[0].transData.transform([(t, 0.0) for t in times])
    background = Image.new("RGB", (_ROBOT_WIDTH + _PLOT_WIDTH, _HEIGHT), "white")
    background.paste(Image.open(data).convert("RGB"), (_ROBOT_WIDTH, 0))
    return background, [_ROBOT_WIDTH + round(x) for x, _ in points]


# ---- the robot -------------------------------------------------------------------------------------------------------


def _pictures(evaluation: Evaluation, times: Floats) -> Iterator[NDArray[np.uint8]]:
    """The robot at each time, (height, width, 3)."""
    robot = evaluation.robot
    links = []
    if robot.urdf is not None:
        links = read_scene(robot.urdf, evaluation.joint_names).links
    if not links:
        raise VideoError(f"{robot.name}: has no description with links and joints to draw")
    q = np.stack(
        [np.interp(times, evaluation.time, column) for column in evaluation.log.q.T], axis=1
    )
    with _off_screen(_ROBOT_WIDTH, _HEIGHT):
        import mujoco

        model = _scene(links)
        data = mujoco.MjData(model)
        camera = _camera(model, data, q)
        context = mujoco.MjrContext(model, mujoco.mjtFontScale.mjFONTSCALE_100)
        mujoco.mjr_setBuffer(mujoco.mjtFramebuffer.mjFB_OFFSCREEN, context)
        scene, options = mujoco.MjvScene(model, 1000), mujoco.MjvOption()
        area = mujoco.MjrRect(0, 0, _ROBOT_WIDTH, _HEIGHT)
        for positions in q:
            _pose(model, data, positions)
            mujoco.mjv_updateScene(
                model, data, options, None, camera, mujoco.mjtCatBit.mjCAT_ALL, scene
            )
            mujoco.mjr_render(area, scene, context)
            picture = np.empty((_HEIGHT, _ROBOT_WIDTH, 3), dtype=np.uint8)
            mujoco.mjr_readPixels(picture, None, area, context)
            yield picture[::-1]
        context.free()


@contextmanager
def _off_screen(width: int, height: int) -> Iterator[None]:
    """Where MuJoCo can draw without a window. Raises VideoError."""
    # MuJoCo's library reads the variable too, when it looks for OpenGL's functions.
    backend = os.environ.setdefault("MUJOCO_GL", "osmesa").lower()
    remedy = "install libosmesa6 and PyOpenGL, or choose another with MUJOCO_GL=egl"
    try:
        context = import_module(f"mujoco.{backend}").GLContext(width, height)
        context.make_current()
    except Exception as error:  # each backend and each missing library has errors of its own
        absent = backend == "osmesa" and find_library("OSMesa") is None
        reason = "libOSMesa isn't installed" if absent else error
        raise VideoError(
            f"drawing without a screen isn't possible here (MUJOCO_GL={backend}: {reason}); {remedy}"
        ) from error
    try:
        yield
    finally:
        context.free()


def _scene(links: Sequence[dict[str, Any]]) -> Any:
    """MuJoCo's model of what is to be drawn: masses are of no account."""
    import mujoco

    spec = mujoco.MjSpec()
    spec.visual.global_.fovy = _FIELD_OF_VIEW
    spec.visual.global_.offwidth, spec.visual.global_.offheight = _ROBOT_WIDTH, _HEIGHT
    quality = spec.visual.quality  # round enough for pictures of this size, at half the work
    quality.offsamples, quality.numslices, quality.numstacks, quality.numquads = 4, 24, 6, 1
    spec.visual.headlight.ambient = [0.45, 0.45, 0.45]
    spec.visual.headlight.diffuse = [0.35, 0.35, 0.35]
    spec.visual.rgba.haze = spec.visual.rgba.fog = [0.96, 0.965, 0.975, 1.0]
    spec.add_texture(
        type=mujoco.mjtTexture.mjTEXTURE_SKYBOX, builtin=mujoco.mjtBuiltin.mjBUILTIN_FLAT,
        rgb1=[0.96, 0.965, 0.975], rgb2=[0.96, 0.965, 0.975], width=16, height=96,
    )  # fmt: skip
    world = spec.worldbody
    world.add_light(
        pos=[1.0, -1.3, 3.0], dir=[-0.33, 0.42, -1.0], castshadow=False,
        type=mujoco.mjtLightType.mjLIGHT_DIRECTIONAL, diffuse=[0.45, 0.45, 0.45],
    )  # fmt: skip
    spec.add_texture(
        name="floor", type=mujoco.mjtTexture.mjTEXTURE_2D, builtin=mujoco.mjtBuiltin.mjBUILTIN_CHECKER,
        rgb1=[0.86, 0.88, 0.91], rgb2=[0.92, 0.935, 0.95], width=64, height=64,
    )  # fmt: skip
    floor = spec.add_material(name="floor", texrepeat=[2.5, 2.5], texuniform=True)
    floor.textures[mujoco.mjtTextureRole.mjTEXROLE_RGB] = "floor"
    world.add_geom(type=mujoco.mjtGeom.mjGEOM_PLANE, size=[1.4, 1.4, 0.1], material="floor")
    bodies: list[Any] = []
    for index, link in enumerate(links):
        parent = world if link["parent"] < 0 else bodies[link["parent"]]
        body = parent.add_body(
            name=f"link_{index}", mass=1.0, inertia=[1.0, 1.0, 1.0], explicitinertial=True,
            **_placed(link["pose"]),
        )  # fmt: skip
        if link["joint"] >= 0:
            kind = mujoco.mjtJoint
            slides = link["kind"] == "prismatic"
            body.add_joint(
                name=f"joint_{link['joint']}",
                type=kind.mjJNT_SLIDE if slides else kind.mjJNT_HINGE,
                axis=link["axis"],
            )
        for shape in link["shapes"]:
            _add_shape(spec, body, shape)
        bodies.append(body)
    return spec.compile()


def _add_shape(spec: Any, body: Any, shape: dict[str, Any]) -> None:
    """A shape, whose sizes are those of URDF, as a geom, whose are halves."""
    import mujoco

    if shape["kind"] == "mesh":
        _add_mesh(spec, body, shape)
        return
    s = shape["size"]
    kind, size = {
        "box": lambda: (mujoco.mjtGeom.mjGEOM_BOX, [s[0] / 2, s[1] / 2, s[2] / 2]),
        "cylinder": lambda: (mujoco.mjtGeom.mjGEOM_CYLINDER, [s[0], s[1] / 2, 0.0]),
        "sphere": lambda: (mujoco.mjtGeom.mjGEOM_SPHERE, [s[0], 0.0, 0.0]),
    }[shape["kind"]]()
    body.add_geom(
        type=kind, size=size, rgba=[*shape["color"], 1.0], mass=0.0, **_placed(shape["pose"])
    )


def _add_mesh(spec: Any, body: Any, shape: dict[str, Any]) -> None:
    """A mesh as a geom; MuJoCo needs a volume, so flat ones are left out."""
    import mujoco

    vertices, triangles = decoded_mesh(shape)
    if np.linalg.matrix_rank(vertices - vertices[0], tol=1e-6) < 3:
        return
    name = f"mesh_{len(spec.meshes)}"
    mesh = spec.add_mesh(name=name, inertia=mujoco.mjtMeshInertia.mjMESH_INERTIA_SHELL)
    mesh.uservert, mesh.userface = vertices.ravel(), triangles.ravel()
    body.add_geom(
        type=mujoco.mjtGeom.mjGEOM_MESH, meshname=name, rgba=[*shape["color"], 1.0], mass=0.0,
        contype=0, conaffinity=0, **_placed(shape["pose"]),
    )  # fmt: skip


def _placed(columns: Sequence[float]) -> dict[str, Any]:
    """A pose, 4 x 4 column by column, as MuJoCo's position and quaternion."""
    import mujoco

    pose = np.reshape(columns, (4, 4)).T
    quaternion = np.empty(4)
    mujoco.mju_mat2Quat(quaternion, pose[:3, :3].flatten())
    return {"pos": pose[:3, 3], "quat": quaternion}


def _pose(model: Any, data: Any, q: Floats) -> None:
    """Poses of all links at joint positions q."""
    import mujoco

    for j, position in enumerate(q):
        data.qpos[model.joint(f"joint_{j}").qposadr[0]] = position
    mujoco.mj_kinematics(model, data)
    mujoco.mj_comPos(model, data)
    mujoco.mj_camlight(model, data)


def _camera(model: Any, data: Any, q: Floats) -> Any:
    """A camera that has the robot in view all the time."""
    import mujoco

    points = []
    for positions in q[:: max(1, len(q) // 60)]:
        _pose(model, data, positions)
        points.append(data.xpos[1:].copy())
    places = np.concatenate([*points, np.zeros((1, 3))])
    low, high = places.min(axis=0), places.max(axis=0)
    radius = 0.12 + np.linalg.norm(high - low) / 2
    camera = mujoco.MjvCamera()
    camera.lookat = (low + high) / 2
    camera.distance = 0.8 * radius / np.tan(np.radians(_FIELD_OF_VIEW) / 2)
    camera.azimuth, camera.elevation = 128.0, -20.0
    return camera
