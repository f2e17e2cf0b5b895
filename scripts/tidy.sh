#!/usr/bin/env bash
# scripts/tidy.sh [file …]   clang-tidy 14 over the given sources, or over all of the two tools and the format
set -euo pipefail
cd "$(dirname "$0")/.."

# A folder of its own: clang cannot read the headers that g++ has compiled beforehand.
cmake --preset dev -B build/tidy -DCMAKE_DISABLE_PRECOMPILE_HEADERS=ON -DIGA_BUILD_TESTS=OFF -DIGA_WERROR=OFF >/dev/null
if (($#)); then files=("$@"); else mapfile -t files < <(git ls-files 'format/*.cpp' 'preprocessor/*.cpp' 'solver/*.cpp'); fi
printf '%s\0' "${files[@]}" |
  xargs -0 -n 1 -P "$(nproc)" clang-tidy-14 -p build/tidy --quiet --warnings-as-errors='*'
