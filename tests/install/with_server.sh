#!/bin/bash
# with_server.sh LPVD FOLDER PROGRAM: runs PROGRAM with the address of an lpvd of its own.
set -u
"$1" --listen 127.0.0.1:0 --port-file "$2/port" --log-level error &
server=$!
trap 'kill "$server"; wait "$server"' EXIT
for _ in $(seq 600); do
  [ -s "$2/port" ] && break
  sleep 0.1
done
"$3" "127.0.0.1:$(cat "$2/port")"
