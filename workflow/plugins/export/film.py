"""A film of a run: beads and springs near the front, and the map of velocity in space and time with a cursor."""

import errno
import itertools
import math
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import EllipseCollection, LineCollection
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, MaxNLocator
from numpy.typing import NDArray

from granchain import InputError
from granchain.parts import Floats, Integers, Problem, Trajectory, drawing, panels, radii, screen, spacetime, style
from workflow.plugins.export.atoms import springs
from workflow.plugins.export.registry import FORMATS
from workflow.plugins.export.request import ExportRequest, Writers

BEADS_IN_SIGHT = 40
"""Beads that are drawn, about the front."""

EXAGGERATED = 0.25
"""Distances between neighbouring beads for a displacement of L, as on the page of a run."""

INCHES = 8.0
"""Width of a picture; its pixels an inch follow, so that text is as large in a wide film."""

APART = 1.6
"""Distance of two chains, in distances between neighbouring beads."""

Picture = NDArray[np.uint8]
"""[row, column, colour]"""


def mp4(request: ExportRequest) -> Writers:
    """The film in H.264, which browsers and slides play."""
    return {FORMATS["mp4"].file: lambda path: _write_mp4(request, path)}


def gif(request: ExportRequest) -> Writers:
    """The film as GIF, with the 256 colours of its first picture."""
    return {FORMATS["gif"].file: lambda path: _write_gif(request, path)}


def _write_mp4(request: ExportRequest, path: Path) -> None:
    import imageio_ffmpeg

    pictures = _pictures(request, FORMATS["mp4"].file)
    first = next(pictures)
    size = first.shape[1], first.shape[0]
    writer = imageio_ffmpeg.write_frames(
        str(path),
        size,
        fps=request.options.rate,
        quality=8,
        macro_block_size=2,
        ffmpeg_log_level="quiet",
        output_params=["-f", "mp4"],
    )
    count = 0
    try:
        writer.send(None)
        for picture in itertools.chain((first,), pictures):
            writer.send(np.ascontiguousarray(picture))
            count += 1
        writer.close()
        complete = imageio_ffmpeg.count_frames_and_secs(str(path))[0] == count
    except (OSError, RuntimeError):  # a pipe that nobody reads any more; no film
        complete = False
    finally:
        writer.close()
    if not complete:
        raise OSError(errno.EIO, "ffmpeg has not written all pictures; is the disk full?")


def _write_gif(request: ExportRequest, path: Path) -> None:
    from PIL import Image

    pictures = _pictures(request, FORMATS["gif"].file)
    first = Image.fromarray(next(pictures)).quantize(256, dither=Image.Dither.NONE)
    others = (Image.fromarray(picture).quantize(palette=first, dither=Image.Dither.NONE) for picture in pictures)
    duration = round(1000 / request.options.rate)
    first.save(path, format="GIF", save_all=True, append_images=others, duration=duration, loop=0)


def _pictures(request: ExportRequest, name: str) -> Iterator[Picture]:
    """The pictures of a film, one at a time: frames at equal distances in time."""
    directory, options = request.directory, request.options
    problem = directory.problem
    motion_map = spacetime.space_time_meter(problem).read(directory.blocks())
    frames = len(motion_map.time)
    if frames < 2 or len(problem.rows.numbers) < 2:
        raise InputError(f"{directory.path}: has one frame or records one bead, of which there is no film")
    recorded = round(motion_map.until / problem.every) + 1
    count = min(max(2, round(options.seconds * options.rate)), recorded)
    wanted = np.round(np.linspace(0, recorded - 1, count)).astype(int)
    stage = _Stage(problem, motion_map, radii(directory.scene.setting), options.pixels)
    started, done, read = perf_counter(), 0, 0
    with screen.count_bar(name) as progress:
        for block in directory.blocks():
            for place in wanted[(wanted >= read) & (wanted < read + block.frames)] - read:
                yield stage.picture(block[int(place) : int(place) + 1])
                done += 1
                progress(done, count)
                if done == 5:
                    seconds = (perf_counter() - started) / done * count
                    screen.hint(f"{name}: {count} pictures, about {max(1, round(seconds))} s")
            read += block.frames


