#!/usr/bin/env bash
# The commands of docs/tutorial.md, as a script on stdout: what stands between ```bash and ```.
set -euo pipefail
awk '/^```bash$/ { on = 1; next } /^```$/ { on = 0 } on' "$(dirname "${BASH_SOURCE[0]}")/../docs/tutorial.md"
