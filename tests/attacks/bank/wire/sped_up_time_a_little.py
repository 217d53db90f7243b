# family = "wire"
# tries = "The talker is a process whose system clock runs 2.3 times too fast (a preloaded clock_gettime), so that its messages say that they were sent half a second apart while they come every 0.22 s; it keeps to real time."
# could_earn = "The three points for the rate."
# earned = { "lab_1_2.talker" = 7 }
# at_most = true
# undefended = "Full marks, as long as messages had to arrive over no more than 0.4 of the time over which they were sent."

# %% extra
<<fast_clock>>
FAST = fast_talker("23 / 10", "0.5 / 2.3")

# %% solution TalkerNode
<<starts_fast>>
