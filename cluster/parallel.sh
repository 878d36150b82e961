#!/bin/sh
# Makes a release with GNU parallel: as many processes as this machine has cores, or those of others that
# have DIR at the same path (docs/cluster.md).
#
#   cluster/parallel.sh DIR RELEASE SHARDS [OPTIONS OF PARALLEL, as --sshlogin 4/alpha,8/beta]
set -eu
[ $# -ge 3 ] || { sed -n '2,5s/^# \{0,1\}//p' "$0"; exit 2; }
dir=$(realpath "$1") release=$2 shards=$3
shift 3
content=${CONTENT:-gopura-content}
parallel --quote --retries 3 "$@" "$content" sample --jobs 1 --shard "{}/$shards" "$dir" ::: $(seq 0 $((shards - 1)))
exec "$content" build "$dir" --out "$release"
