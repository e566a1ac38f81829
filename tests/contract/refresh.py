"""``python -m tests.contract.refresh``: rewrite the answers in ``openapi/examples`` by asking the service."""

from __future__ import annotations

import json
import sys

from fastapi.testclient import TestClient

from estimators import kernels
from service.main import create_app
from service.settings import Settings
from tests.contract.examples import EXAMPLES, ask, content_of, load


def main() -> None:
    """Rewrite every example; the requests stay as they are."""
    for _ in kernels.warm():
        pass
    with TestClient(create_app(Settings(log_level="error"))) as client:
        for path in sorted(EXAMPLES.glob("*.json")):
            example = load(path)
            response = ask(client, example["request"])
            kept = {"content-type", *example.get("response", {}).get("headers", {})}
            example["response"] = {
                "status": response.status_code,
                "headers": {name: response.headers[name] for name in sorted(kept)},
                "body": content_of(response),
            }
            path.write_text(json.dumps(example, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
            sys.stdout.write(f"{response.status_code} {path.name}\n")


if __name__ == "__main__":
    main()
