from = 0.03
styles = "1 2 3 4"
theory = "1"
logarithmic = "xy"
set yrange [0.04:10]
ordinate = "(η − 2ζ) / ν"
set ylabel formula(ordinate)
load folder."/loss.gp"
