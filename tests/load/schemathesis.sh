#!/usr/bin/env bash
# schemathesis over the service's own description, with a real token and real names and digests: no 5xx, nothing undocumented.
# Usage: tests/load/schemathesis.sh SERVER [EXAMPLES]   (SCHEMATHESIS=/path/to/schemathesis)
set -euo pipefail
source "$(dirname "$0")/serving.sh"
server=$(realpath "$1")
examples=${2:-50}
folder=$(mktemp -d)
pid=
trap 'kill $pid 2>/dev/null || true; wait 2>/dev/null || true; rm -rf "$folder"' EXIT
serve "$server" "$folder" LTC_LOG=error LTC_LIMITS_WRITES_PER_SECOND=0 LTC_REFITS_WORKERS=0 LTC_REFITS_QUEUE=100000
digest=$(curl -fsS "$url/v1/tables/ggx-isotropic" | python3 -c 'import json, sys; print(json.load(sys.stdin)["digest"])')
refit=$(curl -fsS "$url/v1/refits" -H "Authorization: Bearer $(cat "$folder/token")" -H 'Content-Type: application/json' \
    -d '{"preset": "disney-diffuse"}' | python3 -c 'import json, sys; print(json.load(sys.stdin)["id"])')
# Real names, or it would see 404 alone: nine in ten come from here.
cat >"$folder/hooks.py" <<HOOKS
import random

import schemathesis

# Not the module's own, which Hypothesis seeds anew for every example.
CHANCE = random.SystemRandom()

REAL = {
    "name": ["ggx-isotropic", "ggx-anisotropic"],
    "version": ["latest", "stable", "1", "2", "$digest"],
    "other": ["latest", "1", "ggx-anisotropic@1", "$digest"],
    "alias": ["stable", "studio"],
    "id": ["$refit"],
    "slug": ["malformed", "internal"],
    "lang": ["wgsl", "glsl", "glsl-es", "hlsl", "msl", "spirv"],
}
# Numbers as parameters of a query: without them no lookup would come to an answer.
QUERY = {
    "theta": {"lookup": ["0.5", "0"], "data": ["0..0.5"]},
    "alpha_x": {"lookup": ["0.3"]}, "alpha_y": {"lookup": ["0.3"]},
    "alpha": {"data": ["0.1..0.5"]}, "phi": {"lookup": ["1"]}, "lambda": {}, "channels": {"data": ["m", "m,magnitude,fresnel"]},
    "lights": {"shader": ["quad", "quad,line", "sphere"]}, "features": {"shader": ["isotropic", "anisotropic,fresnel"]},
}


@schemathesis.hook
def map_query(context, query):
    if not query or CHANCE.random() < 0.5:
        return query
    kind = "lookup" if "alpha_x" in query else "shader" if "lights" in query else "data"
    for name in list(query):
        if name in QUERY:
            values = QUERY[name].get(kind)
            if values:
                query[name] = CHANCE.choice(values)
            else:
                del query[name]
    return query


@schemathesis.hook
def map_path_parameters(context, path_parameters):
    for name in path_parameters or {}:
        if CHANCE.random() < 0.9 and name in REAL:
            path_parameters[name] = CHANCE.choice(REAL[name])
    return path_parameters
HOOKS
cd "$folder"
SCHEMATHESIS_HOOKS=hooks PYTHONPATH=$folder "${SCHEMATHESIS:-schemathesis}" run "$url/openapi.json" \
    --header "Authorization: Bearer $(cat "$folder/token")" \
    --checks not_a_server_error,status_code_conformance,content_type_conformance,response_schema_conformance \
    --exclude-operation-id refit_events \
    --max-examples "$examples" --request-timeout 30 --no-color
kill -0 "$pid"
# What was reached: a run that sees nothing but refusals proves nothing.
curl -fsS "$url/metrics" | sed -n 's/^ltc_http_requests_total//p'
