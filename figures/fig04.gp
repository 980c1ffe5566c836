load folder."/absolute.gp"
