#!/bin/sh
# Holds README.md or files of paper/ against what paper/refresh made of them: compare.sh SOURCE NEW FILE...
set -eu
source=$1 new=$2
shift 2

differing=0
for file; do
  cmp -s "$source/$file" "$new/$file" && continue
  echo "$file is not what the program makes:"
  diff "$source/$file" "$new/$file" | cut -c 1-300 | head -n 20
  differing=1
done
[ $differing = 0 ] || { echo "If the new one is right: make reference"; exit 1; }
