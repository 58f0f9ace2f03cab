# SPDX-License-Identifier: Apache-2.0
"""A mass of the description that is wrong by a factor."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from inverse_dynamics.evaluation.causes.rival import Rival, Told, printed

if TYPE_CHECKING:
    from inverse_dynamics.base.arrays import Floats
    from inverse_dynamics.evaluation.causes.arm import View
    from inverse_dynamics.evaluation.causes.fit import Fitting

_FACTORS = (0.01, 100.0)  # of a slip of the pen: a decimal, a unit
_ROUGH = 0.25  # relative: of a maker's estimates
_LEAST = 1.8  # factor, either way: smaller ones are a maker's estimate


def rivals(view: View, _: Fitting) -> Iterator[Rival]:
    """Torques are linear in each link's inertial parameters."""
    if view.arm.links is None or view.arm.compared_without_gravity:
        return
    for k, part in enumerate(view.arm.links(*view.motion)):
        yield Rival(
            "mass",
            view.computed,
            view.qd,
            partial(_tell, view, k % len(view.names)),
            columns=(part,),
            low=(_FACTORS[0] - 1,),
            high=(_FACTORS[1] - 1,),
        )


def rough(view: View) -> Rival:
    """Masses that a maker has estimated: nobody's mistake, and no other cause if they explain as much."""
    if view.arm.links is not None and not view.arm.compared_without_gravity:
        parts = view.arm.links(*view.motion)[: len(view.names)]
        low, high = (-_ROUGH,) * len(parts), (_ROUGH,) * len(parts)
        return Rival("rough", view.computed, view.qd, columns=tuple(parts), low=low, high=high)
    most = np.full(len(view.names), _ROUGH)
    return Rival(
        "rough",
        view.computed,
        view.qd,
        own=(view.computed,),
        own_low=(-most,),
        own_high=(most,),
    )


def _tell(view: View, link: int, change: Floats, _: Floats) -> Told | None:
    factor = printed(1 + change[0], 2)
    if max(factor, 1 / factor) < _LEAST:
        return None
    name = view.arm.link_names[link] if view.arm.link_names else f"of joint {view.names[link]}"
    return Told(
        "mass",
        "A mass of the description is wrong",
        f"torques match if link {name} has {factor:g} times the mass of the description",
        f"correct <mass> of link {name} in the description",
        (view.names[link],),
        value=factor,
        shared=np.array([factor - 1]),
    )
