load folder."/schematic.gp"
set xrange [0:25]
set yrange [0:15]

eval ground(5, 3, 11)
eval spring(5, 12, 9, 0.7)
eval text(8.5, 10.6, "K_M")
eval damper(5, 12, 5.5, 0.7)
eval text(8.5, 7.1, "C_M")
eval line(12, 4, 12, 10.4)
eval block(13.4, 5, 17.4, 9.4, "#BFD9EA")
eval text(15.4, 7.2, "m")
eval pointing(21.4, 7.2, 17.9, 7.2)
eval text(19.8, 8.1, "unit velocity")
eval thin(12, 4, 12, 1.4)
eval pointing(12, 2, 9.4, 2)
eval text(10.7, 1.1, "deformation")
plot NaN notitle
