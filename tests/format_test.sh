#!/usr/bin/env bash
# Fails where a source file is not formatted as .clang-format says. Exit status 77: skipped, since
# clang-format is missing or is of another release, which formats otherwise.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
release=14
command -v clang-format >/dev/null || { echo 'clang-format is not installed'; exit 77; }
version=$(clang-format --version | grep -oE '[0-9]+' | head -1)
((version == release)) || { echo "clang-format is $version, not $release"; exit 77; }
find common formats preprocess viewer assets tests examples \( -name '*.cpp' -o -name '*.h' \) -print0 |
  xargs -0 clang-format --dry-run --Werror
