"""Whose nodes are the subject's, told from the names on a graph."""

from __future__ import annotations

import contextlib
from typing import TYPE_CHECKING, Any, cast

import pytest

from autograder.judge.bench.discovery import NodeName, counterparts, every_node, subject_nodes, topic_ends
from autograder.judge.bench.unreadable import NAME, UnreadableSubject

if TYPE_CHECKING:
    from rclpy.node import Node


KEEPER = "_check_keeper_00ff"


class SeenBy:
    def __init__(self, *names: str, space: str = "/") -> None:
        self._names = [("judge_1", "/"), *((name, space) for name in names)]

    def get_name(self) -> str:
        return "judge_1"

    def get_node_names_and_namespaces(self) -> list[tuple[str, str]]:
        return self._names


def names(judge: Any, keeper: str = KEEPER) -> list[str]:
    return [node.full for node in subject_nodes(cast("Node", judge), keeper)]


def test_one_keeper_is_nobody_s_work() -> None:
    assert names(SeenBy(KEEPER, "talker")) == ["/talker"]


def test_a_second_one_of_its_name_is_the_subject_s() -> None:
    assert names(SeenBy(KEEPER, "talker", KEEPER)) == [f"/{KEEPER}", "/talker"]


def test_a_name_that_is_only_like_it_hides_nobody() -> None:
    assert names(SeenBy(KEEPER, "_check_keeper", f"{KEEPER}0")) == ["/_check_keeper", f"/{KEEPER}0"]
    assert names(SeenBy(KEEPER, space="/robot")) == [f"/robot/{KEEPER}"]


def test_where_no_keeper_is_expected_none_is_left_out() -> None:
    assert names(SeenBy(KEEPER), keeper="") == [f"/{KEEPER}"]


def test_nodes_without_a_name_yet_are_left_out_and_each_name_counts_once() -> None:
    judge = cast("Node", SeenBy("_NODE_NAME_UNKNOWN_", "a", "a"))
    assert subject_nodes(judge, "") == [NodeName("a", "/")]
    assert every_node(judge, "") == [NodeName("a", "/")] * 2


IMPOSSIBLE = ("", "a b", "\x1b[2J", "a/b", "1st", "naïve", "a\u202e")


class Undecodable(SeenBy):
    """A graph with a name of bytes that are not valid UTF-8, as rclpy shows it."""

    def get_node_names_and_namespaces(self, *_: object) -> list[tuple[str, str]]:
        raise UnicodeDecodeError("utf-8", b"\xff", 0, 1, "invalid start byte")

    get_publishers_info_by_topic = get_topic_names_and_types = get_node_names_and_namespaces

    @property
    def handle(self) -> Any:
        return contextlib.nullcontext()


@pytest.mark.parametrize("judge", [SeenBy(f"talker{name}!") for name in IMPOSSIBLE] + [Undecodable()])
def test_a_name_that_ros_does_not_allow_makes_the_graph_unreadable(judge: Any) -> None:
    with pytest.raises(UnreadableSubject, match=NAME):
        every_node(judge, "")


@pytest.mark.parametrize("query", [topic_ends, lambda judge: counterparts(judge, ["/a"], [])])
def test_so_does_such_a_name_of_a_topic_or_at_its_end(query: Any) -> None:
    with pytest.raises(UnreadableSubject, match=NAME):
        query(Undecodable())


def test_each_name_that_ros_allows_can_be_read() -> None:
    long, unusual = "n" * 255, "_a1__B"
    assert names(SeenBy(long, unusual, space="/left/_arm2")) == [
        f"/left/_arm2/{unusual}",
        f"/left/_arm2/{long}",
    ]
