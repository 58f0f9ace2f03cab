# SPDX-License-Identifier: Apache-2.0
# shellcheck shell=bash disable=SC2034  # variables for the commands that source this
#
# What the commands of this directory share. Each of them starts with its help, which -h and --help print, and
#
#     set -euo pipefail
#     source "$(dirname "${BASH_SOURCE[0]}")/common.bash"
#
# which switches to the root of the workspace.

shopt -s inherit_errexit nullglob

workspace=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
cd "$workspace" || exit

usage() { sed -n '4,/^$/s/^# \{0,1\}//p' "scripts/${0##*/}"; }
case "${1:-}" in -h | --help) usage && exit ;; esac

# What these commands make is below out/. Packages that are built or installed there are not those of the workspace.
mkdir -p out && touch out/COLCON_IGNORE

venv=$workspace/.venv

# Debian's ament, colcon and pluginlib belong to Debian's own python3, whatever `python3` is first on PATH.
system_python=/usr/bin/python3

# The same in all builds, so that ccache knows what another one has compiled. -g1 is enough for stack traces; variables
# (-g) would double the time of compiling templates.
optimisation="-O2 -g1 -DNDEBUG"
# GCC collects its garbage less often: 5 % less time, 100 MB more memory.
if "${CXX:-c++}" --version 2>&1 | grep -q "Free Software"; then optimisation+=" --param=ggc-min-heapsize=400000"; fi

# Engine, interface and solvers; and what is built on them without ROS 2.
solver_packages=(
  chain_dynamics inverse_dynamics_robots inverse_dynamics_solver
  rigid_body_inverse_dynamics_solver ur10_inverse_dynamics_solver
  franka_inria_inverse_dynamics_solver kdl_inverse_dynamics_solver
  pinocchio_inverse_dynamics_solver
)
user_packages=(
  inverse_dynamics_evaluation inverse_dynamics_control
  inverse_dynamics_identification inverse_dynamics_timing inverse_dynamics_tools
)

# Debian and Ubuntu packages, in groups.
apt_packages=(
  # Fetching, compiling (make: a plain `colcon build` of a user's workspace), checking.
  ca-certificates git g++ cmake make ninja-build ccache shellcheck
  # Python and its virtual environment.
  python3 python3-dev python3-venv
  # The colcon command and the extensions that the builds here need.
  colcon python3-colcon-bash python3-colcon-cmake python3-colcon-defaults
  python3-colcon-library-path python3-colcon-metadata python3-colcon-output
  python3-colcon-package-information python3-colcon-package-selection
  python3-colcon-parallel-executor python3-colcon-pkg-config python3-colcon-recursive-crawl
  python3-colcon-ros
  # ament and plugins.
  ament-cmake ament-cmake-googletest ament-cmake-pytest ament-cmake-python
  libament-index-cpp-dev python3-ament-index libclass-loader-dev pluginlib-dev
  # Mathematics, robot descriptions, data files, tests.
  libeigen3-dev libgtest-dev liborocos-kdl-dev libtinyxml2-dev libyaml-cpp-dev
  # Recordings.
  liblz4-dev libsqlite3-dev libzstd-dev
  # How fast this machine is: ids bench.
  libbenchmark-dev
  # Tests of the report's page: in a browser, and on paper.
  chromium chromium-driver poppler-utils
)

say() { printf '==> %s\n' "$*"; }
note() { printf '    %s\n' "$*"; }
fail() {
  printf 'error: %s\n' "$1" >&2
  shift
  [ $# -eq 0 ] || printf '       %s\n' "$@" >&2
  exit 1
}

# 75 -> "1 min 15 s"
duration() {
  if [ "$1" -ge 60 ]; then echo "$(($1 / 60)) min $(($1 % 60)) s"; else echo "$1 s"; fi
}

# Runs the virtual environment's Python first, and forgets workspaces that the shell had sourced
# (a sourced ROS 2 stays: it then provides ament and pluginlib).
enter_venv() {
  export VIRTUAL_ENV=$venv PATH=$venv/bin:$PATH
  unset PYTHONHOME
  if [ -z "${ROS_DISTRO:-}" ]; then
    unset AMENT_PREFIX_PATH CMAKE_PREFIX_PATH COLCON_PREFIX_PATH PYTHONPATH
  fi
}

# install_python DIRECTORY LIST PIP_ARGUMENT...
#
# Installs Python packages into a virtual environment, and makes that if there is none. Does nothing if the file LIST,
# which names the packages, and Python are those of the last time.
install_python() {
  [ -d "$1" ] || "$system_python" -m venv "$1"
  local stamp=$1/requirements.sha256 wanted
  wanted=$({ "$1/bin/python" --version; cat "$2"; } | sha256sum)
  if [ -f "$stamp" ] && [ "$(cat "$stamp")" = "$wanted" ]; then
    say "Python packages: those of $2 are installed"
    return
  fi
  say "Python packages: installing those of $2 into ${1#"$workspace"/} with pip"
  "$1/bin/python" -m pip install --quiet --disable-pip-version-check "${@:3}"
  echo "$wanted" >"$stamp"
}

# Recordings of real robots are not part of the repository: IDS_DATA_DIR names them, or is unset.
find_recordings() {
  [ -n "${IDS_DATA_DIR:-}" ] || return 0
  [ -d "$IDS_DATA_DIR" ] || fail "IDS_DATA_DIR names no directory: $IDS_DATA_DIR" "correct or unset it"
  IDS_DATA_DIR=$(cd "$IDS_DATA_DIR" && pwd)
  export IDS_DATA_DIR
}

# fetch_recordings [ARGUMENT...] fetches those of real robots with `ids data`, unless IDS_DATA_DIR names others, and
# says from where, or why it can't.
fetch_recordings() {
  local told last status=0
  [ -z "${IDS_DATA_DIR:-}" ] || return 0
  told=$(timeout 20 ids data "$@" 2>&1 >/dev/null) || status=$?
  last=${told##*$'\n'}
  case $status in
    0) say "${told%%$'\n'*}" ;;
    124) say "No recordings of real robots: no answer within 20 s" ;;
    *) last=${last##*error: } && say "No recordings of real robots: ${last%%;*}" ;;
  esac
}

