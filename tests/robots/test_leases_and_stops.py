"""Who may move the simulated robot, and whether it may move: rules without a network or a clock of their own."""

from __future__ import annotations

from dataclasses import replace

import pytest

from pix2pred.robots.simulator.leases import Leases, Ticket, Use
from pix2pred.robots.simulator.stops import Endpoint, StopLevel, Stops


class Clock:
    def __init__(self) -> None:
        self.seconds = 100.0

    def __call__(self) -> float:
        return self.seconds


def test_a_lease_is_for_one_until_it_is_returned() -> None:
    leases = Leases(Clock(), 5.0)
    first = leases.acquire("one")
    assert first is not None
    assert leases.acquire("other") is None
    assert leases.give_back(first)
    assert leases.acquire("other") is not None


def test_using_a_lease_makes_older_ones_worthless() -> None:
    leases = Leases(Clock(), 5.0)
    lease = leases.take("one")
    newer = replace(lease, sequence=(*lease.sequence, 3))
    assert leases.use(newer) is Use.OK
    assert leases.use(replace(lease, sequence=(*lease.sequence, 2))) is Use.OLDER
    assert leases.use(newer) is Use.OK


def test_taking_a_lease_leaves_the_holder_with_an_old_one() -> None:
    leases = Leases(Clock(), 5.0)
    lease = leases.take("one")
    leases.lose()
    assert leases.use(lease) is Use.OLDER
    assert not leases.give_back(lease)


def test_a_lease_that_nobody_retains_is_revoked_and_free_for_others() -> None:
    clock = Clock()
    leases = Leases(clock, 5.0)
    lease = leases.take("one")
    clock.seconds += 4
    assert leases.use(lease) is Use.OK
    clock.seconds += 4
    assert not leases.stale
    clock.seconds += 2
    assert leases.stale
    assert leases.use(lease) is Use.REVOKED
    assert leases.acquire("other") is not None


@pytest.mark.parametrize(
    ("ticket", "how"),
    [
        (None, Use.INVALID),
        (Ticket("body", "", ()), Use.INVALID),
        (Ticket("tail", "", (1,)), Use.UNMANAGED),
        (Ticket("body", "another start", (1,)), Use.WRONG_EPOCH),
    ],
)
def test_leases_that_are_none(ticket: Ticket | None, how: Use) -> None:
    leases = Leases(Clock(), 5.0)
    leases.take("one")
    assert leases.use(ticket) is how


def test_a_lease_from_the_future_is_invalid() -> None:
    leases = Leases(Clock(), 5.0)
    lease = leases.take("one")
    assert leases.use(replace(lease, sequence=(lease.sequence[0] + 1,))) is Use.INVALID


def test_without_endpoints_the_power_is_cut() -> None:
    assert Stops(Clock()).level is StopLevel.CUT


def test_an_endpoint_that_answers_lets_the_robot_move_and_stops_it_by_silence() -> None:
    clock = Clock()
    stops = Stops(clock)
    endpoint = stops.register(Endpoint("mine", "PDB_rooted", 9.0, 4.0))
    assert stops.level_of(endpoint) is StopLevel.CUT, "it has not checked in yet"
    challenge = stops.next_challenge(endpoint)
    assert not stops.answered(endpoint, challenge, challenge, StopLevel.NONE)
    assert stops.answered(endpoint, challenge, ~challenge & (2**64 - 1), StopLevel.NONE)
    levels = [stops.level]
    for seconds in (10, 4):
        clock.seconds += seconds
        levels.append(stops.level)
    assert levels == [StopLevel.NONE, StopLevel.SETTLE_THEN_CUT, StopLevel.CUT]


def test_a_pressed_button_wins() -> None:
    stops = Stops(Clock())
    endpoint = stops.register(Endpoint("mine", "PDB_rooted", 9.0, 4.0))
    challenge = stops.next_challenge(endpoint)
    stops.answered(endpoint, challenge, ~challenge & (2**64 - 1), StopLevel.NONE)
    stops.pressed = True
    assert stops.level is StopLevel.CUT
