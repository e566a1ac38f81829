"""States of live tracks: what is not ours is refused, and never more than refused."""

import base64
import hashlib

import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from estimators import InputError, clean_live
from estimators.trajectories.live.token import LONGEST_TOKEN, decode, encode
from tests.trajectories.drives import drive, with_spikes
from tests.trajectories.live.streams import columns

SENT = columns(with_spikes(drive(2, n=700)))
STATE = SENT.send(0, 120).state


def sealed(content: bytes) -> str:
    """Content with a digest that fits, as a forger would make it."""
    digest = hashlib.blake2b(content, digest_size=16).digest()
    return base64.urlsafe_b64encode(content + digest).decode()


def content_of(state: str) -> bytearray:
    return bytearray(base64.urlsafe_b64decode(state)[:-16])


def test_a_state_is_read_as_it_was_written() -> None:
    assert encode(decode(STATE)) == STATE


def test_a_state_may_come_as_bytes() -> None:
    assert encode(decode(STATE.encode())) == STATE


@pytest.mark.parametrize("lag", [4, 128])
def test_a_state_stays_within_its_size(lag: int) -> None:
    assert len(SENT.send(0, 700, lag=lag).state) <= LONGEST_TOKEN


@given(st.integers(0, len(STATE) - 5), st.sampled_from("Ab9-_"))
def test_a_changed_character_is_damage(place: int, letter: str) -> None:
    assume(letter != STATE[place])
    with pytest.raises(InputError, match=r"^state: "):
        decode(STATE[:place] + letter + STATE[place + 1 :])


@given(
    st.text(max_size=200) | st.binary(max_size=200) | st.integers(0, len(STATE) - 1).map(STATE.__getitem__)
)
def test_anything_else_is_refused(state: str | bytes) -> None:
    with pytest.raises(InputError, match=r"^state: "):
        decode(state)


@given(st.integers(0, len(STATE) - 1))
def test_a_state_cut_short_is_refused(length: int) -> None:
    with pytest.raises(InputError, match=r"^state: "):
        decode(STATE[:length])


def test_a_state_that_is_too_long_is_refused_unread() -> None:
    with pytest.raises(InputError, match="longer than"):
        decode("A" * (LONGEST_TOKEN + 1))


def test_a_state_of_another_version_is_named_so() -> None:
    content = content_of(STATE)
    content[9] = 77
    with pytest.raises(InputError, match="version 77"):
        decode(sealed(bytes(content)))


@pytest.mark.parametrize("state", [None, 5, ["a"]])
def test_a_state_that_is_no_text_is_refused(state: object) -> None:
    with pytest.raises(InputError, match="must be text"):
        decode(state)  # type: ignore[arg-type]


@given(
    st.lists(
        st.tuples(st.integers(10, len(content_of(STATE)) - 1), st.integers(0, 255)), min_size=1, max_size=8
    )
)
@settings(max_examples=200, deadline=None)
def test_a_forged_state_is_refused_or_answered(changes: list[tuple[int, int]]) -> None:
    content = content_of(STATE)
    for place, value in changes:
        content[place] = value
    assert answered_or_refused(sealed(bytes(content))) in ("state", 10)


def answered_or_refused(state: str) -> int | str:
    """How many rows are answered, at most the ten that are sent; the field that is refused."""
    part = slice(120, 130)
    try:
        answer = clean_live(SENT.t[part], SENT.lat[part], SENT.lon[part], state=state)
    except InputError as error:
        return error.field
    return min(10, len(answer.settled) + len(answer.provisional))
