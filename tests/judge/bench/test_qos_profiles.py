"""The judge speaks and listens with a QoS that the scenario names, and sees the QoS of the subject's endpoints."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from autograder.judge.bench.qos_profiles import profile, qos_of
from autograder.kit.counterparts import Qos
from autograder.kit.evidence import Evidence, Part, Reference
from autograder.kit.mistakes.common_mistakes import qos_mismatch
from tests.cases import cases

if TYPE_CHECKING:
    from conftest import BenchOf

TEXT = "std_msgs/msg/String"
REFERENCE = Reference("a test", {"subscription": {"/scan": TEXT}, "publisher": {"/map": TEXT}})
SUBJECT = cases(__file__, "SUBJECT")
SENSOR = "qos_profile_sensor_data"
LATCHED = "QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)"


def seen_of(bench_of: BenchOf, **subject: str) -> Part:
    """Return what a judge sees that speaks like a sensor, and listens late for the last message."""
    with bench_of(SUBJECT.format(**subject), REFERENCE) as bench:
        bench.part("only")
        scans = bench.speak("/scan", TEXT, qos=Qos.SENSOR)
        bench.start()
        bench.await_endpoint("subscription", "/scan")
        bench.await_endpoint("publisher", "/map")
        bench.settle()
        bench.listen("/map", TEXT, qos=Qos.LATCHED)
        bench.await_attention()
        scans.send(data="a scan")
        bench.wait_until(
            lambda e: all(
                e.main.of("mismatch", topic) or got
                for topic, got in (("/scan", e.main.said()), ("/map", e.main.of("message")))
            ),
            20.0,
        )
        bench.stop()
        return bench.parts[0]


@pytest.mark.ros
def test_endpoints_that_match_hear_each_other(bench_of: BenchOf) -> None:
    seen = seen_of(bench_of, scan=SENSOR, map=LATCHED)
    assert seen.said() == ["a scan"]
    assert [event.data["fields"]["data"] for event in seen.of("message")] == ["a map"]
    assert seen.of("mismatch") == []
    assert (seen.qos("subscription"), seen.qos("publisher")) == ({"/scan": "sensor"}, {"/map": "latched"})


@pytest.mark.ros
def test_endpoints_that_do_not_match_are_recorded_and_the_card_names_the_other_qos(bench_of: BenchOf) -> None:
    seen = seen_of(bench_of, scan="10", map="10")
    assert ("a scan" in seen.said(), seen.of("message")) == (False, [])
    policies = {event.name: event.data for event in seen.of("mismatch")}
    assert policies["/scan"] == {"policy": "reliability", "qos": "sensor"}
    assert policies["/map"] == {"policy": "durability", "qos": "latched"}
    assert seen.qos("subscription") == seen.qos("publisher") == {}
    for role, words in (("subscription", "qos_profile_sensor_data"), ("publisher", "TRANSIENT_LOCAL")):
        advice = qos_mismatch(role).recognize(Evidence([seen], REFERENCE))
        assert advice is not None
        assert words in advice.next_step


@pytest.mark.ros
def test_a_planted_node_has_the_qos_that_is_named(bench_of: BenchOf) -> None:
    with bench_of("", REFERENCE) as bench:
        bench.part("only")
        bench.plant("camera", publishes={"/image": TEXT}, subscribes={"/zoom": TEXT}, qos=Qos.SENSOR)

        def is_seen(evidence: Evidence) -> bool:
            qos = (evidence.main.qos(role) for role in ("publisher", "subscription"))
            return [*qos] == [{"/image": "sensor"}, {"/zoom": "sensor"}]

        assert bench.watch_graph(is_seen, 20.0)


@pytest.mark.parametrize("qos", Qos)
def test_each_profile_has_its_name_back(qos: Qos) -> None:
    made = profile(qos)
    assert qos_of({"reliability": made.reliability, "durability": made.durability}) is qos
