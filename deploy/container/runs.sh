# shellcheck shell=bash
# Sourced by test: runs the image. WORK, STORAGE, ROOT and complaint() are its own.

readonly SERVED_SECONDS=120 # how long a run may take to serve
CONTAINER= # a container of the image
IMAGE=     # its root
RUN= PROXY=  # what runs now
PIDS=()    # the same, in the order of its start

# A container whose root is read-only, but for where an engine puts its own mounts.
prepare_runs() {
  local folder
  CONTAINER=$(in_storage buildah from --pull-never localhost/lpvd)
  IMAGE=$(in_storage buildah mount "$CONTAINER")
  # Where an image has a volume and a run mounts something there, buildah takes either; an engine takes what is mounted.
  in_storage buildah config --volume /var/lib/lpvd- "$CONTAINER"
  for folder in "$IMAGE"/*; do
    case ${folder##*/} in run | tmp | dev | proc | sys) continue ;; esac
    [ -d "$folder" ] && [ ! -L "$folder" ] || continue
    mount --bind "$folder" "$folder"
    mount -o remount,bind,ro "$folder"
  done
  mkdir -m 1777 "$WORK/tmp"
  mkdir "$WORK/client"
  printf 'v -1 0 -1\nv 1 0 -1\nv 1 0 1\nv -1 0 1\nf 4 3 2 1\n' >"$WORK/client/floor.obj"
  printf 'v -.2 1 -.2\nv .2 1 -.2\nv .2 1 .2\nv -.2 1 .2\nf 1 2 3 4\n' >"$WORK/client/lamp.obj"
  chown -R 10001:10001 "$WORK/client"
}

# What a promise started ends with it, kept or not: each runs in a shell of its own.
beside() {
  PIDS+=("$1")
  trap end_beside EXIT
}

end_beside() {
  local pid
  for pid in "${PIDS[@]}"; do kill "$pid" 2>/dev/null || true; done
  wait 2>/dev/null || true
}

