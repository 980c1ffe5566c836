from = 0.03
styles = "2 1 3"
theory = "2"
logarithmic = "xy"
set yrange [0.04:10]
ordinate = "η / ν"
set ylabel "specific loss factor ".formula(ordinate)
load folder."/loss.gp"
