#!/bin/bash
# Shards on a shared folder make the release of a single machine, byte for byte: also when one was killed and
# begun again, one runs twice, and one does nothing at all (docs/cluster.md).
set -eu
cd "$(dirname "$0")/../.."
. tests/e2e/lib.sh
. tests/e2e/lib-content.sh
command -v parallel >/dev/null || skip "GNU parallel is not installed"
python3 -c 'import yaml' 2>/dev/null || skip "python3-yaml is not installed"
content=$PWD/build/gopura-content
folder=$PWD/build/e2e/cluster
shared="$folder/the king's temple" # the starters below hand the name to a shell
rm -rf "$folder"
mkdir -p "$folder"
export PARALLEL_HOME=$folder/parallel
mkdir -p "$PARALLEL_HOME"
: >"$PARALLEL_HOME/will-cite" # otherwise it asks to be cited in articles

# kill_when PID PATTERN: kills a shard as soon as such a file is there. Sampling begins after the index of the master.
kill_when() {
	until compgen -G "$2" >/dev/null; do
		kill -0 "$1" 2>/dev/null || fail "the shard ended before it was killed"
		sleep 0.01
	done
	kill -9 "$1" || fail "the shard ended before it was killed"
	wait "$1" 2>/dev/null || true
}

tiny_content "$folder/alone" 60000 5000
touch -d '2026-01-01' "$folder"/alone/*
cp -rp "$folder/alone" "$shared"
cp -rp "$folder/alone" "$folder/geometry"
"$content" build "$folder/alone" --out "$folder/release-alone" --keys "$folder/keys" >/dev/null
cp -r "$folder/keys" "$folder/keys-shared"

# ---- the hierarchy alone: a shard that is killed while it works, then all, one of them twice
master=$folder/geometry/.work/master
"$content" hierarchy --jobs 1 --shard 1/4 "$folder/geometry" >"$folder/killed" 2>&1 &
kill_when $! "$master/blocks-*/node-*"
[ ! -e "$master/index" ] || fail "the shard was done before it was killed"
parallel -j 5 "$content" hierarchy --jobs 1 --shard {}/4 "$folder/geometry" ::: 0 1 2 3 2 >"$folder/log" 2>&1 ||
	{ cat "$folder/log"; fail "a shard of the hierarchy"; }
diff -r "$folder/alone/.work/master" "$master" || fail "shards made another master"
"$content" hierarchy "$folder/geometry" | grep -q 'nothing changed' || fail "the shards did not complete the master"

# ---- the whole, as a person begins it; of the shards that ran before, one was killed and one finished
"$content" sample --jobs 1 --shard 0/4 "$shared" >"$folder/killed" 2>&1 &
kill_when $! "$shared/.work/master/index"
"$content" sample --jobs 1 --shard 2/4 "$shared" >"$folder/log" 2>&1 || { cat "$folder/log"; fail "shard 2"; }
mv "$folder/keys-shared" "$folder/config-keys"
XDG_CONFIG_HOME=$folder/config
mkdir -p "$XDG_CONFIG_HOME/gopura/keys"
mv "$folder/config-keys" "$XDG_CONFIG_HOME/gopura/keys/$(basename "$shared")"
CONTENT=$content cluster/parallel.sh "$shared" "$folder/release-shared" 4 -j 3 >"$folder/log" 2>&1 ||
	{ cat "$folder/log"; fail "cluster/parallel.sh"; }
same_release "$folder/release-alone" "$folder/release-shared" || fail "shards made another release"

# ---- what runs elsewhere is at least well-formed, and its numbers agree
cat >"$folder/sbatch" <<'SH'
#!/bin/sh
for job; do :; done # the last argument
SLURM_ARRAY_TASK_ID=3 sh -c "$job" >>"$(dirname "$0")/jobs" && echo 1
SH
printf '#!/bin/sh\nprintf "<%%s>" "$@"\n' >"$folder/told's"
chmod +x "$folder/sbatch" "$folder/told's"
PATH=$folder:$PATH CONTENT="$folder/told's" cluster/slurm.sh "$shared" "$folder/re'lease" 8 2 >/dev/null
grep -qxF "<sample><--jobs><2><--shard><3/8><$shared><build><--jobs><2><$shared><--out><$folder/re'lease>" "$folder/jobs" ||
	{ cat "$folder/jobs"; fail "the jobs of cluster/slurm.sh"; }
python3 - <<'PY' || fail "cluster/job.yaml"
import re, yaml
job = yaml.safe_load(open("cluster/job.yaml"))["spec"]
assert job["completionMode"] == "Indexed"
command = job["template"]["spec"]["containers"][0]["command"]
assert int(re.search(r'\$JOB_COMPLETION_INDEX/(\d+)"', command[2])[1]) == job["completions"]
PY
echo "killed, doubled, left out: $(find "$folder/release-shared" -type f | wc -l) files are the single machine's"
