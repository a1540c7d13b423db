#!/bin/sh
# Is the geometry of the fabrics still the one that was agreed on, and does it survive every format?
# Prints what differs, one line each; the exit code is not 0 then. Needs selvage in PATH.
set -u
cd "$(dirname "$0")" || exit 2
result=0
for fabric in fabrics/*.txt; do
  name=$(basename "$fabric" .txt)
  echo "$name:"
  selvage diff "reference/$name.igs" "$fabric" --tolerance 1e-7 || result=1
done
selvage roundtrip fabrics --junit "${1:-roundtrip.xml}" --no-progress || result=1
exit $result
