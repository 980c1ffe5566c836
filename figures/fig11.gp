from = 0.03
styles = "1 2 3 4"
theory = "1"
set logscale y
set yrange [0.04:10]
set ylabel "(η − 2ζ) / ν"
load folder."/loss.gp"
