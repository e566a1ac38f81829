"""The image's health check: ends with 0 if the service in this container is ready. Standard library only."""

from __future__ import annotations

import os
import sys
import urllib.error
import urllib.request

#: Addresses that mean "all of them", and one of them that is always there.
ANY = {"0.0.0.0": "127.0.0.1", "::": "::1"}
TIMEOUT_SECONDS = 2.0


def ready_url(host: str, port: str) -> str:
    """Address of the readiness probe of a service that listens on a host and port."""
    reachable = ANY.get(host, host)
    return f"http://{f'[{reachable}]' if ':' in reachable else reachable}:{port}/readyz"


def main() -> int:
    """Ask once; say on standard error why not."""
    url = ready_url(os.environ.get("PLUMBLINE_HOST", "127.0.0.1"), os.environ.get("PLUMBLINE_PORT", "8000"))
    try:
        # No proxy: a container may be told of one for its way out, and this is inside.
        opener = urllib.request.build_opener(urllib.request.ProxyHandler({}))
        with opener.open(url, timeout=TIMEOUT_SECONDS) as answer:
            answer.read()
    except (urllib.error.URLError, ConnectionError, TimeoutError) as error:
        print(f"{url}: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
