#!/bin/sh
# Holds README.md or the files of paper/ against what paper/refresh made of them: compare.sh SOURCE NEW FILE...
#
# Byte for byte, if paper/made_with.txt is the same here. With another gnuplot or other last bits of sin and cos,
# chaos between amplitudes of 3 and 0.42 changes digits and marks: then all words, verdicts among them, must be the
# same, and no number is compared. (What the numbers may be is checked everywhere, by the claims.)
set -eu
export LC_ALL=C.UTF-8
source=$1 new=$2
shift 2

words() {  # without numbers, and with pictures reduced to their labels
  case $1 in
    *.svg) grep -o '<tspan[^>]*>[^<]*' "$1" | sed 's/.*>//' ;;
    *) cat "$1" ;;
  esac | sed -E 's/-?[0-9]+(\.[0-9]+)?(e[-+]?[0-9]+)?/#/g; s/#(,#)+/#/g; s/ \(# to #\)//g; s/^[ #]*$//' |
    case $1 in *.svg) sort -u ;; *) cat ;; esac
}

if cmp -s "$source/paper/made_with.txt" "$new/paper/made_with.txt"; then
  same=cmp
else
  echo "Not made with what is here, so only words are compared:"
  diff "$source/paper/made_with.txt" "$new/paper/made_with.txt" || true
  same=words
fi

differing=0
files=$(for place in "$source" "$new"; do (cd "$place" && ls -d $*); done | sort -u)
for file in $files; do
  [ -f "$source/$file" ] || { echo "$file is made but not committed"; differing=1; continue; }
  [ -f "$new/$file" ] || { echo "$file is committed but not made"; differing=1; continue; }
  if [ $same = cmp ]; then
    cmp -s "$source/$file" "$new/$file" && continue
    echo "$file is not what the program makes:"
    diff "$source/$file" "$new/$file" | cut -c 1-300 | head -n 20
  else
    words "$source/$file" >"$new/$file.committed-words"
    words "$new/$file" >"$new/$file.words"
    cmp -s "$new/$file.committed-words" "$new/$file.words" && continue
    echo "$file has not the words that the program makes:"
    diff "$new/$file.committed-words" "$new/$file.words" | cut -c 1-300 | head -n 20
  fi
  differing=1
done
[ -n "$files" ] || { echo "nothing to compare"; exit 1; }
[ $differing = 0 ] || { echo "If the new one is right: make paper"; exit 1; }
