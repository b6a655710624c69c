#!/bin/sh
# Says in one sentence what is missing or too old, and what to do about it.
python=${1:-python3}

fail() {
    echo "breakaway: $1" >&2
    exit 1
}

command -v "$python" >/dev/null 2>&1 ||
    fail "Python is missing; install Python 3.11 or newer (https://www.python.org/downloads), or name one: make PYTHON=/path/to/python3"
"$python" -c 'import sys; sys.exit(sys.version_info < (3, 11))' ||
    fail "$("$python" --version 2>&1) is too old; install Python 3.11 or newer (https://www.python.org/downloads), or name one: make PYTHON=/path/to/python3"
"$python" -c 'import ensurepip, venv' 2>/dev/null ||
    fail "Python's venv module is missing; on Debian or Ubuntu install it with: sudo apt-get install python3-venv"
command -v cargo >/dev/null 2>&1 ||
    fail "Rust is missing; install Rust 1.85 or newer (https://rustup.rs)"
rust=$(rustc --version 2>/dev/null | cut -d' ' -f2)
major=${rust%%.*}
minor=${rust#*.}
minor=${minor%%.*}
if [ "${major:-0}" -lt 1 ] || { [ "$major" -eq 1 ] && [ "${minor:-0}" -lt 85 ]; }; then
    fail "Rust ${rust:-of unknown version} is too old; get 1.85 or newer with: rustup update stable"
fi
