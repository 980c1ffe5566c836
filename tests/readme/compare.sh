#!/bin/sh
# Holds README.md or the files of paper/ against what paper/refresh made of them: FILE... under SOURCE and under NEW.
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

differing=0 count=0
for pattern in "$@"; do
  for file in "$new"/$pattern "$source"/$pattern; do
    case $file in "$new"/*) file=${file#"$new"/} ;; *) file=${file#"$source"/} ;; esac
    count=$((count + 1))
    [ -f "$source/$file" ] || { echo "$file is made but not committed"; differing=1; continue; }
    [ -f "$new/$file" ] || { echo "$file is committed but not made"; differing=1; continue; }
    if [ $same = cmp ]; then
      cmp -s "$source/$file" "$new/$file" && continue
      echo "$file is not what the program makes:"
      diff "$source/$file" "$new/$file" | cut -c 1-300 | head -n 20
    else
      words "$source/$file" >"$new/words.committed"
      words "$new/$file" >"$new/words.made"
      cmp -s "$new/words.committed" "$new/words.made" && continue
      echo "$file has not the words that the program makes:"
      diff "$new/words.committed" "$new/words.made" | cut -c 1-300 | head -n 20
    fi
    differing=1
  done
done
[ "$count" -gt 0 ] || { echo "nothing to compare"; exit 1; }
[ $differing = 0 ] || { echo "If the new one is right: make paper"; exit 1; }
