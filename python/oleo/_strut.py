"""One strut, simulated from motion and switching signals."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _oleo
from ._columns import vector
from ._model import ModelLike, model_of
from ._oleo import OleoError


class Strut:
    """A two-stage hydropneumatic strut, charged for the load that its model file states.

    >>> import numpy as np, oleo
    >>> t = np.arange(0.0, 2.0, 0.005)
    >>> x = 0.03 * np.sin(2 * np.pi * t)
    >>> force_and_pressures = oleo.Strut(oleo.Model.built_in()).replay(t, x, np.zeros((len(t), 3)))
    >>> force_and_pressures.shape
    (400, 5)
    """

    #: Names of the columns that :meth:`replay` returns.
    CHANNELS = ("force_N", "p1_Pa", "p2_Pa", "p3_Pa", "p4_Pa")

    def __init__(self, model: ModelLike) -> None:
        """``model`` is an :class:`oleo.Model`, or the path of a model file of a strut."""
        model = model_of(model)
        self._strut = _oleo.Strut(model.to_toml(), model.name)

    def replay(
        self, t: ArrayLike, x: ArrayLike, valves: ArrayLike, *, noise_m: float = 0.0
    ) -> NDArray[np.float64]:
        """Simulates the strut freely along a motion.

        ``t``: array (n,), time in s, increasing. ``x``: array (n,), displacement in m, compression positive.
        ``valves``: array (n, 3), switching signals of valves 1 to 3, 0 or False for closed, 1 or True for open; a signal holds
        from its row to the next. ``noise_m``: standard deviation in m of the noise of a measured ``x``, by which it is
        smoothed; 0 for a motion that is exact.

        Returns an array (n, 5): force in N, and the gauge pressures p1 to p4 in Pa, at the times of ``t``.
        """
        time = vector(t, "t")
        displacement = vector(x, "x", len(time))
        signals = np.asarray(valves)
        if signals.shape != (len(time), 3):
            raise OleoError(f"valves: has the shape {signals.shape}; give an array of shape ({len(time)}, 3)")
        if signals.dtype != np.bool_:
            if not np.issubdtype(signals.dtype, np.number) or not np.isin(signals, (0, 1)).all():
                raise OleoError("valves: a switching signal is 0 (closed) or 1 (open)")
            signals = signals == 1
        if len(time) < 2:
            raise OleoError(f"t: has {len(time)} values; a replay needs two or more")
        if not 0.0 <= noise_m < 1.0:
            raise OleoError(f"noise_m is {noise_m}: give a standard deviation in m, 0 to 1")
        return self._strut.replay(time, displacement, np.ascontiguousarray(signals), float(noise_m))
