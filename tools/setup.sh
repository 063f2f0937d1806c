#!/bin/sh
# Make the virtual environment with the pinned dependencies and this project in it.
set -eu
: "${PYTHON:=python3}" "${VENV:=.venv}"

if ! "$PYTHON" -c 'import sys; sys.exit(not (3, 11) <= sys.version_info[:2] <= (3, 13))'; then
    echo "mutabot needs Python 3.11, 3.12 or 3.13; $PYTHON is $("$PYTHON" --version 2>&1). Set PYTHON=python3.x" >&2
    exit 1
fi
if ! "$PYTHON" -c 'import ensurepip, venv' 2>/dev/null; then
    # Debian and Ubuntu keep venv in a package of its own.
    version=$("$PYTHON" -c 'import sys; print("%d.%d" % sys.version_info[:2])')
    echo "installing python$version-venv"
    sudo=""; [ "$(id -u)" -eq 0 ] || sudo=sudo
    $sudo apt-get update -q && $sudo apt-get install -y -q "python$version-venv"
fi
"$PYTHON" -m venv "$VENV"
# The lock names all that is needed. Asked to look for more, pip may find a newer version of what an extra needs
# (coverage[toml] of pytest-cov) before the pinned one, for which there is no hash.
"$VENV/bin/python" -m pip install --quiet --disable-pip-version-check --no-deps --require-hashes --only-binary :all: \
    -r requirements.lock
"$VENV/bin/python" -m pip install --quiet --disable-pip-version-check --no-deps --no-build-isolation -e .
# Workers never write bytecode, so let them find ours.
"$VENV/bin/python" -m compileall -q src
echo "ready: $VENV"