# Sources what was built: libraries, plugins, the Python package and the `ids` command.
enter_install() {
  enter_venv
  [ -f install/local_setup.bash ] || fail "nothing is built yet" "run ./scripts/build first"
  source_workspace .
}

# Sources what colcon has built in a directory; its script reads variables that nobody has set.
source_workspace() {
  set +u
  # shellcheck source=/dev/null
  source "$1/install/local_setup.bash"
  set -u
}

# What every build of the workspace needs: the virtual environment, Ninja and ccache where they are
# installed, and `cmake_arguments`.
prepare_build() {
  enter_venv
  [ -x "$venv/bin/python" ] || fail "there is no virtual environment .venv" "run ./scripts/setup first"
  # As a variable, not an argument: build directories that a plain `colcon build` made stay usable.
  if command -v ninja >/dev/null; then export CMAKE_GENERATOR=${CMAKE_GENERATOR:-Ninja}; fi
  cmake_arguments=(
    --no-warn-unused-cli # a package of data alone uses none of these
    -DCMAKE_BUILD_TYPE=RelWithDebInfo
    "-DCMAKE_CXX_FLAGS_RELWITHDEBINFO=$optimisation"
    -DCMAKE_INSTALL_MESSAGE=NEVER
    -DPython3_EXECUTABLE="$venv/bin/python"
    -DPYTHON_EXECUTABLE="$venv/bin/python"
  )
  # Five sources at a time: most of the time goes into the headers that they share [docs/development.md].
  # The packages that need ROS are compiled source by source.
  if [ -z "${ROS_DISTRO:-}" ]; then
    cmake_arguments+=(-DCMAKE_UNITY_BUILD=ON -DCMAKE_UNITY_BUILD_BATCH_SIZE=5)
  fi
  if command -v ccache >/dev/null; then
    # Another clone finds what this one has compiled, but for sources of a unity build: they name its paths.
    # What a source includes is taken from the compiler's list of it, not by preprocessing the source once more.
    export CCACHE_BASEDIR=$workspace CCACHE_NOHASHDIR=1 CCACHE_DEPEND=1
    cmake_arguments+=(-DCMAKE_C_COMPILER_LAUNCHER=ccache -DCMAKE_CXX_COMPILER_LAUNCHER=ccache)
  fi
}

# build_into DIRECTORY PACKAGE...
#
# Builds packages with `cmake_arguments` below a directory, beside the usual build, without their
# tests, and makes them known to this shell.
build_into() {
  local out=$1
  shift
  colcon --log-base "$out/log" build --build-base "$out/build" --install-base "$out/install" \
    --packages-select "$@" --cmake-args "${cmake_arguments[@]}" -DBUILD_TESTING=OFF
  source_workspace "$out"
}

# test_in DIRECTORY PROGRAMS PACKAGE...
#
# Builds and runs the GoogleTest programs, of packages that build_into has built, whose names match
# the regular expression PROGRAMS; fails if one fails, and counts them.
test_in() {
  local out=$1 programs=$2 package build targets status=0
  shift 2
  find_recordings
  rm -rf "$out"/build/*/test_results
  for package in "$@"; do
    build=$out/build/$package
    cmake "$build" -DBUILD_TESTING=ON >/dev/null || return
    mapfile -t targets < <(ctest --test-dir "$build" -N -L '^g(test|mock)$' -R "$programs" |
      sed -n 's/^ *Test .*: //p')
    [ ${#targets[@]} -gt 0 ] || continue
    say "$package: ${targets[*]}"
    cmake --build "$build" --target "${targets[@]}" || return
    ctest --test-dir "$build" --output-on-failure -L '^g(test|mock)$' -R "$programs" || status=1
  done
  "$system_python" scripts/count_tests.py "$out/build" || status=1
  return $status
}
