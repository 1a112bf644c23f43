#!/usr/bin/env bash
# Requests a second of the service and of nginx for the same bytes, one after the other on the same machine, and the ratio.
# Usage: tests/load/against_nginx.sh SERVER [TABLE]   (ROUNDS=9 SECONDS_EACH=4 CONNECTIONS=32 THREADS=1: of wrk)
# wrk takes more processor time for an answer than either server does. With one thread of it on two processors, the servers have time to
# spare, and what is measured is mostly wrk; with THREADS=2 processors are scarce, and the cheaper server wins.
set -euo pipefail
source "$(dirname "$0")/serving.sh"
server=$(realpath "$1")
table=${2:-ggx-isotropic}
seconds=${SECONDS_EACH:-4}
rounds=${ROUNDS:-5}
folder=$(mktemp -d)
trap 'kill "${pids[@]}" 2>/dev/null || true; wait 2>/dev/null || true; rm -rf "$folder"' EXIT
pids=()

serve "$server" "$folder" LTC_LOG=warn
pids+=("$pid")
digest=$(curl -fsS "$url/v1/tables/$table" | python3 -c 'import json, sys; print(json.load(sys.stdin)["digest"])')
ours=$url/v1/tables/$table/versions/$digest/data

mkdir -p "$folder/www"
curl -fsS "$ours" -o "$folder/www/table.npz"
port=$(python3 -c 'import socket; s = socket.socket(); s.bind(("127.0.0.1", 0)); print(s.getsockname()[1])')
cat >"$folder/nginx.conf" <<CONF
worker_processes auto;
pid $folder/nginx.pid;
error_log stderr warn;
daemon off;
events { worker_connections 1024; }
http {
    access_log off;
    sendfile on;
    tcp_nopush on;
    keepalive_requests 1000000000;
    client_body_temp_path $folder/1; proxy_temp_path $folder/2; fastcgi_temp_path $folder/3; uwsgi_temp_path $folder/4; scgi_temp_path $folder/5;
    server { listen 127.0.0.1:$port; root $folder/www; add_header Cache-Control "public, max-age=31536000, immutable"; }
}
CONF
# Its master may start as root; its workers must read the folder.
chmod 755 "$folder" "$folder/www"
nginx -c "$folder/nginx.conf" -p "$folder" &
pids+=($!)
theirs=http://127.0.0.1:$port/table.npz
until curl -fsS "$theirs" -o "$folder/again" 2>/dev/null; do sleep 0.1; done
cmp "$folder/www/table.npz" "$folder/again"
tag() { curl -fsSI "$1" | tr -d '\r' | sed -n 's/^[Ee][Tt][Aa][Gg]: //p'; }
echo "$table: $(stat -c %s "$folder/www/table.npz") bytes; load average $(cut -d' ' -f1-3 /proc/loadavg)"

# Processor time that a server and its children have used so far, in hundredths of a second.
used() { cat /proc/"$1"/stat $(pgrep -P "$1" | sed 's|.*|/proc/&/stat|') | awk '{ sub(/.*\) /, ""); t += $12 + $13 } END { print t }'; }
# Requests a second, and microseconds of processor time for each: of the server, and of it and wrk together. These hardly depend on who else
# is busy, and on a machine that has nothing to spare the second decides how many requests there are.
TIMEFORMAT='%U %S'
measure() {
    local pid=$1 before after
    shift
    before=$(used "$pid")
    { time wrk -t"${THREADS:-1}" -c"${CONNECTIONS:-32}" -d"${seconds}s" "$@" >"$folder/wrk"; } 2>"$folder/time"
    after=$(used "$pid")
    awk -v ticks=$((after - before)) 'NR == FNR { wrk = $1 + $2; next } /requests in/ { n = $1 }
        /^Requests\/sec/ { print $2, ticks * 10000 / n, ticks * 10000 / n + wrk * 1e6 / n }' "$folder/time" "$folder/wrk"
}
news() { measure "$1" -H "If-None-Match: $(tag "$2")" "$2"; }
for round in $(seq "$rounds"); do
    # In turns, and every other round the other way round: who comes second has no advantage.
    if ((round % 2)); then
        a=$(measure "${pids[0]}" "$ours"); b=$(measure "${pids[1]}" "$theirs")
        c=$(news "${pids[0]}" "$ours"); d=$(news "${pids[1]}" "$theirs")
    else
        b=$(measure "${pids[1]}" "$theirs"); a=$(measure "${pids[0]}" "$ours")
        d=$(news "${pids[1]}" "$theirs"); c=$(news "${pids[0]}" "$ours")
    fi
    echo "$round $a $b $c $d" >>"$folder/rounds"
    python3 - "$round" $a $b $c $d <<'PY'
import sys
a, at, _, b, bt, _, c, ct, _, d, dt, _ = map(float, sys.argv[2:])
print(f"round {sys.argv[1]}: 200 {a:.0f}/s ({at:.1f} us), nginx {b:.0f}/s ({bt:.1f} us), ratio {a / b:.2f}; "
      f"304 {c:.0f}/s ({ct:.1f} us), nginx {d:.0f}/s ({dt:.1f} us), ratio {c / d:.2f}", flush=True)
PY
done
python3 - "$folder/rounds" <<'PY'
import statistics, sys
rows = [[float(word) for word in line.split()[1:]] for line in open(sys.argv[1], encoding="ascii")]
for name, i in ("200", 0), ("304", 6):
    for what, at in ("requests a second", 0), ("processor time of the server", 1), ("processor time of both ends", 2):
        ratios = [row[i + at] / row[i + 3 + at] for row in rows]
        print(f"{name}, {what}: ratio {statistics.median(ratios):.2f} (median of {len(ratios)}; {min(ratios):.2f} to {max(ratios):.2f})")
PY
echo "load average $(cut -d' ' -f1-3 /proc/loadavg)"
