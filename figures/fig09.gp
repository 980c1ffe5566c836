from = 0.03
styles = "2 1 3"
theory = "2"
set logscale y
set yrange [0.04:10]
set ylabel "specific loss factor η / ν"
load folder."/loss.gp"
