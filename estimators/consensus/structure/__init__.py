"""The search behind ``auto``: which line do the readings scatter about most finely and return to?

No threshold is needed. Pairs propose lines (:mod:`hypotheses`), a histogram of their residuals says at
which scale each is remarkable (:mod:`evidence`), a mixture with sticky labels along the time axis weighs
what the rest of the readings would have to be (:mod:`mixture`), and one criterion chooses
(:mod:`choice`). Everything is a pure function of the data: no random numbers, no seed.

The composition is described in METHODS_TRENDS ("One threshold-free configuration").
"""
