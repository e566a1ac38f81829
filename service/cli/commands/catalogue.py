"""``plumbline methods`` and ``plumbline models``."""

from __future__ import annotations


def methods() -> None:
    """List the methods and when to use each."""
    from service.cli.catalogue import show_methods

    show_methods()


def models() -> None:
    """List the shapes of trends."""
    from service.cli.catalogue import show_models

    show_models()
