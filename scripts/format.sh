#!/usr/bin/env bash
# scripts/format.sh          formats all C++ files in place (clang-format 14)
# scripts/format.sh --check  changes nothing and fails where a file is not formatted
set -euo pipefail
cd "$(dirname "$0")/.."

mode=(-i)
[[ "${1:-}" == --check ]] && mode=(--dry-run --Werror)
git ls-files -z --cached --others --exclude-standard -- '*.hpp' '*.cpp' | xargs -0 --no-run-if-empty clang-format-14 "${mode[@]}"
