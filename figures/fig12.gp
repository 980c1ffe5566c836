from = 0.03
styles = "1 2 3 4"
theory = "1"
set yrange [0:0.55]
set key bottom right maxrows 4
set ylabel "A (η − 2ζ) / ν"
load folder."/loss.gp"
