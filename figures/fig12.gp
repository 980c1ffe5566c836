from = 0.03
styles = "1 2 3 4"
theory = "1"
logarithmic = "x"
set yrange [0:0.55]
set key bottom right maxrows 4
ordinate = "A (η − 2ζ) / ν"
set ylabel ordinate
load folder."/loss.gp"
