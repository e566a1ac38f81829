"""``GET /v1/methods`` and ``/v1/models``: what the registries hold."""

from __future__ import annotations

from fastapi import APIRouter

import estimators
from service.schemas.answers import MethodAnswer, MethodsAnswer, ModelAnswer, ModelsAnswer

router = APIRouter(prefix="/v1", tags=["catalogue"])


@router.get("/methods", summary="List the methods", operation_id="list_methods")
async def list_methods() -> MethodsAnswer:
    """Every named method: what it does, when to use it, where it comes from."""
    rows = estimators.methods().values()
    return MethodsAnswer(methods=[MethodAnswer.model_validate(row, from_attributes=True) for row in rows])


@router.get("/models", summary="List the models", operation_id="list_models")
async def list_models() -> ModelsAnswer:
    """Every shape of trend: its equation and parameters."""
    rows = [
        ModelAnswer(
            name=row.name,
            title=row.title,
            equation=row.equation,
            parameters=list(row.parameters),
            summary=row.summary,
        )
        for row in estimators.models().values()
    ]
    return ModelsAnswer(models=rows)
