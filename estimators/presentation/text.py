"""Text for people, 80 columns wide: facts with a label before them."""

from __future__ import annotations

import textwrap

WIDTH = 80
"""Columns of a terminal."""


def labelled(label: str, sentence: str, indent: int) -> list[str]:
    """Set a sentence beside its label, over as many lines as it takes.

    Parameters
    ----------
    label : str
    sentence : str
    indent : int
        Columns before the sentence, those of the label among them.

    Returns
    -------
    list of str
        At most :data:`WIDTH` wide where the words allow; numbers and names are not broken.

    Examples
    --------
    >>> labelled("Noise", "3 m", 8)
    ['Noise   3 m']
    """
    return textwrap.wrap(
        sentence,
        WIDTH,
        initial_indent=label.ljust(indent),
        subsequent_indent=" " * indent,
        break_long_words=False,
        break_on_hyphens=False,
    )
