"""The bush of a film whose bearing was built without a scenario."""

from __future__ import annotations

import pytest
from film_cases import thermal_case

from rotorsim.bearing.solve import solve_case
from rotorsim.errors import InputError
from rotorsim.model import Bearing, BushModel
from rotorsim.status import SolveStatus


def test_conduction_without_an_outer_radius_says_what_to_give():
    case = thermal_case(mesh=(24, 6, 6), bush=BushModel.CONDUCTION)
    assert case.bearing.bush_outer_radius is None
    with pytest.raises(InputError, match=r"is missing.*bush_outer_radius=0\.075") as caught:
        solve_case(case, 500.0)
    assert caught.value.key == "bearing.bush_outer_radius"


def test_the_radius_that_the_message_suggests_is_enough():
    bearing = Bearing(0.05, 0.08, 100e-6, bush_outer_radius=0.075)
    point, _ = solve_case(
        thermal_case(mesh=(24, 6, 6), bearing=bearing, bush=BushModel.CONDUCTION), 500.0
    )
    assert point.status is SolveStatus.CONVERGED
