"""``/docs``: the OpenAPI document as a page for people.

Rendered on the server from the document itself: no script, nothing from another host, so that it works
offline and under the strictest content security policy.
"""

from __future__ import annotations

from html import escape
from importlib.resources import files
from typing import Any

from fastapi import APIRouter, Request, Response
from fastapi.responses import HTMLResponse, RedirectResponse

from service.errors import Problem, ProblemType
from service.security.headers import PAGE_POLICY

router = APIRouter(include_in_schema=False)

CURL = """curl -s http://127.0.0.1:8000/v1/trends -H 'Content-Type: application/json' \\
  -d '{"time": [0, 1, 2, 3, 4, 5, 6, 7], "value": [0.1, 1.0, 2.1, 2.9, 40, 5.1, 5.9, 7.0], "predict": [9]}'"""


@router.get("/")
async def home() -> Response:
    """Lead to the documentation."""
    return RedirectResponse("/docs", status_code=307)


@router.get("/docs")
async def page(request: Request) -> Response:
    """Show the documentation."""
    html = render(request.app.openapi())
    return HTMLResponse(html, headers={"Content-Security-Policy": PAGE_POLICY, "Cache-Control": "no-cache"})


@router.get("/docs/style.css")
async def style() -> Response:
    """Send the style of the page."""
    css = files("service.api").joinpath("docs.css").read_bytes()
    return Response(css, media_type="text/css", headers={"Cache-Control": "max-age=3600"})


@router.get("/problems/{slug}")
async def explain(slug: str) -> Response:
    """Lead from the ``type`` of a problem to its explanation."""
    if all(slug != kind.slug for kind in ProblemType):
        raise Problem(ProblemType.not_found)
    return RedirectResponse(f"/docs#{slug}", status_code=303)


def render(document: dict[str, Any]) -> str:
    """HTML of an OpenAPI document."""
    operations = [
        _operation(path, method, operation)
        for path, methods in document["paths"].items()
        for method, operation in methods.items()
    ]
    schemas = document["components"]["schemas"]
    return "\n".join(
        [
            "<!doctype html>",
            '<html lang="en"><head><meta charset="utf-8">',
            '<meta name="viewport" content="width=device-width, initial-scale=1">',
            f"<title>{escape(document['info']['title'])} API</title>",
            '<link rel="stylesheet" href="/docs/style.css"></head><body><main>',
            f"<h1>{escape(document['info']['title'])} API</h1>",
            f"<p>{escape(document['info']['description'])}</p>",
            '<p>Machines read the same at <a href="/openapi.json">/openapi.json</a>.</p>',
            f"<pre>{escape(CURL)}</pre>",
            "<h2>Operations</h2>",
            *operations,
            "<h2>Schemas</h2>",
            *[_schema(name, schema) for name, schema in sorted(schemas.items())],
            "<h2>Problems</h2>",
            "<p>Every error is <code>application/problem+json</code> (RFC 9457).</p>",
            *[_problem(kind) for kind in ProblemType],
            "</main></body></html>",
        ]
    )


def _operation(path: str, method: str, operation: dict[str, Any]) -> str:
    parameters = [
        (item["name"], item["schema"], item.get("description", ""))
        for item in operation.get("parameters", [])
    ]
    bodies = [
        f"<li><code>{escape(media)}</code> {_type_of(content['schema'])}</li>"
        for media, content in operation.get("requestBody", {}).get("content", {}).items()
    ]
    answers = [
        f"<tr><td>{escape(status)}</td><td>{_code(answer['description'])}</td>"
        f"<td>{'<br>'.join(f'<code>{escape(media)}</code>' for media in answer.get('content', {}))}</td></tr>"
        for status, answer in operation["responses"].items()
    ]
    return "\n".join(
        [
            f'<h3 id="{escape(operation["operationId"])}">',
            f'<span class="method">{method.upper()}</span> <code>{escape(path)}</code></h3>',
            f"<p><b>{escape(operation['summary'])}.</b> {_code(operation.get('description', ''))}</p>",
            f"<p>Body:</p><ul>{''.join(bodies)}</ul>" if bodies else "",
            f"<details><summary>Query parameters</summary>{_table(parameters)}</details>"
            if parameters
            else "",
            f"<details><summary>Answers</summary><table>{''.join(answers)}</table></details>",
        ]
    )


def _schema(name: str, schema: dict[str, Any]) -> str:
    fields = [
        (field, content, content.get("description", ""))
        for field, content in schema.get("properties", {}).items()
    ]
    return (
        f'<details id="{escape(name)}"><summary><code>{escape(name)}</code> '
        f'<span class="quiet">{_code(schema.get("description", ""))}</span></summary>'
        f"{_table(fields)}</details>"
    )


def _problem(kind: ProblemType) -> str:
    return (
        f'<h3 id="{kind.slug}"><code>{kind.uri}</code> <span class="quiet">{kind.status}</span></h3>'
        f"<p>{escape(kind.title)}. {escape(kind.remedy)}</p>"
    )


def _table(fields: list[tuple[str, dict[str, Any], str]]) -> str:
    rows = [
        f"<tr><td><code>{escape(name)}</code></td><td>{_type_of(schema)}</td><td>{_code(text)}</td></tr>"
        for name, schema, text in fields
    ]
    return f"<table><tr><th>Name</th><th>Type</th><th>Meaning</th></tr>{''.join(rows)}</table>"


def _type_of(schema: dict[str, Any]) -> str:
    """Type of a schema in a few words; a reference is a link."""
    if "$ref" in schema:
        name = schema["$ref"].rpartition("/")[2]
        return f'<a href="#{escape(name)}">{escape(name)}</a>'
    if "anyOf" in schema:
        return " or ".join(_type_of(item) for item in schema["anyOf"])
    if "enum" in schema:
        return ", ".join(f"<code>{escape(str(item))}</code>" for item in schema["enum"])
    if "const" in schema:
        return f"<code>{escape(str(schema['const']))}</code>"
    if schema.get("type") == "array":
        return f"array of {_type_of(schema['items'])}"
    return escape(str(schema.get("type", "any")))


def _code(text: str) -> str:
    """Escaped text in which `words between backticks` are code."""
    parts = escape(text).split("`")
    return "".join(f"<code>{part}</code>" if place % 2 else part for place, part in enumerate(parts))
