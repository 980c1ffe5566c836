from = 0.03
styles = "2 1 3"
theory = "1 2 3"
logarithmic = "xy"
set yrange [4e-4:0.3]
ordinate = "η"
set ylabel "loss factor ".formula(ordinate)
load folder."/loss.gp"
