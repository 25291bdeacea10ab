# shellcheck shell=bash
# The set-up that ./run and ./test share: `. cmake/setup.sh`, then `lumivox_set_up ROOT TARGET...`.
# It installs the packages that are missing, configures once and builds what changed of the targets. All of its words go to stderr, so that the
# output of the program that follows stays clean.

lumivox_say() { echo "lumivox: $*" >&2; }

# The packages of cmake/packages.txt that are not installed, one a line.
lumivox_missing_packages() {
  local root=$1 package
  local -A installed=()
  local -a wanted=()
  while read -r package _; do
    case $package in '' | '#'*) ;; *) wanted+=("$package") ;; esac
  done <"$root/cmake/packages.txt"
  while read -r package status; do
    if [ "$status" = installed ]; then installed[$package]=1; fi
  done < <(dpkg-query -W -f='${Package} ${db:Status-Status}\n' "${wanted[@]}" 2>/dev/null)
  for package in "${wanted[@]}"; do
    if [ -z "${installed[$package]:-}" ]; then echo "$package"; fi
  done
}

# apt-get as root: directly, or through sudo, which may ask for a password only where somebody can answer.
lumivox_apt_get() {
  local -a as_root=()
  if [ "$(id -u)" -ne 0 ]; then
    if [ -t 0 ]; then as_root=(sudo); else as_root=(sudo -n); fi
  fi
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -qq -o Acquire::Retries=3 -o DPkg::Lock::Timeout=120 "$@"
}

lumivox_install_packages() {
  local root=$1 log=$1/build/packages.log
  local -a missing
  if ! command -v dpkg-query >/dev/null; then
    lumivox_say "this is no Debian system, so the packages of cmake/packages.txt (or their like) are taken to be there"
    return 0
  fi
  mapfile -t missing < <(lumivox_missing_packages "$root")
  if [ ${#missing[@]} -eq 0 ]; then return 0; fi
  if [ "$(id -u)" -ne 0 ] && ! command -v sudo >/dev/null; then
    lumivox_say "these packages are missing, and installing them needs root or sudo: ${missing[*]}"
    return 1
  fi
  lumivox_say "installing ${#missing[@]} packages (log: $log): ${missing[*]}"
  if ! { lumivox_apt_get update && lumivox_apt_get install -y --no-install-recommends "${missing[@]}"; } >"$log" 2>&1; then
    tail -n 20 "$log" >&2
    lumivox_say "these packages are missing and could not be installed: $(lumivox_missing_packages "$root" | tr '\n' ' ')"
    return 1
  fi
}

# build/.packages-ok holds the list for which all packages were found installed; the same list is not checked again.
lumivox_ensure_packages() {
  local root=$1 stamp=$1/build/.packages-ok
  if cmp -s "$root/cmake/packages.txt" "$stamp"; then return 0; fi
  lumivox_install_packages "$root" || return 1
  cp "$root/cmake/packages.txt" "$stamp"
}

lumivox_configure() {
  local root=$1 cache=$1/build/CMakeCache.txt
  local -a fresh=()
  if [ -f "$cache" ] && ! grep -qxF "CMAKE_HOME_DIRECTORY:INTERNAL=$root" "$cache"; then
    lumivox_say "build/ belongs to another source folder; configuring it anew"
    fresh=(--fresh)
  elif [ -f "$root/build/build.ninja" ]; then
    return 0
  fi
  lumivox_say "configuring (cmake --preset release)"
  (cd "$root" && cmake --preset release "${fresh[@]}" -Wno-dev >"$root/build/configure.log" 2>&1) || {
    tail -n 30 "$root/build/configure.log" >&2
    lumivox_say "configuring failed; the whole log is $root/build/configure.log"
    return 1
  }
}

lumivox_build() {
  local root=$1
  shift
  lumivox_say "building what changed (ninja -C build $*)"
  # ninja talks on stdout; its words belong to the set-up.
  (cd "$root/build" && ninja "$@") >&2 || {
    lumivox_say "the build failed"
    return 1
  }
}

lumivox_set_up() {
  local root=$1
  shift
  mkdir -p "$root/build" &&
    lumivox_ensure_packages "$root" && lumivox_configure "$root" && lumivox_build "$root" "$@" && return 0
  # Whatever went wrong may be a package that was removed: look again the next time.
  rm -f "$root/build/.packages-ok"
  return 1
}
