import pytest

from tests.docs.comparison import difference, tidy


@pytest.mark.parametrize(
    ("expected", "actual"),
    [
        ("slope 1.9134", "slope 1.9135"),
        ("slope  1.9134 ", "slope 1.9134"),
        ("p = 3.1e-12", "p = 3.2e-12"),
        ("value 12034.5", "value 12034.9"),
        ("−3.50 °C", "-3.50 °C"),
        ("────── inliers 42", "──────────── inliers 42"),
    ],
)
def test_outputs_that_differ_in_spacing_or_last_digits_say_the_same(expected: str, actual: str) -> None:
    assert difference(expected, actual) is None


@pytest.mark.parametrize(
    ("expected", "actual"),
    [
        ("slope 1.9134", "slope 1.9534"),
        ("slope 1.9134", "slope -1.9134"),
        ("inliers 42", "inliers 43"),
        ("sampled", "exhaustive"),
        ("slope 1.9134", "slope 1.9134 per day"),
        ("slope 1.9134 per day", "slope 1.9134"),
        ("p = 3.1e-12", "p = 3.1e-11"),
        ("2 notices", "None notices"),
    ],
)
def test_outputs_that_differ_in_a_word_or_a_figure_do_not_say_the_same(expected: str, actual: str) -> None:
    assert difference(expected, actual) is not None


def test_tidy_drops_colours_and_blank_ends() -> None:
    assert tidy("\n\x1b[1mslope\x1b[0m  \n\n") == "slope"
