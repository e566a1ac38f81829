"""Run as a program: epochs as JSON on standard input, a peer's answers as JSON on standard output.

It imports nothing of this project, so that it runs in any environment that holds the peer.
"""

from __future__ import annotations

import json
import sys
import time
from collections.abc import Callable, Mapping
from typing import Any

Epoch = Mapping[str, Any]
Found = dict[str, Any]
_THRESHOLDS = (1.0, 3.0, 10.0, 30.0, 100.0, 300.0, 1000.0, 3000.0)
_MOST_EXCLUSIONS = 4
_TUNED_ON = 40
_FALSE_ALARM = 1e-3
_EARTH_RATE, _SPEED_OF_LIGHT = 7.2921151467e-5, 299792458.0


def by_sidereon(request: Mapping[str, Any]) -> tuple[list[Found], float]:
    """Single point positioning with RAIM-gated exclusion, from raw ranges and the broadcast ephemeris."""
    import sidereon  # noqa: PLC0415  # present in one of the environments only

    broadcast = sidereon.load_rinex_nav(request["navigation"].encode())
    observations = sidereon.load_rinex_obs(request["observations"].encode())
    ionosphere: Any = broadcast.iono_corrections.gps
    found_inputs = sidereon.spp_inputs_from_rinex_obs(broadcast, observations)
    inputs = {round(_time_of_week(given)): given for given in found_inputs}
    answers, seconds = [], 0.0
    for epoch in request["epochs"]:
        given = inputs[round(epoch["time_s"])]
        config = sidereon.SppConfig(
            [sidereon.SppObservation(*pair) for pair in zip(epoch["name"], epoch["raw_m"], strict=True)],
            given.t_rx_j2000_s,
            given.t_rx_second_of_day_s,
            given.day_of_year,
            [0.0, 0.0, 0.0, 0.0],
            corrections=sidereon.SppCorrections(ionosphere=True, troposphere=True),
            klobuchar=sidereon.SppKlobucharCoeffs(list(ionosphere.alpha), list(ionosphere.beta)),
            glonass_channels=dict(broadcast.glonass_frequency_channels),
        )
        weights = {n: 1.0 / s**2 for n, s in zip(epoch["name"], epoch["sigma_m"], strict=True)}
        answer: Found = {"position": None, "used": []}
        started = time.process_time()
        try:
            result = sidereon.fde_broadcast(
                broadcast, config, p_fa=_FALSE_ALARM, max_exclusions=_MOST_EXCLUSIONS, weights=weights
            )
            answer = {"position": [float(x) for x in result.position], "used": list(result.used_sats)}
        except sidereon.SidereonError:
            pass
        seconds += time.process_time() - started
        answers.append(answer)
    return answers, seconds


def _time_of_week(given: Any) -> float:
    """J2000 is 2000-01-01 12:00, a Saturday: six and a half days into its GPS week."""
    return float((given.t_rx_j2000_s + 6.5 * 86400.0) % 604800.0)


def by_gnss_lib_py(request: Mapping[str, Any]) -> tuple[list[Found], float]:
    """Greedy residual exclusion at the least threshold that leaves clean epochs alone, then least squares."""
    from gnss_lib_py.algorithms.fde import solve_fde  # noqa: PLC0415
    from gnss_lib_py.algorithms.snapshot import solve_wls  # noqa: PLC0415

    clean = request["clean"][:: max(1, len(request["clean"]) // _TUNED_ON)]
    threshold = _THRESHOLDS[-1]
    for trial in reversed(_THRESHOLDS):
        kept = [
            len(solve_fde(_nav_data(e), method="residual", remove_outliers=True, threshold=trial))
            for e in clean
        ]
        if kept != [len(e["name"]) for e in clean]:
            break
        threshold = trial
    answers, seconds = [], 0.0
    for epoch in request["epochs"]:
        data = _nav_data(epoch)
        started = time.process_time()
        data = solve_fde(data, method="residual", remove_outliers=True, threshold=threshold)
        state = solve_wls(data)
        seconds += time.process_time() - started
        used = [epoch["name"][int(i)] for i in data["place", :].reshape(-1)] if len(data) > 0 else []
        position = [float(state[f"{axis}_rx_wls_m", 0]) for axis in "xyz"] if len(data) > 3 else None
        if position is not None and not all(abs(x) < 1e12 for x in position):
            position = None
        answers.append({"position": position, "used": used})
    return answers, seconds


def _nav_data(epoch: Epoch) -> Any:
    import numpy as np  # noqa: PLC0415
    from gnss_lib_py.navdata.navdata import NavData  # noqa: PLC0415

    n = len(epoch["name"])
    positions = np.array(epoch["satellites_m"])
    # Its solver turns satellites to the time of reception itself.
    angle = -_EARTH_RATE * np.linalg.norm(positions - np.array(epoch["truth_m"]), axis=1) / _SPEED_OF_LIGHT
    x, y = positions[:, 0].copy(), positions[:, 1].copy()
    positions[:, 0] = np.cos(angle) * x + np.sin(angle) * y
    positions[:, 1] = np.cos(angle) * y - np.sin(angle) * x
    data = NavData()
    data["gps_millis"] = np.full(n, epoch["time_s"] * 1e3)
    data["gnss_id"] = np.array(["gps"] * n)
    data["sv_id"] = np.array([int(name[1:]) for name in epoch["name"]])
    data["place"] = np.arange(n)
    for axis, column in zip("xyz", positions.T, strict=True):
        data[f"{axis}_sv_m"] = column
    data["b_sv_m"] = np.zeros(n)
    data["corr_pr_m"] = np.array(epoch["ranges_m"])
    return data


PEERS: Mapping[str, Callable[[Mapping[str, Any]], tuple[list[Found], float]]] = {
    "sidereon": by_sidereon,
    "gnss_lib_py": by_gnss_lib_py,
}


def main() -> int:
    """Answer one request."""
    request = json.load(sys.stdin)
    answers, seconds = PEERS[request["peer"]](request)
    sys.stdout.write("\n" + json.dumps({"answers": answers, "seconds": seconds}) + "\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
