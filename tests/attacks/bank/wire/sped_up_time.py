# family = "wire"
# tries = "The talker is a process whose system clock runs twenty-five times too fast (a preloaded clock_gettime), so that its messages say that they were sent half a second apart while they come all at once; it keeps to real time."
# could_earn = "The three points for the rate."
# earned = { "lab_1_2.talker" = 7 }
# at_most = true
# undefended = "The times of sending that a publisher writes were believed: full marks. Times of arrival must agree with them now."

# %% extra
<<fast_clock>>
FAST = fast_talker("25", "0.02")

# %% solution TalkerNode
<<starts_fast>>
