"""What Rust offers the package; nothing here is for users."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Columns = list[tuple[str, Floats]]
Progress = Callable[[str, float], object]

class OleoError(ValueError): ...

class Findings:
    name: str
    verdict: str
    model_toml: str
    def text(self) -> str: ...
    def report_json(self) -> str: ...
    def write(self, out: str, force: bool) -> str: ...

class Strut:
    def __new__(cls, model_toml: str, model_file: str) -> Strut: ...
    def replay(
        self, time_s: Floats, displacement_m: Floats, valves: NDArray[np.bool_], noise_m: float
    ) -> Floats: ...

def diagnose(
    recordings: list[tuple[str, dict[str, Floats], list[tuple[str, str]]]],
    model_toml: str,
    model_file: str,
    hold_out: list[str],
    fit_until: float | None,
    seed: int | None,
    progress: Progress | None,
) -> Findings: ...
def predict(
    model_toml: str, model_file: str, name: str, columns: dict[str, Floats], others: list[tuple[str, str]]
) -> tuple[Columns, list[tuple[str, float, float | None]]]: ...
def hil(
    scenario: str, settings: dict[str, object], progress: Progress | None
) -> tuple[Columns, list[tuple[str, list[str]]], str, bool]: ...
def drive(
    manoeuvre: str, setting: list[str], settings: dict[str, object], progress: Progress | None
) -> list[tuple[str, Columns, str]]: ...
def read_model(path: str) -> str: ...
def built_in_strut() -> str: ...
