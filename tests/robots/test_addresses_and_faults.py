from __future__ import annotations

import pytest

from pix2pred.robots.addresses import AddressError, SimulatedEpisode, SpotAt, read_address
from pix2pred.robots.simulator.faults import FIRST_MOMENT, Fault, FaultError, FaultKind, Faults


def test_addresses_name_episodes_and_hosts() -> None:
    assert read_address("sim:cleanup/new-objects/3") == SimulatedEpisode("cleanup", "new-objects", 3, 0)
    assert read_address("sim:juice/more-objects/0/2") == SimulatedEpisode("juice", "more-objects", 0, 2)
    assert read_address("spot:192.168.80.3") == SpotAt("192.168.80.3")
    assert read_address("spot:127.0.0.1:4000") == SpotAt("127.0.0.1", 4000)


@pytest.mark.parametrize(
    "text", ["", "spot:", "spot:host:0", "spot:host:70000", "sim:cleanup", "sim:a/b/c", "ur5:host"]
)
def test_what_is_no_address_is_answered_with_the_forms(text: str) -> None:
    with pytest.raises(AddressError, match="spot:HOST"):
        read_address(text)


def test_faults_are_read_with_shares_and_moments() -> None:
    assert Fault.read("grasp-miss:0.2") == Fault(FaultKind.GRASP_MISS, 0.2)
    assert Fault.read("lease-lost@12") == Fault(FaultKind.LEASE_LOST, 0.0, 12)
    assert Fault.read("estop").moment == FIRST_MOMENT


@pytest.mark.parametrize("text", ["melted", "grasp-miss", "estop:0.5", "drift:2", "lease-lost@x", ""])
def test_what_is_no_fault_is_refused(text: str) -> None:
    with pytest.raises(FaultError):
        Fault.read(text)


def test_a_fault_strikes_once_and_at_its_moment() -> None:
    faults = Faults((Fault.read("estop@2"), Fault.read("drift:0.05")))
    assert faults.at_moment() == ()
    assert faults.at_moment() == (FaultKind.ESTOP,)
    assert faults.at_moment() == ()
    assert faults.share(FaultKind.DRIFT) == 0.05
    assert faults.share(FaultKind.BLOCKED) == 0
