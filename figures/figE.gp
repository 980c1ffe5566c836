plot NaN notitle
