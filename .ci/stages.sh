# shellcheck shell=bash
# Stages of a run, with a table of their wall-clock and processor minutes at the end: sourced by .ci/run.

stages=()  # rows of the table
alone=     # folder that is removed at the end

# Processor seconds of this shell's children that have ended (fields 16 and 17 of proc_pid_stat(5), in clock ticks).
processor_seconds() {
  local fields
  read -r -a fields < /proc/$$/stat
  echo $(((fields[15] + fields[16]) / $(getconf CLK_TCK)))
}

# stage NAME COMMAND...: runs the command; the run ends where it fails.
stage() {
  local name=$1 begin=$SECONDS before status=0
  before=$(processor_seconds)
  shift
  echo "ci: $name" >&2
  "$@" || status=$?
  stages+=("$name $((SECONDS - begin)) $(($(processor_seconds) - before)) $status")
  [ "$status" -eq 0 ] || exit "$status"
}

finish() {
  local status=$?
  [ -z "$alone" ] || rm -rf "$alone"
  printf '%s\n' "${stages[@]}" total | awk -v cores="$(nproc)" '
    BEGIN { row = "%-12s %10s %15s  %s\n"; printf row, "stage", "wall (min)", "processor (min)", "result" }
    $1 != "total" { wall += $2; cpu += $3; printf row, $1, sprintf("%.1f", $2 / 60), sprintf("%.1f", $3 / 60), $4 ? "failed" : "ok" }
    $1 == "total" { printf row, "total", sprintf("%.1f", wall / 60), sprintf("%.1f", cpu / 60), "on " cores " processors" }' |
    tee -a "${GITHUB_STEP_SUMMARY:-/dev/null}" >&2
  exit "$status"
}
trap finish EXIT
