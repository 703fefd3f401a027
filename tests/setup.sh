#!/usr/bin/env bash
# Everything that the project needs on a fresh Debian machine: Debian packages, Python, the build.
#
#    bash tests/setup.sh [PRESET]     sets up, and builds build/PRESET (default: release)
#    source tests/setup.sh            gives other scripts the functions below
#
# What is there already is left alone, so the second call installs and builds nothing. Debian
# packages are installed as root or through sudo without a password; otherwise what is missing is
# listed and the call ends with 1. Python packages go into .venv (or $XMPM_VENV), pinned by
# requirements.txt.

xmpm_root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd -P)
XMPM_VENV=${XMPM_VENV:-$xmpm_root/.venv}
XMPM_PYTHON=$XMPM_VENV/bin/python
export XMPM_VENV XMPM_PYTHON

# Open MPI refuses root and refuses more ranks than cores, unless told. The other two silence
# warnings in containers: no network card, no right to copy between processes.
export OMPI_ALLOW_RUN_AS_ROOT=1
export OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
export OMPI_MCA_rmaps_base_oversubscribe=1
export OMPI_MCA_btl_base_warn_component_unused=0
export OMPI_MCA_btl_vader_single_copy_mechanism=none

say() { printf 'xmpm3d: %s\n' "$*"; }
fail() {
   printf 'xmpm3d: %s\n' "$@" >&2
   exit 1
}

# --- Debian packages ---------------------------------------------------------------------------

has_command() { command -v "$1" >/dev/null 2>&1; }
has_library() { grep -q "[[:space:]]$1 " <<<"$libraries"; }
has_file() { compgen -G "$1" >/dev/null; }
has_hdf5() {
   has_file '/usr/include/hdf5/*/hdf5.mod' ||
      { [ -n "${HDF5_ROOT:-}" ] && [ -d "$HDF5_ROOT" ]; }
}
has_metis() {
   has_file '/usr/include/metis.h' || has_file '/usr/local/include/metis.h' ||
      { [ -n "${METIS_ROOT:-}" ] && [ -d "$METIS_ROOT" ]; }
}

# A Python that can make virtual environments and is new enough; empty where there is none.
find_python() {
   local candidate
   for candidate in python3 /usr/bin/python3 python3.14 python3.13 python3.12 python3.11; do
      if "$candidate" -c 'import sys, venv, ensurepip; sys.exit(sys.version_info < (3, 11))' \
         >/dev/null 2>&1; then
         command -v "$candidate"
         return
      fi
   done
}

# Names of the Debian packages that are missing, one a line.
missing_packages() {
   local pair libraries
   libraries=$(PATH=$PATH:/sbin:/usr/sbin ldconfig -p)
   for pair in gfortran:gfortran gcc:gcc make:make cmake:cmake mpirun:openmpi-bin git:git \
      mpifort:libopenmpi-dev pkg-config:pkg-config; do
      has_command "${pair%%:*}" || echo "${pair##*:}"
   done
   has_hdf5 || echo libhdf5-openmpi-dev
   has_metis || echo libmetis-dev
   [ -n "$(find_python)" ] || printf '%s\n' python3 python3-venv
   # What the wheels of gmsh and VTK load at run time.
   for pair in libGLU.so.1:libglu1-mesa libGL.so.1:libgl1 libXrender.so.1:libxrender1 \
      libXcursor.so.1:libxcursor1 libXft.so.2:libxft2 libXinerama.so.1:libxinerama1 \
      libXfixes.so.3:libxfixes3 libfontconfig.so.1:fontconfig libEGL.so.1:libegl1; do
      has_library "${pair%%:*}" || echo "${pair##*:}"
   done
}

