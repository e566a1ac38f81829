"""What the search did to get to the answer, as the answer tells it."""

from __future__ import annotations

from estimators.consensus.found import Found
from estimators.result import Consensus
from estimators.trends.request import Request


def account_of(request: Request, found: Found, inliers: int) -> Consensus:
    """Account of a search, whatever the model.

    Parameters
    ----------
    request : Request
    found : Found
        With scales in units of the values.
    inliers : int
        Points within the threshold.

    Returns
    -------
    Consensus
    """
    n = request.series.n
    return Consensus(
        method=request.preset.name,
        n=n,
        inliers=inliers,
        inlier_ratio=inliers / n,
        threshold=found.threshold,
        threshold_source=found.threshold_source,
        sigma=found.sigma,
        sigma_source=found.sigma_source,
        ledger=found.ledger,
        sampling_probability=found.sampling_probability,
        search=found.search,
        seed=request.seed,
    )
