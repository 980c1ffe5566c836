from = 0.01
styles = "2 1 3"
theory = "1 2 3"
set yrange [0:0.8]
set ylabel "A (η − 2ζ) / ν"
load folder."/loss.gp"
