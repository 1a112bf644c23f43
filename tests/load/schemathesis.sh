#!/usr/bin/env bash
# schemathesis over the service's own description, with a real token and real names and digests: no 5xx, nothing undocumented.
# Usage: tests/load/schemathesis.sh SERVER [EXAMPLES]   (SCHEMATHESIS=/path/to/schemathesis)
set -euo pipefail
server=$(realpath "$1")
examples=${2:-50}
folder=$(mktemp -d)
trap 'kill "$pid" 2>/dev/null || true; wait 2>/dev/null || true; rm -rf "$folder"' EXIT
LTC_LISTEN=127.0.0.1:0 LTC_DATA=$folder/data LTC_LOG=error LTC_LIMITS_WRITES_PER_SECOND=0 LTC_REFITS_WORKERS=0 LTC_REFITS_QUEUE=100000 \
    TOKEN_FILE=$folder/token "$server" >"$folder/url" &
pid=$!
until [ -s "$folder/url" ]; do sleep 0.1; done
url=$(cat "$folder/url")
digest=$(curl -fsS "$url/v1/tables/ggx-isotropic" | python3 -c 'import json, sys; print(json.load(sys.stdin)["digest"])')
refit=$(curl -fsS "$url/v1/refits" -H "Authorization: Bearer $(cat "$folder/token")" -H 'Content-Type: application/json' \
    -d '{"preset": "disney-diffuse"}' | python3 -c 'import json, sys; print(json.load(sys.stdin)["id"])')
# Real names, or it would see 404 alone: a third of the values come from here.
cat >"$folder/hooks.py" <<HOOKS
import random

import schemathesis

REAL = {
    "name": ["ggx-isotropic", "ggx-anisotropic"],
    "version": ["latest", "stable", "1", "2", "$digest"],
    "other": ["latest", "1", "ggx-anisotropic@1", "$digest"],
    "alias": ["stable", "studio"],
    "id": ["$refit"],
    "slug": ["malformed", "internal"],
    "theta": ["0..0.5"], "alpha": ["0.1..0.5"], "precision": ["f32", "f16"],
}


@schemathesis.hook
def map_path_parameters(context, path_parameters):
    for name in path_parameters or {}:
        if random.random() < 0.7 and name in REAL:
            path_parameters[name] = random.choice(REAL[name])
    return path_parameters
HOOKS
cd "$folder"
SCHEMATHESIS_HOOKS=hooks PYTHONPATH=$folder "${SCHEMATHESIS:-schemathesis}" run "$url/openapi.json" \
    --header "Authorization: Bearer $(cat "$folder/token")" \
    --checks not_a_server_error,status_code_conformance,content_type_conformance,response_schema_conformance \
    --exclude-operation-id refit_events \
    --max-examples "$examples" --request-timeout 30 --no-color
kill -0 "$pid"
