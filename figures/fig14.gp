from = 0.01
styles = "2 1 3"
theory = "1 2 3"
logarithmic = "x"
set yrange [0:2]
ordinate = "A (η − 2ζ) / (ν (1 − e))"
set ylabel formula(ordinate)
load folder."/loss.gp"
