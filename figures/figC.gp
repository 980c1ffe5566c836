load folder."/response.gp"
