"""Something goes wrong in the middle of a task: the end has a name, and the same session reaches the goal afterwards.

``benchmarks/spot_faults.py`` does this for every fault at random moments.
"""

from __future__ import annotations

from pathlib import Path

import pytest

from extras import need

pytestmark = [need("bosdyn.client", "pyapriltags", extra="spot"), need("mujoco", extra="sim")]


@pytest.mark.parametrize(("fault", "outcome"), [("lease-lost@35", "lease lost"), ("estop@28", "emergency stop")])
def test_a_session_goes_on_after_what_went_wrong_was_put_right(tmp_path: Path, fault: str, outcome: str) -> None:
    from robots.simulated_spots import DOMAINS, served
    from robots.written_run import FAMILY, INDEX, put_right, work, write_run

    domain, run = DOMAINS["cleanup"], write_run(tmp_path / "run")
    task = domain.tasks(FAMILY, 0, INDEX + 1)[INDEX].task
    with served(tmp_path, "cleanup", FAMILY, INDEX, faults=[fault]) as server:
        assert work(server, run, task).outcome == outcome
        put_right(server)
        assert work(server, run, task).outcome == "goal reached"
        world = server.spot.body.around.world  # type: ignore[attr-defined]
        assert all(domain.rules.holds(world, atom) for atom in task.goal)
        assert server.spot.body.stowed and server.spot.body.leases.owner == ""


def test_an_unknown_thing_in_the_hand_is_not_taken_for_an_empty_hand(tmp_path: Path) -> None:
    from robots.simulated_spots import DOMAINS, served
    from robots.written_run import FAMILY, INDEX, work, write_run

    task = DOMAINS["cleanup"].tasks(FAMILY, 0, INDEX + 1)[INDEX].task
    with served(tmp_path, "cleanup", FAMILY, INDEX) as server:
        server.spot.do(lambda: server.spot.body.around.grasp("eraser"))
        done = work(server, write_run(tmp_path / "run"), task)
    assert done.outcome == "not ready" and "take it out" in done.detail
