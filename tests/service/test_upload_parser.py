"""Cutting an upload into its parts."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from service.codecs.limits import Limits
from service.codecs.positions.columns import Recording
from service.codecs.positions.upload import read_upload
from service.codecs.sent import Sent
from service.errors import Problem
from service.schemas.position_query import PositionQuery

BOUNDARY = b"a-boundary"


def read(body: bytes, check=lambda: None) -> Recording:
    content_type = f"multipart/form-data; boundary={BOUNDARY.decode()}"
    return read_upload(Sent(body, content_type, PositionQuery(), Limits(), check))[0]


def written(parts: list[tuple[str, bytes]]) -> bytes:
    pieces = [
        b'--%b\r\nContent-Disposition: form-data; name="%b"; filename="f"\r\n\r\n%b\r\n'
        % (BOUNDARY, name.encode(), content)
        for name, content in parts
    ]
    return b"".join([*pieces, b"--%b--\r\n" % BOUNDARY])


CONTENTS = st.binary(max_size=300).filter(lambda content: BOUNDARY not in content)


@given(observations=CONTENTS, navigation=st.lists(CONTENTS, min_size=1, max_size=3))
def test_contents_come_out_as_they_went_in(observations: bytes, navigation: list[bytes]) -> None:
    parts = [("navigation", content) for content in navigation]
    recording = read(written([parts[0], ("observations", observations), *parts[1:]]))
    assert recording.observations == observations
    assert recording.navigation == navigation


def test_a_part_of_many_pieces_comes_out_whole() -> None:
    content = bytes(range(256)) * 4096
    assert read(written([("observations", content), ("navigation", b"n")])).observations == content


@given(data=st.data())
def test_a_damaged_body_is_read_or_refused_and_nothing_else(data) -> None:
    body = bytearray(written([("observations", b"o" * 40), ("navigation", b"n" * 40)]))
    for _ in range(data.draw(st.integers(1, 4))):
        at = data.draw(st.integers(0, len(body)))
        body[at : at + data.draw(st.sampled_from([0, 1, 9]))] = data.draw(
            st.sampled_from([b"", b"\r\n", b"--" + BOUNDARY, b"\x00", b'"', b"\xff:"])
        )
    try:
        found = read(bytes(body))
    except Problem as refused:
        status, held = refused.kind.status, 0
    else:
        status, held = 200, len(found.observations) + sum(map(len, found.navigation))
    assert status in (200, 400, 422)
    assert held <= len(body)


def test_nobody_waiting_ends_the_reading() -> None:
    def leave() -> None:
        raise TimeoutError

    with pytest.raises(TimeoutError):
        read(written([("observations", b"o"), ("navigation", b"n")]), leave)
