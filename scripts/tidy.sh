#!/usr/bin/env bash
# scripts/tidy.sh [file …]   clang-tidy 14 over the given sources, or over all of the two tools and the format
set -euo pipefail
cd "$(dirname "$0")/.."

[[ -f build/dev/compile_commands.json ]] || cmake --preset dev >/dev/null
if (($#)); then files=("$@"); else mapfile -t files < <(git ls-files 'format/*.cpp' 'preprocessor/*.cpp' 'solver/*.cpp'); fi
printf '%s\0' "${files[@]}" |
  xargs -0 -n 1 -P "$(nproc)" clang-tidy-14 -p build/dev --quiet --warnings-as-errors='*'
