"""The vehicle with its controller: over the bus, and without it."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from typing import Any, overload

import pandas as pd

from . import _oleo
from ._columns import frame_of
from ._oleo import OleoError
from ._progress import Tell, shown

Path = str | os.PathLike[str]


def hil(
    scenario: Path = "belgian",
    *,
    road: Path | None = None,
    manoeuvre: str | None = None,
    speed_km_h: float | None = None,
    duration_s: float | None = None,
    strategy: str | None = None,
    damper_policy: str | None = None,
    strut: Path | None = None,
    strut_at: Mapping[str, Path] | None = None,
    vehicle: Path | None = None,
    handling: Path | None = None,
    load: str | None = None,
    seed: int | None = None,
    driver: str | None = None,
    entry_m: float | None = None,
    radius_m: float | None = None,
    steer_deg: float | None = None,
    change_m_s2: float | None = None,
    begin_s: float | None = None,
    side_slope_percent: float | None = None,
    progress: bool | Tell | None = None,
) -> pd.DataFrame:
    """Closes the loop: plant and controller communicate through CAN frames in memory, in lockstep, as in ``oleo hil``.

    ``scenario``: name of a built-in scenario, or path of a scenario file. The other settings replace the scenario's and are those
    of ``oleo hil``: speed in km/h, times in s, lengths in m, angles in degrees. ``strut_at``: struts of single corners that differ, such
    as ``{"rear-left": "weak.toml"}``. ``progress``: ``False`` shows none, and a function is told the phase and the part that is done.

    Returns a data frame with a row for each tick of 5 ms and the columns of ``timeseries.csv`` (``docs/results-files.md``).
    ``attrs["summary"]`` is the content of ``summary.json``; ``attrs["passed"]`` says whether all checks of the scenario are met.
    """
    settings = {name: value for name, value in locals().items() if name not in ("scenario", "progress")}
    with shown("oleo hil", progress) as tell:
        columns, words, summary, passed = _oleo.hil(os.fspath(scenario), settings, tell)
    frame = frame_of(columns)
    for name, values in words:
        frame[name] = pd.Categorical(values)
    frame.attrs.update(summary=json.loads(summary), passed=passed)
    return frame


@overload
def drive(manoeuvre: str, *, setting: str = ..., model: str = ..., **settings: Any) -> pd.DataFrame: ...
@overload
def drive(manoeuvre: str, *, setting: Sequence[str], model: str = ..., **settings: Any) -> dict[str, pd.DataFrame]: ...
# The overloads tell one setting from several; the names of all others are here alone.
def drive(  # type: ignore[misc]
    manoeuvre: str,
    *,
    setting: str | Sequence[str] = "controlled",
    model: str = "handling",
    speed_km_h: float | None = None,
    road: Path | None = None,
    load: str | None = None,
    gas_temperature_c: float | None = None,
    duration_s: float | None = None,
    score_from_s: float | None = None,
    seed: int | None = None,
    vehicle: Path | None = None,
    handling: Path | None = None,
    strut: Path | None = None,
    driver: str | None = None,
    entry_m: float | None = None,
    radius_m: float | None = None,
    steer_deg: float | None = None,
    change_m_s2: float | None = None,
    begin_s: float | None = None,
    side_slope_percent: float | None = None,
    progress: bool | Tell | None = None,
) -> pd.DataFrame | dict[str, pd.DataFrame]:
    """Drives a vehicle through a manoeuvre without the bus, as ``oleo drive`` does.

    ``manoeuvre``: such as ``lane-change``, ``belgian`` or ``constant-radius``. ``setting``: the suspension, one of ``soft``,
    ``stiff``, ``controlled`` and ``baseline``, or a list of them. ``model``: ``handling``, ``ride`` or ``both``. The other settings
    are those of ``oleo drive``: speed in km/h, times in s, lengths in m, angles in degrees, temperature in degrees Celsius.

    Returns a data frame with a row for each tick of 5 ms, with the columns of the CSV file (``docs/results-files.md``). Of several
    settings or of both models it is a dict of data frames by name. ``attrs["figures"]`` are the figures of the summary.
    """
    taken = ("manoeuvre", "setting", "progress")
    settings = {name: value for name, value in locals().items() if name not in taken}
    several = not isinstance(setting, str)
    try:
        chosen = [setting] if isinstance(setting, str) else list(setting)
    except TypeError:
        raise OleoError(f"setting is {setting}: give a name, or a list of names") from None
    with shown("oleo drive", progress) as tell:
        drives = _oleo.drive(manoeuvre, chosen, settings, tell)
    frames = {}
    for name, columns, figures in drives:
        frames[name] = frame_of(columns)
        frames[name].attrs["figures"] = json.loads(figures)
    if several and len(chosen) == 1 and model != "both":
        return {chosen[0]: frame for frame in frames.values()}
    return frames if several or model == "both" else next(iter(frames.values()))
