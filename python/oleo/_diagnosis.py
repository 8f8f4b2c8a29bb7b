"""The diagnosis of recordings against a model."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import pandas as pd

from . import _oleo
from ._columns import columns_of
from ._model import Model, ModelLike, model_of
from ._oleo import OleoError
from ._progress import Tell, shown


@dataclass(frozen=True)
class Parameter:
    """A fitted parameter with its 95 % interval. The unit is at the end of ``key``; an end that is not determined is ``None``."""

    key: str
    value: float
    low: float | None
    high: float | None


@dataclass(frozen=True)
class Effect:
    """Physics that the model leaves out.

    ``id`` and ``place`` are those of the vocabulary of ``docs/diagnose.md``. ``noise_ratio_without`` and ``noise_ratio_with`` say
    how well held-out blocks are predicted, as a multiple of the sensors' noise. ``law`` is set for a law without a name.
    """

    id: str
    place: str
    confidence: float
    parameters: tuple[Parameter, ...]
    noise_ratio_without: float
    noise_ratio_with: float
    law: Any = field(default=None, compare=False)


class Effects(Sequence[Effect]):
    """The effects that were found, the most important first."""

    def __init__(self, effects: Iterable[Effect]) -> None:
        self._effects = tuple(effects)

    def __getitem__(self, index: Any) -> Any:
        found = self._effects[index]
        return Effects(found) if isinstance(index, slice) else found

    def __len__(self) -> int:
        return len(self._effects)

    def __repr__(self) -> str:
        return f"Effects({list(self._effects)!r})"

    def _repr_html_(self) -> str:
        return self.to_frame().to_html(index=False)

    def to_frame(self) -> pd.DataFrame:
        """A row for each parameter of each effect."""
        names = ["id", "place", "confidence", "parameter", "value", "ci95_low", "ci95_high"]
        names += ["noise_ratio_without", "noise_ratio_with"]
        rows = [
            (effect.id, effect.place, effect.confidence, parameter.key, parameter.value, parameter.low, parameter.high)
            + (effect.noise_ratio_without, effect.noise_ratio_with)
            for effect in self._effects
            for parameter in effect.parameters or (Parameter("", float("nan"), None, None),)
        ]
        frame = pd.DataFrame(rows, columns=names)
        return frame.astype({"ci95_low": float, "ci95_high": float})


def _effect(entry: dict[str, Any]) -> Effect:
    parameters = entry["parameters"].items()
    ratio = entry["held_out_noise_ratio"]
    return Effect(
        id=entry["id"],
        place=entry["place"],
        confidence=entry["confidence"],
        parameters=tuple(Parameter(key, found["value"], *found["ci95"]) for key, found in parameters),
        noise_ratio_without=ratio["without"],
        noise_ratio_with=ratio["with"],
        law=entry["law"],
    )


class Diagnosis:
    """What was found in recordings, as ``oleo diagnose`` finds it."""

    def __init__(self, findings: _oleo.Findings) -> None:
        self._findings = findings
        self._report: dict[str, Any] = json.loads(findings.report_json())
        self._effects = Effects(_effect(entry) for entry in self._report["effects"])

    @property
    def verdict(self) -> str:
        """The result in a word or two, as in ``report.json``."""
        return self._findings.verdict

    @property
    def effects(self) -> Effects:
        """The physics that the model leaves out; empty if it is complete."""
        return self._effects

    @property
    def model(self) -> Model:
        """The improved model. The believed one with the effects, and calibrated within its tolerances."""
        return Model(self._findings.model_toml, f"the improved {self._findings.name}")

    @property
    def as_dict(self) -> dict[str, Any]:
        """The content of ``report.json``: everything that was found (``docs/results-files.md``)."""
        return self._report

    def report(self, out: str | os.PathLike[str], *, force: bool = False) -> Path:
        """Writes ``report.json``, ``report.html`` (opens offline) and the improved ``model.toml`` into a folder.

        A folder with files of others is refused unless ``force`` is set. Returns the path of the page.
        """
        return Path(self._findings.write(os.fspath(out), force))

    def __str__(self) -> str:
        return self._findings.text()

    def __repr__(self) -> str:
        return f"<Diagnosis of {self._findings.name}: {self.verdict}, {len(self.effects)} effects>"


def diagnose(
    recordings: Mapping[str, pd.DataFrame | Mapping[str, Any]],
    model: ModelLike,
    *,
    hold_out: Sequence[str] = (),
    fit_until: float | None = None,
    seed: int | None = None,
    progress: bool | Tell | None = None,
) -> Diagnosis:
    """Finds the physics that a model leaves out, as ``oleo diagnose`` does.

    ``recordings``: by name, data frames with a row for each sample and columns in SI units. A strut needs ``time_s,
    displacement_m, valve1, valve2, valve3`` and the channels that its model states noise for, such as ``p1_Pa`` and ``force_N``.
    ``model``: an :class:`oleo.Model` or the path of a model file, the specimen as it is believed to be, with ``[noise]``.
    ``hold_out``: names of recordings that are not fitted but predicted. ``fit_until``: fraction of each recording, from its start,
    that is fitted (0.05 to 0.95); the rest is predicted. ``seed`` is only stated in ``report.json``, because the diagnosis draws
    nothing at random. ``progress``: ``False`` shows none, and a function is told the phase and the part that is done.

    The result is the same, to the last bit, as that of the command line on files with the same content.
    """
    if not isinstance(recordings, Mapping) or isinstance(recordings, pd.DataFrame):
        raise OleoError(f"recordings: is {type(recordings).__name__}; give a dict of data frames by name")
    if isinstance(hold_out, str):
        raise OleoError(f"hold_out is {hold_out!r}: give a list of names")
    if fit_until is not None and not 0.05 <= fit_until <= 0.95:
        raise OleoError(f"fit_until is {fit_until}: give a fraction of the recording from 0.05 to 0.95, such as 0.5")
    if seed is not None and not 0 <= seed < 2**63:
        raise OleoError(f"seed is {seed}: give a whole number from 0 to 2^63 - 1")
    model = model_of(model)
    frames = [(str(name), *columns_of(table, str(name))) for name, table in recordings.items()]
    with shown("oleo diagnose", progress) as tell:
        findings = _oleo.diagnose(
            frames, model.to_toml(), model.name, list(hold_out), fit_until, seed, tell
        )
    return Diagnosis(findings)
