"""Search behind ``auto``: the line about which readings scatter most finely and to which they keep returning.

No threshold is needed. In a frame of their own (:mod:`frame`) pairs propose lines, and a histogram of their
residuals says at which scale each is remarkable (:mod:`hypotheses`, :mod:`shortlist`); a mixture with sticky
labels along the time axis weighs what the rest of the readings would have to be (:mod:`mixture`, :mod:`em`,
:mod:`candidates`); one criterion chooses (:mod:`criterion`, :mod:`choice`); an M-estimate finishes on all
points (:mod:`finish`). Everything is a pure function of the data: no random numbers, no seed.

The composition follows METHODS_TRENDS ("One threshold-free configuration"); what differs says so.
"""
