"""The RANSAC family: one loop, small policies (see :mod:`estimators.consensus.protocols`)."""
