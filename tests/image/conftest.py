from collections.abc import Iterator

import pytest

from tests.image.build import mounted_image
from tests.image.container import KEY, Image, Service


@pytest.fixture(scope="session")
def image() -> Iterator[Image]:
    """The image, built and mounted; skips where a program for that is not installed."""
    with mounted_image() as mounted:
        yield mounted


@pytest.fixture(scope="session")
def service(image: Image) -> Iterator[Service]:
    """The service as the image runs it out of the box, given a key."""
    with image.serve(PLUMBLINE_API_KEYS=KEY) as running:
        yield running
