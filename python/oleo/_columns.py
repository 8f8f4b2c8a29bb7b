"""Data frames as the columns that Rust takes, and back."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from ._oleo import OleoError

#: The columns of numbers by name, and name and type of each other column.
Split = tuple[dict[str, NDArray[np.float64]], list[tuple[str, str]]]


def is_number(dtype: Any) -> bool:
    """Whether values of a type are real numbers."""
    return pd.api.types.is_numeric_dtype(dtype) and not pd.api.types.is_complex_dtype(dtype)


def columns_of(table: pd.DataFrame | Mapping[str, Any], name: str) -> Split:
    """The columns of a recording. Missing values become NaN, which Rust refuses with the row."""
    if not isinstance(table, pd.DataFrame):
        if not isinstance(table, Mapping):
            raise OleoError(f"{name}: is {type(table).__name__}; give a pandas.DataFrame")
        try:
            table = pd.DataFrame(dict(table))
        except ValueError as error:
            raise OleoError(f"{name}: is no table: {error}") from None
    titles = [str(title) for title in table.columns]
    if len(set(titles)) < len(titles):
        twice = next(title for title in titles if titles.count(title) > 1)
        raise OleoError(f"{name}: has two columns '{twice}'; give each a name of its own")
    numbers, others = {}, []
    for title, (_, column) in zip(titles, table.items(), strict=True):
        if is_number(column.dtype):
            numbers[title] = np.ascontiguousarray(column.to_numpy(dtype=np.float64, na_value=np.nan))
        else:
            others.append((title, str(column.dtype)))
    return numbers, others


def frame_of(columns: list[tuple[str, NDArray[np.float64]]]) -> pd.DataFrame:
    """Columns as a data frame."""
    return pd.DataFrame(dict(columns), copy=False)


def vector(values: Any, name: str, samples: int | None = None) -> NDArray[np.float64]:
    """An array (n,) of numbers; ``samples`` is the n that it must have."""
    array = np.asarray(values)
    if not is_number(array.dtype):
        raise OleoError(f"{name}: holds {array.dtype}, not numbers; give an array of numbers")
    if array.ndim != 1 or (samples is not None and len(array) != samples):
        wanted = "(n,)" if samples is None else f"({samples},)"
        raise OleoError(f"{name}: has the shape {array.shape}; give an array of shape {wanted}")
    return np.ascontiguousarray(array, dtype=np.float64)
