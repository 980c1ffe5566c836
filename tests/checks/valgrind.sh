#!/bin/sh
# One run under valgrind, everything recorded: nothing unset is read, nothing is read or written outside, nothing is
# lost, and the run file has the bytes that it has without valgrind.
#
#   valgrind.sh PROGRAM FOLDER OPTION...      the options of `run`
#
# Exit code 77: valgrind is not here.
command -v valgrind > /dev/null || { echo "skipped: valgrind is not here (Debian: valgrind)"; exit 77; }
program=$1 folder=$2
shift 2
mkdir -p "$folder" && cd "$folder" || exit 1
record="--record half_cycles,impacts,contacts,energy,history --history 0:20:401"
"$program" run "$@" $record -o plain.json || exit 1
valgrind --quiet --error-exitcode=9 --leak-check=full --show-leak-kinds=definite,indirect,possible \
  "$program" run "$@" $record -o watched.json || { echo "exit code $? under valgrind: run $*"; exit 1; }
cmp plain.json watched.json
