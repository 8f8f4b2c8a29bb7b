"""Model files: what a strut, a gas spring, a cylinder, a damper or a drive is believed to be."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TypeAlias

from . import _oleo
from ._oleo import OleoError


class Model:
    """A model as the text of its file.

    It is checked where it is used, because what a file must have depends on that.
    """

    def __init__(self, toml: str, name: str = "model") -> None:
        """``toml`` is the text of a model file, and ``name`` what complaints call it."""
        if not isinstance(toml, str):
            raise OleoError(f"model: is {type(toml).__name__}, not the text of a model file")
        self._toml = toml
        self._name = name

    @classmethod
    def read(cls, path: str | os.PathLike[str]) -> Model:
        """Reads a model file."""
        name = os.fspath(path)
        return cls(_oleo.read_model(name), name)

    @classmethod
    def built_in(cls) -> Model:
        """The two-stage hydropneumatic strut of the built-in vehicle, one corner."""
        return cls(_oleo.built_in_strut(), "the built-in strut")

    @property
    def name(self) -> str:
        """Path of the file, or what complaints call the model."""
        return self._name

    def to_toml(self) -> str:
        """The text of the model file."""
        return self._toml

    def save(self, path: str | os.PathLike[str]) -> Path:
        """Writes the model file, which ``oleo predict``, ``oleo rig`` and ``oleo hil`` accept."""
        path = Path(path)
        path.write_text(self._toml, encoding="utf-8")
        return path

    def __repr__(self) -> str:
        return f"Model({self._name!r})"


#: A model, or the path of its file.
ModelLike: TypeAlias = Model | str | os.PathLike[str]


def model_of(model: ModelLike) -> Model:
    """The model that a user gave."""
    if isinstance(model, Model):
        return model
    if isinstance(model, (str, os.PathLike)):
        return Model.read(model)
    raise OleoError(f"model: is {type(model).__name__}; give the path of a model file, or an oleo.Model")
