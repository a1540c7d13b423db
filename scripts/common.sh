# shellcheck shell=bash
# Shared by the scripts here: `. "$(dirname "$0")/common.sh"`. Puts the caller into the repository's root.
set -eu

root=$(CDPATH='' cd -- "$(dirname -- "$0")/.." && pwd)
cd "$root"
build=${SELVAGE_BUILD:-$root/build}
cores=$(nproc 2>/dev/null || echo 2)

# A compiler takes up to 2 GB here (CGAL): no more of them than the memory holds.
gigabytes=$(awk '/^MemAvailable:/ {print int($2 / 1048576)}' /proc/meminfo 2>/dev/null || echo 4)
jobs=$((gigabytes / 2))
[ "$jobs" -ge 1 ] || jobs=1
[ "$jobs" -le "$cores" ] || jobs=$cores

# Of builds with clang's sanitizers: what is left as it is says headers.txt. Eigen asserts its indices itself.
# shellcheck disable=SC2034  # of scripts/sanitize and scripts/fuzz
sanitizer_flags="-O2 -g1 -DCGAL_NDEBUG -fsanitize-ignorelist=$root/scripts/suppressions/headers.txt"

# The build for libFuzzer (scripts/fuzz), whose sources scripts/syntax reads.
# shellcheck disable=SC2034  # of those two
fuzz_options=(-DCMAKE_CXX_COMPILER=clang++ -DSELVAGE_FUZZ=ON -DSELVAGE_WERROR=OFF "-DSELVAGE_SANITIZE=address,undefined"
  -DCMAKE_BUILD_TYPE=Debug "-DCMAKE_CXX_FLAGS_DEBUG=$sanitizer_flags")
# shellcheck disable=SC2034
coverage_flags="-O1 -fprofile-instr-generate -fcoverage-mapping"

# configure [CMAKE OPTIONS]: quiet unless it fails.
configure() {
  log=$(mktemp)
  if ! cmake -S "$root" -B "$build" -G Ninja "$@" > "$log" 2>&1; then
    cat "$log" >&2
    rm -f "$log"
    exit 1
  fi
  rm -f "$log"
}

# compile [TARGET...]: builds in $build. Its progress is told on standard error: by ninja on a terminal, elsewhere by a line
# every ten seconds; what compilers said follows where it fails.
compile() {
  if [ -t 2 ]; then
    ninja -C "$build" -j "$jobs" "$@" >&2
    return
  fi
  log=$(mktemp)
  # The sleep holds nothing open that a reader of our output might wait for.
  # shellcheck disable=SC2217  # so that its standard input is not ours
  while sleep 10 < /dev/null > /dev/null 2>&1; do
    echo "building: $(grep -oE '^\[[0-9]+/[0-9]+\]' "$log" | tail -n 1)" >&2
  done &
  teller=$!
  status=0
  ninja -C "$build" -j "$jobs" "$@" > "$log" 2>&1 || status=$?
  kill "$teller"
  [ "$status" -eq 0 ] || grep -vE '^\[[0-9]+/[0-9]+\]' "$log" >&2
  rm -f "$log"
  return "$status"
}

# python_files, shell_files: the sources in that language, by ending or first line.
with_first_line() { grep -rlE -m 1 "^#!.*$1" .ci scripts tests samples --exclude='*.py'; }
python_files() { { find scripts tests samples -name '*.py' && with_first_line 'python3?$'; } | LC_ALL=C sort; }
shell_files() { { printf "%s\n" scripts/common.sh .ci/stages.sh && with_first_line '(/sh|bash)$'; } | LC_ALL=C sort; }
