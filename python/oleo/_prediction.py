"""What a model predicts of a recording."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import pandas as pd

from . import _oleo
from ._columns import columns_of, frame_of
from ._model import ModelLike, model_of


def predict(model: ModelLike, recording: pd.DataFrame | Mapping[str, Any], *, name: str = "recording") -> pd.DataFrame:
    """Simulates the inputs of a recording with a model, as ``oleo predict`` does.

    ``model``: an :class:`oleo.Model` or the path of a model file of a strut, a gas spring, a cylinder, a damper or a drive.
    ``recording``: a row for each sample, SI. A strut needs ``time_s, displacement_m, valve1, valve2, valve3``; see
    ``docs/diagnose.md`` for the others. ``name`` is what complaints call the recording.

    Returns a data frame with the inputs and the predicted channels (``force_N``, ``p1_Pa`` ...), a row for each sample. Its
    ``attrs["noise_ratio"]`` has, for each channel that was recorded, the RMS of recording minus prediction divided by the
    noise that the model states; 1 means that only noise is left.
    """
    model = model_of(model)
    columns, judged = _oleo.predict(model.to_toml(), model.name, name, *columns_of(recording, name))
    frame = frame_of(columns)
    frame.attrs["noise_ratio"] = {channel: rms / noise for channel, rms, noise in judged if noise}
    return frame
