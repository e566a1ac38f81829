"""Every named method is one row: a search, and the words by which people choose it.

The service, its schema, the command line and the documentation read this table; a new method is one policy
and one row here. Compositions follow METHODS.md 15.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

from estimators.consensus.found import Search
from estimators.consensus.optimizers.lo_plus import LoPlus
from estimators.consensus.optimizers.lo_ransac import LoRansac
from estimators.consensus.samplers.far_apart import FarApart
from estimators.consensus.samplers.prosac import Prosac
from estimators.consensus.scores.msac import Msac
from estimators.consensus.search.closed import HuberRegression, OrdinaryLeastSquares, RepeatedMedian, TheilSen
from estimators.consensus.search.mm import MMSearch
from estimators.consensus.search.sampling import SamplingSearch
from estimators.consensus.search.structure import StructureSearch
from estimators.consensus.termination import FirstAcceptable
from estimators.consensus.verifiers.bail_out import BailOut


@dataclass(frozen=True, slots=True)
class Preset:
    """A named method.

    Attributes
    ----------
    name : str
        What callers pass as ``method``.
    title : str
        Name for people.
    summary : str
        What it does, in a sentence.
    when_to_use : str
        Who should choose it, in a sentence.
    source : str
        Where it comes from.
    search : Search
        The policies.
    robust : bool
        Whether outliers cannot move it far; False for methods offered for comparison.
    """

    name: str
    title: str
    summary: str
    when_to_use: str
    source: str
    search: Search
    robust: bool = True


_ROWS = (
    Preset(
        "auto",
        "Automatic",
        "Finds the line about which readings scatter most finely and to which they keep returning; "
        "needs neither a threshold nor a noise scale, and does not depend on the seed.",
        "Always, unless you want one particular method.",
        "Plumbline; a mixture with labels that are sticky in time",
        StructureSearch(),
    ),
    Preset(
        "ransac",
        "RANSAC",
        "Draws minimal samples, keeps the model with the most points within the threshold, and fits those.",
        "To reproduce the classic result.",
        "Fischler & Bolles 1981, with the exact stopping rule of Schonberger, Larsson & Pollefeys 2025",
        SamplingSearch(),
    ),
    Preset(
        "fischler-bolles",
        "RANSAC, first acceptable",
        "Stops at the first model whose consensus is large enough, as the original paper does.",
        "When any model with enough support will do, or to reproduce the original.",
        "Fischler & Bolles 1981",
        SamplingSearch(termination=FirstAcceptable(), block=1),
    ),
    Preset(
        "msac",
        "MSAC with local optimisation",
        "Far-apart samples, a truncated quadratic score that also counts how well inliers fit, and LO+.",
        "When the threshold is known: accurate and the fastest.",
        "Torr & Zisserman 2000; Lebeda, Matas & Chum 2012",
        SamplingSearch(sampler=FarApart(), score=Msac(), verifier=BailOut(), optimizer=LoPlus()),
    ),
    Preset(
        "lo-ransac",
        "LO-RANSAC",
        "RANSAC whose new best models start an inner search among their inliers.",
        "To count inliers, with results that hardly depend on the seed.",
        "Chum, Matas & Kittler 2003",
        SamplingSearch(verifier=BailOut(), optimizer=LoRansac()),
    ),
    Preset(
        "prosac",
        "PROSAC",
        "Samples from the points of highest weight first and stops when their consensus cannot be chance.",
        "When weights say which readings are good; without weights it draws in random order.",
        "Chum & Matas 2005",
        SamplingSearch(sampler=Prosac(), score=Msac(), verifier=BailOut()),
    ),
    Preset(
        "mm",
        "MM-estimate",
        "An S-estimate of high breakdown gives start and scale; a bisquare M-estimate finishes efficiently.",
        "When fewer than half of the points are outliers and every point should be weighted smoothly.",
        "Yohai 1987; Salibian-Barrera & Yohai 2006",
        MMSearch(),
    ),
    Preset(
        "theil-sen",
        "Theil-Sen",
        "The median of the slopes through all pairs of points.",
        "Where the field expects it, with up to 29 % outliers.",
        "Theil 1950; Sen 1968",
        TheilSen(),
    ),
    Preset(
        "siegel",
        "Repeated median",
        "The median, over points, of the median slope to the others.",
        "A closed estimate that stands up to half of the points being outliers.",
        "Siegel 1982",
        RepeatedMedian(),
    ),
    Preset(
        "huber",
        "Huber regression",
        "Least squares for small residuals, absolute values for large ones.",
        "For comparison: outliers at the ends of a series still move it.",
        "Huber 1964",
        HuberRegression(),
        robust=False,
    ),
    Preset(
        "ols",
        "Least squares",
        "The line of least squares through all points.",
        "For comparison: a single outlier moves it as far as one likes.",
        "Legendre 1805; Gauss 1809",
        OrdinaryLeastSquares(),
        robust=False,
    ),
)

PRESETS: Mapping[str, Preset] = MappingProxyType({row.name: row for row in _ROWS})
"""The named methods by name, ``auto`` first."""
