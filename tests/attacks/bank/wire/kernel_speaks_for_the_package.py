# family = "wire"
# assignment = "lab_1_1"
# tries = "The package builds, and its program prints a word and sleeps. While the judge looks for its node, the kernel joins every ROS domain of its network and says the line from a node of the right name."
# could_earn = "The points for a node and a line that the package does not have."
# earned = { "lab_1_1.hello" = 3 }
# undefended = "Ten points, as long as kernel and package are on one network."

# %% solution files
<<silent_package>>
<<speaks_for_it>>
