#!/bin/bash
# verity.sh ROOT: appends dm-verity's hash tree to a file system, and prints the table for dmsetup, with @ in the place of
# the partition (image/init). Its size must be a multiple of 4096 bytes.
set -eu
root=$1
export PATH=$PATH:/usr/sbin:/sbin
bytes=$(stat -c %s "$root")
salt=676f70757261 # constant, so that the same root gives the same bytes; it need not be secret
hash=$(veritysetup format --no-superblock --hash=sha256 --data-block-size=4096 --hash-block-size=4096 --salt=$salt \
	--hash-offset="$bytes" "$root" "$root" | sed -n 's/^Root hash:[[:space:]]*//p')
[ ${#hash} = 64 ] || { echo "verity: veritysetup gave no root hash" >&2; exit 1; }
echo "0 $((bytes / 512)) verity 1 @ @ 4096 4096 $((bytes / 4096)) $((bytes / 4096)) sha256 $hash $salt 1 restart_on_corruption"
