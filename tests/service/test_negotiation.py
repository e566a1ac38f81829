from __future__ import annotations

import pytest

from service.codecs.csv import read_csv
from service.codecs.json import read_json
from service.codecs.registry import choose_reader, choose_writer
from service.errors import Problem, ProblemType


@pytest.mark.parametrize(
    ("accept", "name"),
    [
        (None, "json"),
        ("", "json"),
        ("*/*", "json"),
        ("application/json", "json"),
        ("text/csv", "csv"),
        ("text/html, image/*;q=0.8, */*;q=0.1", "svg"),
        ("image/png, image/svg+xml", "svg"),
        ("image/png, image/svg+xml;q=0.9", "png"),
        ("application/json;q=0, */*", "csv"),
        ("IMAGE/PNG", "png"),
        ("text/csv;q=0.5, application/json;q=0.4", "csv"),
        ("text/csv;q=x, application/json;q=0.1", "json"),
    ],
)
def test_the_format_follows_accept(accept: str | None, name: str) -> None:
    assert choose_writer(accept, None).name == name


def test_the_query_takes_precedence_over_accept() -> None:
    assert choose_writer("text/csv", "png").name == "png"


@pytest.mark.parametrize(
    "accept", ["text/html", "application/json;q=0", "application/*;q=0, text/plain", ";", ",,"]
)
def test_nothing_acceptable_is_a_problem_that_lists_the_formats(accept: str) -> None:
    with pytest.raises(Problem) as caught:
        choose_writer(accept, None)
    assert caught.value.kind is ProblemType.not_acceptable
    assert "text/csv" in caught.value.extra["accepted"]


@pytest.mark.parametrize(
    ("content_type", "reader"),
    [
        ("application/json", read_json),
        ("Application/JSON; charset=UTF-8", read_json),
        ('text/csv; header=present; charset="utf-8"', read_csv),
    ],
)
def test_the_reader_follows_the_content_type(content_type: str, reader: object) -> None:
    assert choose_reader(content_type, None) is reader


@pytest.mark.parametrize(
    ("content_type", "encoding"),
    [
        (None, None),
        ("", None),
        ("text/plain", None),
        ("application/xml", None),
        ("nonsense", None),
        ("application/json; charset=latin-1", None),
        ("application/json", "gzip"),
    ],
)
def test_other_bodies_are_a_problem_that_lists_the_media_types(
    content_type: str | None, encoding: str | None
) -> None:
    with pytest.raises(Problem) as caught:
        choose_reader(content_type, encoding)
    assert caught.value.kind is ProblemType.unsupported_media_type
    assert caught.value.extra["accepted"] == ["application/json", "text/csv"]
