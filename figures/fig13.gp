from = 0.01
styles = "2 1 3"
theory = "1 2 3"
logarithmic = "x"
set yrange [0:0.8]
ordinate = "A (η − 2ζ) / ν"
set ylabel formula(ordinate)
load folder."/loss.gp"
