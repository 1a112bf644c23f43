# A service of one's own, for the shell scripts in this folder. To be sourced; the caller stops $pid and deletes its folder.

# serve PROGRAM FOLDER [NAME=VALUE …]: starts it on a fresh store in FOLDER; sets $pid and $url, and writes a token to FOLDER/token.
serve() {
    local program=$1 folder=$2
    shift 2
    local command=("$program")
    if [ "$(basename "$program")" = ltc ]; then
        # The example makes a token by itself.
        command+=(serve)
        "$program" token create --data "$folder/data" --scope refit,publish,benchmark >"$folder/token" 2>"$folder/token.log" ||
            { cat "$folder/token.log" >&2; return 1; }
    fi
    env LTC_LISTEN=127.0.0.1:0 LTC_DATA="$folder/data" TOKEN_FILE="$folder/token" "$@" "${command[@]}" >"$folder/url" &
    pid=$!
    until url=$(grep -o -m 1 'http://[^ ]*' "$folder/url"); do
        kill -0 "$pid" 2>/dev/null || { echo "$program ended before it served" >&2; return 1; }
        sleep 0.1
    done
}
