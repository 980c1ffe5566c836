load folder."/schematic.gp"
eval canvas(720, 400)
set xrange [0:25]
set yrange [0:12]

eval ground(4, 2.4, 10.6)
eval spring(4, 11, 8.6, 0.7)
eval text(7.5, 10.1, "K_M")
eval damper(4, 11, 4.8, 0.7)
eval text(7.5, 6.3, "C_M")
eval line(11, 3.4, 11, 10)
eval block(13, 4.5, 17, 8.9, "#BFD9EA")
eval text(15, 6.7, "m")
eval pointing(21.5, 6.7, 17.6, 6.7)
eval text(19.6, 7.6, "unit velocity")
eval thin(11, 3.4, 11, 1.2)
eval pointing(11, 1.7, 8.4, 1.7)
eval text(9.6, 0.8, "deformation")
plot NaN notitle
