# The peak amplitude over time, and how far perturbed initial conditions part from it.
load folder."/own.gp"
eval require("curve", 3)
eval look("curve", 1)
to = STATS_max
eval look("curve", 2)
if (STATS_index_max > STATS_records / 2) { set key bottom right }
logarithmic = STATS_min > 0 && STATS_max > 10 * STATS_min ? "y" : ""
eval axis("x", "time", "time", "t", 0, to, 0)
eval strlen(logarithmic) ? axis("y", "length", "peak amplitude", "A", STATS_min / 1.2, STATS_max * 1.3, 1) \
                         : axis("y", "length", "peak amplitude", "A", 0, STATS_max > 0 ? 1.1 * STATS_max : 1, 0)
band = !has("band") ? "" : \
  'table index "band" using ($1*unit_x):($2*unit_y):($3*unit_y) with filledcurves lc rgb sky title columnheader(3),'
eval 'plot '.band.'table index "curve" using ($1*unit_x):($2*unit_y) with lines ls 1 title columnheader(2)'
eval axes(name_x, name_y, logarithmic)