unmount_runs() {
  local folder
  [ -n "$IMAGE" ] || return 0
  for folder in "$IMAGE"/*; do ! mountpoint -q "$folder" || umount "$folder" || umount -l "$folder"; done
}

# --- a server ---------------------------------------------------------------------------------------------------------

# start NAME [BUILDAH_OPTION...]: the image's entry point with its state in WORK/NAME, on free ports of every address.
start() {
  local name=$1
  shift
  mkdir -p "$WORK/$name"
  rm -f "$WORK/$name"/{port,ops,web}
  chown 10001:10001 "$WORK/$name"
  chmod 700 "$WORK/$name"
  # Not through in_storage: a shell between would get the signals.
  buildah --storage-driver vfs --root "$STORAGE/root" --runroot "$STORAGE/run" run --isolation chroot \
    -v "$WORK/$name:/var/lib/lpvd" -v "$WORK/tmp:/tmp" -e LPVD_LISTEN=0.0.0.0:0 -e LPVD_OPS_LISTEN=0.0.0.0:0 \
    -e LPVD_WEB=0.0.0.0:0 "$@" "$CONTAINER" -- /usr/bin/lpvd-container --port-file /var/lib/lpvd/port \
    --ops-port-file /var/lib/lpvd/ops --web-port-file /var/lib/lpvd/web \
    >"$WORK/$name.log" 2>&1 &
  RUN=$!
  beside "$RUN"
  wait_until "$SERVED_SECONDS" serves_or_ended "$name" && [ -s "$WORK/$name/port" ] ||
    complaint "it does not serve: $(cat "$WORK/$name.log")"
}

serves_or_ended() { [ -s "$WORK/$1/port" ] || ! kill -0 "$RUN" 2>/dev/null; }

# process_of NAME: the server's, which the first line of its lock names.
process_of() { head -n 1 "$WORK/$1/sessions/lock"; }

# parent_of NAME: what started the server.
parent_of() { tr '\0' ' ' <"/proc/$(awk '$1 == "PPid:" { print $2 }' "/proc/$(process_of "$1")/status")/cmdline"; }

# stop NAME: SIGTERM to the server, as an engine does; it must drain and end with 0.
stop() {
  local status=0
  kill -TERM "$(process_of "$1")" || complaint "it cannot be told to end" || return
  wait "$RUN" || status=$?
  cat "$WORK/$1.log"
  [ "$status" -eq 0 ] || complaint "it ended with $status" || return
  grep -q 'draining' "$WORK/$1.log" || complaint "it did not drain"
}

# wait_until SECONDS COMMAND...: until the command succeeds.
wait_until() {
  local deadline=$((SECONDS + $1))
  shift
  until "$@"; do
    [ "$SECONDS" -lt "$deadline" ] || return 1
    sleep 0.2
  done
}

# client SERVER AUTHORITY TOKEN ARGUMENT...: the image's lpvctl in another container, with copies of both files.
client() {
  local server=$1
  cp "$2" "$WORK/client/authority.pem"
  cp "$3" "$WORK/client/token"
  chown 10001 "$WORK/client/authority.pem" "$WORK/client/token"
  shift 3
  in_storage buildah run --isolation chroot -v "$WORK/client:/mnt" -e XDG_STATE_HOME=/mnt "$CONTAINER" -- lpvctl \
    --server "$server" --ca /mnt/authority.pem --token-file /mnt/token "$@"
}

# health NAME: the image's health check, as an engine runs it.
health() {
  in_storage buildah run --isolation chroot -v "$WORK/$1:/var/lib/lpvd" "${@:2}" -e "LPV_SERVER=localhost:$(cat "$WORK/$1/port")" \
    "$CONTAINER" -- /usr/bin/lpvd-container health
}

# frame SERVER AUTHORITY TOKEN: makes a lit scene and a picture of it.
frame() {
  local session
  rm -f "$WORK/client/frame.png"
  session=$(client "$@" session create --grid 16 | tr -d '\r') || return
  client "$@" scene load "$session" /mnt/floor.obj || return
  client "$@" light add "$session" /mnt/lamp.obj --name lamp --radiance 8,6,3 || return
  client "$@" frame get "$session" -o /mnt/frame.png --size 64x48 --eye 0,2,3 --target 0,0,0 || return
  [ "$(head -c 4 "$WORK/client/frame.png" | tail -c 3)" = PNG ] || complaint "no picture" || return
  echo "$session" >"$WORK/session"
}

# --- what is promised -------------------------------------------------------------------------------------------------

run_with_own_secrets() {
  local secrets=$WORK/own/secrets server arguments
  start own || return
  server=localhost:$(cat "$WORK/own/port")
  grep -q '/var/lib/lpvd/secrets/server.pem' "$WORK/own.log" || complaint "it does not say where its certificate is" || return
  grep -q '/var/lib/lpvd/secrets/admin.token' "$WORK/own.log" || complaint "it does not say where its token is" || return
  [ "$(stat -c %a "$secrets/admin.token" "$secrets/server.key" | uniq)" = 600 ] || complaint "secrets that others can read" || return
  grep -q 'reads health and metrics, without a token' "$WORK/own.log" || complaint "no warning about the ops port" || return
  arguments=$(tr '\0' ' ' <"/proc/$(process_of own)/cmdline")
  [[ $arguments == lpvd\ * && $arguments != *--insecure* ]] || complaint "it runs as: $arguments" || return
  [[ $(parent_of own) == buildah* ]] || complaint "an engine's signals do not reach it, but $(parent_of own)" || return
  health own || complaint "the health check fails" || return
  shows_page "$(cat "$WORK/own/web")" "$secrets/server.pem" localhost || complaint "browsers do not get the page" || return
  frame "$server" "$secrets/server.pem" "$secrets/admin.token" || return
  echo wrong >"$WORK/wrong.token"
  if client "$server" "$secrets/server.pem" "$WORK/wrong.token" session list; then complaint "any token will do" || return; fi
  if in_storage buildah run --isolation chroot "$CONTAINER" -- lpvctl --server "$server" --timeout 5 health; then
    complaint "it answers without TLS" || return
  fi
  stop own
}

# The same state again: the same secrets, and the session that was acknowledged.
run_again() {
  local before secrets=$WORK/own/secrets
  before=$(sha256sum "$secrets"/*)
  start own || return
  [ "$(sha256sum "$secrets"/*)" = "$before" ] || complaint "its secrets changed" || return
  client "localhost:$(cat "$WORK/own/port")" "$secrets/server.pem" "$secrets/admin.token" light list "$(cat "$WORK/session")" |
    grep lamp || complaint "the session is gone" || return
  stop own
}

run_with_mounted_secrets() {
  mkdir "$WORK/mounted" && "$ROOT/deploy/container/make-secrets" "$WORK/secrets" || return
  [ "$(stat -c %a "$WORK"/secrets/{*.key,admin.token,proxy.pem} | sort -u)" = 600 ] || complaint "secrets that others can read" || return
  cp -p "$WORK"/secrets/{server.pem,server.key,admin.token} "$WORK/mounted" && cp "$WORK/secrets/authority.pem" "$WORK/mounted"
  chmod 644 "$WORK/mounted/authority.pem"
  start given -v "$WORK/mounted:/etc/lpvd:ro" || return
  [ ! -e "$WORK/given/secrets/server.pem" ] && [ ! -e "$WORK/given/secrets/admin.token" ] || complaint "it made its own" || return
  openssl s_client -connect "localhost:$(cat "$WORK/given/port")" -CAfile "$WORK/secrets/authority.pem" -verify_hostname lpvd \
    -verify_return_error -alpn h2 </dev/null || complaint "it does not show the mounted certificate" || return
  stop given || return
  mkdir "$WORK/half" && cp -p "$WORK/secrets/server.pem" "$WORK/half"
  if start broken -v "$WORK/half:/etc/lpvd:ro" >/dev/null; then complaint "half a pair was taken" || return; fi
  grep 'belong together' "$WORK/broken.log"
}

# free_port: one that nobody listens on now.
free_port() {
  local port
  while true; do
    port=$((20000 + RANDOM % 20000))
    (: <"/dev/tcp/127.0.0.1/$port") 2>/dev/null || break
  done
  echo "$port"
}

# page PORT PATH: what plain HTTP answers.
page() {
  exec 3<>"/dev/tcp/127.0.0.1/$1" || return
  printf 'GET %s HTTP/1.0\r\nHost: localhost\r\n\r\n' "$2" >&3
  cat <&3
  exec 3>&-
}

# shows_page PORT AUTHORITY NAME: whether a browser that trusts the authority gets the page there, by its published name.
# What openssl says at its end does not count: lpvd ends the connection without TLS's close_notify, after as many bytes as
# the answer has said. Where the certificate is not trusted there is no answer.
shows_page() {
  local answer
  answer=$(printf 'GET / HTTP/1.1\r\nHost: localhost:8443\r\nConnection: close\r\n\r\n' |
    openssl s_client -quiet -connect "localhost:$1" -CAfile "$2" -verify_hostname "$3" -verify_return_error -ign_eof 2>/dev/null) || true
  grep -qi '^content-security-policy:' <<<"$answer"
}

sees_it() { page "$1" '/api/v1/query?query=up%7Bjob%3D%22lpvd%22%7D' 2>/dev/null | grep -q '"value":\[[0-9.]*,"1"\]'; }
knows_alerts() { page "$1" /api/v1/rules 2>/dev/null | grep -q '"name":"LpvdDown"'; }

# proxy AUTHORITY PORT: HAProxy before the run "given".
proxy() {
  LPV_PROXY_BIND="127.0.0.1:$2" LPV_PROXY_CERT="$WORK/secrets/proxy.pem" LPV_BACKEND="127.0.0.1:$(cat "$WORK/given/port")" \
    LPV_BACKEND_WEB="127.0.0.1:$(cat "$WORK/given/web")" LPV_BACKEND_NAME=lpvd LPV_BACKEND_CA="$1" \
    LPV_OPS_PORT="$(cat "$WORK/given/ops")" \
    haproxy -W -f "$ROOT/deploy/proxy/haproxy.cfg" >"$WORK/proxy.log" 2>&1 &
  PROXY=$!
  beside "$PROXY"
}

behind_the_proxy() {
  local port other watcher watching
  start given -v "$WORK/mounted:/etc/lpvd:ro" || return
  port=$(free_port)
  proxy "$WORK/secrets/authority.pem" "$port"
  wait_until 20 through_proxy "$port" health || complaint "nothing comes through the proxy: $(cat "$WORK/proxy.log")" || return
  frame "localhost:$port" "$WORK/secrets/authority.pem" "$WORK/secrets/admin.token" || return
  shows_page "$port" "$WORK/secrets/authority.pem" localhost || complaint "browsers do not get the page through the proxy" || return
  kill "$PROXY" && wait "$PROXY" || true
  # The proxy must not talk to a server that another authority vouches for.
  "$ROOT/deploy/container/make-secrets" "$WORK/others" || return
  other=$(free_port)
  proxy "$WORK/others/authority.pem" "$other"
  sleep 3
  if through_proxy "$other" --timeout 5 health; then complaint "the proxy verifies nothing" || return; fi
  kill "$PROXY" && wait "$PROXY" || true

  watcher=$(free_port)
  cp -r "$ROOT/deploy/dashboards" "$WORK/dashboards"
  printf -- '- targets: ["127.0.0.1:%s"]\n' "$(cat "$WORK/given/ops")" >"$WORK/dashboards/targets.yml"
  prometheus --config.file="$WORK/dashboards/prometheus.yml" --storage.tsdb.path="$WORK/metrics" \
    --web.listen-address="127.0.0.1:$watcher" >"$WORK/prometheus.log" 2>&1 &
  watching=$!
  beside "$watching"
  wait_until 60 sees_it "$watcher" || complaint "Prometheus does not see it: $(tail -n 5 "$WORK/prometheus.log")" || return
  knows_alerts "$watcher" || complaint "Prometheus has no alerts" || return
  kill "$watching" && wait "$watching" || true
  stop given
}

through_proxy() { client "localhost:$1" "$WORK/secrets/authority.pem" "$WORK/secrets/admin.token" "${@:2}"; }
