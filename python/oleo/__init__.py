"""Finds the physics that a model of a suspension leaves out; simulates the strut, the vehicle and its controller.

Recordings are data frames whose columns are named as those of recordings in files: SI units, the unit at the end of the name
(``time_s``, ``displacement_m``, ``p1_Pa``, ``force_N``, ``valve1``). Every complaint is an :class:`OleoError` with one line
that says what is wrong, where, and what to do. The interpreter is released while Rust works, and Ctrl-C stops it.
"""

from ._diagnosis import Diagnosis, Effect, Effects, Parameter, diagnose
from ._model import Model, ModelLike
from ._oleo import OleoError
from ._prediction import predict
from ._runs import drive, hil
from ._strut import Strut

__all__ = [
    "Diagnosis",
    "Effect",
    "Effects",
    "Model",
    "ModelLike",
    "OleoError",
    "Parameter",
    "Strut",
    "diagnose",
    "drive",
    "hil",
    "predict",
]
