#!/bin/sh
# A file that is a byte longer than its kind allows, or of 1 GB, is rejected by its length, from a disk before it is
# read, from a pipe on reading what its kind allows, in less than 200 MB of address space.
#
#   too_long.sh PROGRAM FOLDER [unlimited]      unlimited: for sanitizers, which take terabytes of it
program=$1 folder=$2
mkdir -p "$folder" && cd "$folder" || exit 1
truncate -s 1000000000 big.json || exit 1
trap 'rm -f big.json one_more.json error' EXIT
[ "$3" = unlimited ] || ulimit -v 195312 || exit 1

# rejected BYTES KIND NAME GIVEN FILE
rejected() {
  "$program" check "$2" "$5" > output 2> error
  code=$?
  expected="$5: too long, allowed are $1 bytes for a $3, got $4"
  if [ $code != 3 ] || [ "$(cat error)" != "$expected" ] || [ -s output ]; then
    echo "check $2 $5: exit code $code instead of 3; said:"
    cat error output
    echo "instead of: $expected"
    exit 1
  fi
}
for kind in "1048576 scene scene" "134217728 run run" "1048576 catalogue catalogue" "4194304 claims claims file" \
  "1048576 manifest manifest"; do
  set -- $kind
  rejected "$1" "$2" "$3${4:+ $4}" 1000000000 big.json
  truncate -s $(($1 + 1)) one_more.json
  rejected "$1" "$2" "$3${4:+ $4}" $(($1 + 1)) one_more.json
  head -c 1000000000 /dev/zero 2> head_error | rejected "$1" "$2" "$3${4:+ $4}" more /dev/stdin || exit 1
done
rm -f output head_error
echo "1 GB rejected of each kind, from disk and pipe"