ensure_packages() {
   local missing as_root=() log
   mapfile -t missing < <(missing_packages)
   [ "${#missing[@]}" -gt 0 ] || return 0
   if ! has_command apt-get; then
      fail 'these are missing (names of the Debian packages that hold them):' \
         "   ${missing[*]}" 'and there is no apt-get to install them with.'
   fi
   if [ "$(id -u)" -ne 0 ]; then
      if ! sudo -n true 2>/dev/null; then
         fail 'these Debian packages are missing:' "   ${missing[*]}" \
            'and I am neither root nor allowed to use sudo without a password. Please run:' \
            "   sudo apt-get update && sudo apt-get install --no-install-recommends ${missing[*]}"
      fi
      as_root=(sudo -n)
   fi
   say "installing Debian packages: ${missing[*]}"
   log=$xmpm_root/build/apt.log
   if ! { "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get update -qq &&
      "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq \
         --no-install-recommends "${missing[@]}"; } >"$log" 2>&1; then
      tail -n 20 "$log" >&2
      fail "apt-get could not install: ${missing[*]}" "(the whole log: $log)"
   fi
   mapfile -t missing < <(missing_packages)
   [ "${#missing[@]}" -eq 0 ] ||
      fail "still missing after installation: ${missing[*]}" "(the log of apt-get: $log)"
}

# --- Python ------------------------------------------------------------------------------------

# What .venv was made from; a change of it makes it anew.
python_stamp() {
   echo "$XMPM_VENV"
   cat "$xmpm_root/requirements.txt"
}

# What is installed of the project itself; a change of it installs these packages again.
own_stamp() {
   local project
   for project in preproc postproc; do
      if [ -f "$xmpm_root/$project/pyproject.toml" ]; then
         echo "$xmpm_root/$project"
         cat "$xmpm_root/$project/pyproject.toml"
      fi
   done
}

ensure_python() {
   local stamp=$XMPM_VENV/.stamp log=$xmpm_root/build/pip.log python
   if [ -f "$stamp" ] && "$XMPM_PYTHON" -c '' 2>/dev/null &&
      [ "$(python_stamp)" = "$(cat "$stamp")" ]; then
      return 0
   fi
   python=$(find_python)
   say "installing Python packages into $XMPM_VENV (about a minute)"
   rm -f "$stamp"
   if ! { "$python" -m venv --clear "$XMPM_VENV" &&
      "$XMPM_PYTHON" -m pip install --disable-pip-version-check \
         -r "$xmpm_root/requirements.txt"; } >"$log" 2>&1; then
      tail -n 20 "$log" >&2
      fail "could not install the packages of requirements.txt into $XMPM_VENV" \
         "(the whole log: $log)"
   fi
   python_stamp >"$stamp"
}

# The commands xmpm-prep and xmpm-post, from the sources of this folder.
ensure_own() {
   local stamp=$XMPM_VENV/.own log=$xmpm_root/build/pip-own.log project own=()
   if [ -f "$stamp" ] && [ "$(own_stamp)" = "$(cat "$stamp")" ]; then
      return 0
   fi
   for project in preproc postproc; do
      if [ -f "$xmpm_root/$project/pyproject.toml" ]; then
         own+=(--editable "$xmpm_root/$project")
      fi
   done
   if [ "${#own[@]}" -gt 0 ]; then
      say 'installing the commands of preproc and postproc'
      if ! "$XMPM_PYTHON" -m pip install --disable-pip-version-check --no-deps \
         --no-build-isolation "${own[@]}" >"$log" 2>&1; then
         tail -n 20 "$log" >&2
         fail "could not install ${own[*]} (the whole log: $log)"
      fi
   fi
   own_stamp >"$stamp"
}

# --- Build -------------------------------------------------------------------------------------

# Configure and build a preset: ensure_build PRESET [-DNAME=VALUE ...]. Options stay as they were
# chosen last. Prints the compiler's output only where the build fails.
ensure_build() {
   local preset=$1 folder=$xmpm_root/build/$1 cache log
   shift
   cache=$folder/CMakeCache.txt
   log=$xmpm_root/build/$preset.log
   # A tree that was moved or copied cannot use the old configuration.
   if [ -f "$cache" ] && ! grep -qxF "CMAKE_HOME_DIRECTORY:INTERNAL=$xmpm_root" "$cache"; then
      rm -rf "$folder"
   fi
   if [ ! -f "$folder/Makefile" ] || [ "$#" -gt 0 ]; then
      [ -f "$folder/Makefile" ] || say "configuring build/$preset"
      if ! (cd "$xmpm_root" && cmake --preset "$preset" "$@") >"$log" 2>&1; then
         cat "$log" >&2
         fail "could not configure build/$preset"
      fi
   fi
   [ -f "$folder/bin/xmpm3d" ] || say "building build/$preset"
   if ! cmake --build "$folder" --parallel "$(nproc)" >"$log" 2>&1; then
      grep -v '^\[ *[0-9]*%\]' "$log" >&2
      fail "could not build build/$preset (the whole log: $log)"
   fi
}

# All of it, one caller at a time.
ensure_all() {
   mkdir -p "$xmpm_root/build" 2>/dev/null && [ -w "$xmpm_root/build" ] ||
      fail "I cannot write into $xmpm_root, where the build and the results go." \
         'Copy the project to a folder of yours, or change the owner of this one.'
   (
      if has_command flock; then flock 9; fi
      ensure_packages && ensure_python && ensure_own && ensure_build "$@"
   ) 9>"$xmpm_root/build/.lock" || exit 1
}

if [ "${BASH_SOURCE[0]}" = "$0" ]; then
   set -euo pipefail
   ensure_all "${@:-release}"
   say "ready: $xmpm_root/build/${1:-release}/bin/xmpm3d"
fi
