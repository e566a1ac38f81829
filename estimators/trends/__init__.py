"""Trends in time series: the verb :func:`estimators.fit_trend` and its answer."""
