load folder."/relative.gp"