@dataclass(frozen=True)
class _Drawn:
    """What changes from one picture to the next."""

    axis: Axes
    beads: EllipseCollection
    springs: LineCollection
    clock: Any
    cursors: list[Any]


class _Stage:
    """A figure with the beads and the maps; what does not change is drawn once.

    Args:
        problem: what is shown.
        motion_map: velocity in space and time.
        relative_radii: radius of each bead over that of the reference bead, [chain, bead].
        pixels: width of a picture.
    """

    def __init__(
        self, problem: Problem, motion_map: spacetime.BeadHistory, relative_radii: Floats, pixels: int
    ) -> None:
        self._problem = problem
        self._chains = panels.shown_chains(problem)
        self._beads = problem.rows.numbers
        size = relative_radii[self._chains][:, self._beads - 1]
        self._widths = 0.95 * size / np.max(size)
        self._scale = spacetime.RootScale.of(problem, motion_map.beads, motion_map.velocity)
        self._front = 0
        self._figure, self._drawn, self._time = self._laid_out(motion_map, pixels)
        self._canvas: Any = FigureCanvasAgg(self._figure)
        self._background = self._drawn_once()

    @style.styled
    def _laid_out(self, motion_map: spacetime.BeadHistory, pixels: int) -> tuple[Figure, _Drawn, panels.AxisUnit]:
        """Figure with the beads above the maps, and the unit of times."""
        sight = min(BEADS_IN_SIGHT, len(self._beads))
        rows, _ = spacetime.panels(self._problem, len(motion_map.chains))
        row_inches = INCHES / (sight + 1)
        above = max(1.0, row_inches * APART * len(self._chains) + 0.55)
        figure = Figure(figsize=(INCHES, 0.3 + above + 0.6 + 2.4 * rows), layout="constrained")
        figure.suptitle(panels.title(self._problem, each_chain=True, panels=True))
        subfigures: Any = figure.subfigures(2, 1, height_ratios=[above, 0.6 + 2.4 * rows])
        maps = drawing.draw_panels(subfigures[1], spacetime.spacetime_sheet(motion_map))
        time = panels.axis_unit(self._problem, "time", motion_map.time[-1])
        axis = subfigures[0].subplots()
        beads = EllipseCollection(
            [],
            [],
            [],
            units="xy",
            offsets=np.empty((0, 2)),
            offset_transform=axis.transData,
            cmap=spacetime.RootScale.PALETTE,
            norm=self._scale.norm,
            edgecolors="0.35",
            linewidths=0.5,
        )
        springs_between = LineCollection([], colors="#7a5195", linewidths=1.5, zorder=0.5)
        axis.add_collection(springs_between)
        axis.add_collection(beads)
        axis.set_aspect("equal")
        axis.set_ylim(-APART * (len(self._chains) - 1) - 0.8, 0.8)
        axis.set_xlim(0.25, sight + 0.75)
        axis.set_yticks([-APART * k for k in range(len(self._chains))], [f"chain {k + 1}" for k in self._chains])
        axis.tick_params(left=False)
        axis.xaxis.set_major_locator(MaxNLocator(8, integer=True))
        axis.xaxis.set_major_formatter(FuncFormatter(self._number))
        axis.spines["left"].set_visible(False)
        axis.set_xlabel(f"bead (a displacement of L is drawn as {EXAGGERATED:g} of a bead)")
        clock = axis.set_title("t", loc="right")
        cursors: list[Any] = [each.axhline(0.0, color="black", linewidth=1.0) for each in maps]
        cursors += [each.axvspan(0.0, 1.0, ymax=0.02, color="black") for each in maps]
        figure.set_dpi(pixels / INCHES)
        return figure, _Drawn(axis, beads, springs_between, clock, cursors), time

    @style.styled
    def _drawn_once(self) -> Any:
        """Picture of what does not change, after the figure has been laid out."""
        engine = self._figure.get_layout_engine()
        if engine is not None:
            engine.execute(self._figure)
            self._figure.set_layout_engine("none")
        changing = [self._drawn.axis, *self._drawn.cursors]
        for artist in changing:
            artist.set_visible(False)
        self._canvas.draw()
        for artist in changing:
            artist.set_visible(True)
        return self._canvas.copy_from_bbox(self._figure.bbox)

    def _number(self, place: float, _: object) -> str:
        """Number of the bead at a place of the axis, which counts recorded beads from 1."""
        column = round(place) - 1
        return str(self._beads[column]) if 0 <= column < len(self._beads) else ""

    @style.styled
    def picture(self, frame: Trajectory) -> Picture:
        """Picture of one frame."""
        if self._problem.rows.follow:
            frame = frame.on(1, self._problem.beads, behind=np.nan)
        first, last = self._in_sight(frame)
        chosen = slice(first, last)
        x, v = frame.displacement[0][self._chains, chosen], frame.velocity[0][self._chains, chosen]
        place = np.arange(first + 1, last + 1) + EXAGGERATED * np.nan_to_num(x)
        height = np.broadcast_to(-APART * np.arange(len(self._chains))[:, np.newaxis], place.shape)
        drawn = self._drawn
        drawn.beads.set_offsets(np.stack([place.ravel(), height.ravel()], axis=1))
        widths = self._widths[:, chosen].ravel()
        drawn.beads.set_widths(widths)
        drawn.beads.set_heights(widths)
        drawn.beads.set_angles(np.zeros(len(widths)))
        drawn.beads.set_array(np.ma.masked_invalid(v.ravel()))
        drawn.springs.set_segments(self._segments(place, height, self._beads[chosen] - 1))
        time = float(frame.time[0]) * self._time.worth
        unit = f" {self._time.symbol}" if self._problem.scale.si else ""
        drawn.clock.set_text(f"t = {time:.{self._digits}f}{unit}")
        drawn.axis.set_xlim(first + 0.25, last + 0.75)
        for cursor in drawn.cursors[: len(drawn.cursors) // 2]:
            cursor.set_ydata([time, time])
        for bar in drawn.cursors[len(drawn.cursors) // 2 :]:
            bar.set_x(float(self._beads[first]) - 0.5)
            bar.set_width(float(self._beads[last - 1] - self._beads[first]) + 1.0)
        self._canvas.restore_region(self._background)
        renderer = self._canvas.get_renderer()
        for artist in (drawn.axis, *drawn.cursors):
            artist.draw(renderer)
        pixels = np.asarray(self._canvas.buffer_rgba())[..., :3]
        return np.array(pixels[: pixels.shape[0] // 2 * 2, : pixels.shape[1] // 2 * 2])

    @property
    def _digits(self) -> int:
        """Digits of the time after the point: those of a thousandth of the run."""
        return max(0, 3 - math.ceil(math.log10(self._problem.duration * self._time.worth)))

    def _in_sight(self, frame: Trajectory) -> tuple[int, int]:
        """First place that is drawn and the one after the last: a quarter of them is ahead of the front."""
        count, sight = len(self._beads), min(BEADS_IN_SIGHT, len(self._beads))
        fast = np.flatnonzero(self._scale.moves(frame.velocity[0]))
        forwards = self._problem.direction > 0
        if len(fast):  # counted along the way of the pulse
            self._front = max(self._front, int(fast[-1]) if forwards else count - 1 - int(fast[0]))
        first = min(max(0, self._front + 1 - 3 * sight // 4), count - sight)
        return (first, first + sight) if forwards else (count - first - sight, count - first)

    def _segments(self, place: Floats, height: Floats, rows: Integers) -> list[Floats]:
        """Ends of the springs between chains that are shown, in rows of beads [row] counted from 0."""
        shown = {chain: k for k, chain in enumerate(self._chains)}
        segments = []
        for lower, higher, acts in springs(self._problem):
            if lower in shown and higher in shown:
                a, b = shown[lower], shown[higher]
                for column in np.flatnonzero(acts[rows]):
                    ends = (place[a, column], height[a, column]), (place[b, column], height[b, column])
                    segments.append(np.array(ends))
        return segments
