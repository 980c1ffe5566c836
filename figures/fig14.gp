from = 0.01
styles = "2 1 3"
theory = "1 2 3"
set yrange [0:2]
set ylabel "A (η − 2ζ) / (ν (1 − e))"
load folder."/loss.gp"
