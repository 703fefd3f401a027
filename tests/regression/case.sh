# shellcheck shell=bash
# What the cases share: `bash CASE/run.sh RANKS` with the program in XMPM3D and a Python that has
# numpy and h5py in XMPM_PYTHON (else xmpm3d and python3 of the path). Results go to folders of
# the working directory.
set -euo pipefail

here=$(cd "$(dirname "$0")" && pwd -P)
export ranks=${1:?usage: bash run.sh RANKS}
failed=0

# run_deck RANKS FOLDER [DECK [OPTION...]]: run a deck of the case, results into the folder.
run_deck() {
   local deck=${3:-$here/deck.inp}
   rm -rf "$2"
   mkdir -p "$2"
   mpirun -n "$1" "${XMPM3D:-xmpm3d}" --quiet -o "$2" "${@:4}" <"$deck"
}

# compare COMMAND ...: see compare.py; a failure is kept for `finish`, so that all rows are shown.
compare() {
   "${XMPM_PYTHON:-python3}" "$here/../compare.py" "$@" || failed=1
}

# expect_code CODE COMMAND...: the command must end with this exit code; what it says on standard
# error goes to the file `complaint`.
expect_code() {
   local code=0
   "${@:2}" 2>complaint || code=$?
   if [ "$code" -ne "$1" ]; then
      echo "FAILED exit code $code, expected $1: ${*:2}"
      cat complaint
      failed=1
   fi
}

# expect_text FILE TEXT...: each text must stand in the file.
expect_text() {
   local text
   for text in "${@:2}"; do
      if grep -qF -- "$text" "$1"; then
         echo "ok     $1 says: $text"
      else
         echo "FAILED $1 does not say: $text"
         failed=1
      fi
   done
}

finish() {
   exit "$failed"
}
