"""The OpenAPI document: what FastAPI finds out by itself, and the little it cannot know.

``python -m service.openapi`` rewrites ``openapi/openapi.json``, which is committed; a test proves that it is
what is served.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

from fastapi import FastAPI
from fastapi.openapi.utils import get_openapi
from pydantic import BaseModel
from pydantic.json_schema import models_json_schema

from service.errors import ProblemType
from service.schemas.batch import BatchRequest
from service.schemas.fixes import FeatureAnswer, FeatureCollectionAnswer
from service.schemas.live_tracks import LiveRequest
from service.schemas.options import TrendRequest
from service.schemas.positions import PositionRequest
from service.schemas.problems import ProblemAnswer, problem_responses
from service.schemas.tracks import TrackFeaturesAnswer
from service.schemas.trajectories import TrackRequest
from service.security.keys import is_open

#: Version of the interface, not of the product: it changes when a client could notice.
API_VERSION = "1.0.0"
DESCRIPTION = (
    "Robust trends from contaminated measurements: a model, a label per measurement and honest uncertainty. "
    "Every error is an RFC 9457 problem."
)

#: Bodies that codecs read and write past the framework.
DESCRIBED: tuple[type[BaseModel], ...] = (
    TrendRequest,
    BatchRequest,
    PositionRequest,
    FeatureAnswer,
    FeatureCollectionAnswer,
    TrackRequest,
    TrackFeaturesAnswer,
    LiveRequest,
    ProblemAnswer,
)

#: What any operation can answer besides its own problems.
EVERYWHERE = (ProblemType.internal_error,)
GUARDED = (ProblemType.authentication_required,)


def describe(app: FastAPI) -> dict[str, Any]:
    """OpenAPI document of an app.

    Parameters
    ----------
    app : FastAPI

    Returns
    -------
    dict
    """
    document = get_openapi(title="Plumbline", version=API_VERSION, description=DESCRIPTION, routes=app.routes)
    components = document.setdefault("components", {})
    schemas = components.setdefault("schemas", {})
    _, ours = models_json_schema(
        [(model, "validation") for model in DESCRIBED],
        ref_template="#/components/schemas/{model}",
    )
    for name, schema in ours["$defs"].items():
        schemas.setdefault(name, schema)
    for unused in ("HTTPValidationError", "ValidationError"):
        schemas.pop(unused, None)
    components["schemas"] = dict(sorted(schemas.items()))
    components["securitySchemes"] = {
        "bearer": {
            "type": "http",
            "scheme": "bearer",
            "description": "An API key, if the service asks for one.",
        },
        "apiKey": {"type": "apiKey", "in": "header", "name": "X-API-Key"},
    }
    for path, operations in document["paths"].items():
        for operation in operations.values():
            _complete(operation, guarded=not is_open(path))
    return document


def _complete(operation: dict[str, Any], *, guarded: bool) -> None:
    """Add what holds for all operations; drop FastAPI's own 422, which this service never answers."""
    responses = operation["responses"]
    if "application/json" in responses.get("422", {}).get("content", {}):
        responses["422"]["content"].pop("application/json")
    kinds = EVERYWHERE + (GUARDED if guarded else ())
    for status, answer in problem_responses(*kinds).items():
        responses.setdefault(str(status), answer)
    operation["responses"] = dict(sorted(responses.items()))
    if guarded:
        operation["security"] = [{}, {"bearer": []}, {"apiKey": []}]


def write(path: Path) -> None:
    """Write the document of a service with default settings."""
    from service.main import create_app  # noqa: PLC0415  (main imports this module)
    from service.settings import Settings  # noqa: PLC0415

    document = create_app(Settings()).openapi()
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps(document, indent=2, ensure_ascii=False) + "\n", encoding="utf-8")


if __name__ == "__main__":
    target = (
        Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parents[1] / "openapi" / "openapi.json"
    )
    write(target)
    sys.stdout.write(f"{target}\n")
