"""Pydantic models of options and answers; they make the OpenAPI document. Arrays never pass through them."""
