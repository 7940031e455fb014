# Sourced by run and test: configures and builds a preset, quietly unless it fails.
# shellcheck shell=bash

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)

# Where a preset builds; the same as binaryDir in CMakePresets.json.
build_directory() {
  if [[ $1 == default ]]; then echo "$root/build"; else echo "$root/build-$1"; fi
}

# build PRESET [TARGET...]: leaves the log in the build directory; prints it and returns 1 when something fails.
build() {
  local preset=$1 directory log
  shift
  directory=$(build_directory "$preset")
  log="$directory/build.log"
  mkdir -p "$directory"
  (
    flock 9 || exit 1   # two runs at once must not build in the same folder
    cd "$root" || exit 1
    if [[ ! -f $directory/build.ninja || CMakePresets.json -nt $directory/CMakeCache.txt ]]; then
      cmake --preset "$preset" >"$log" 2>&1 || { cat "$log" >&2; echo "configuring '$preset' failed" >&2; exit 1; }
    fi
    # Says that it builds once something was compiled, all else goes to the log.
    # shellcheck disable=SC2016
    ninja -C "$directory" "$@" 2>&1 | awk -v log_file="$log" -v what="${directory#"$root"/}" '
      BEGIN { printf "" > log_file }
      { print > log_file }
      /Building/ && !said { said = 1; print "building " what " ..."; fflush() }' ||
      { cat "$log" >&2; echo "building '$preset' failed" >&2; exit 1; }
  ) 9>"$directory/.lock"
}
