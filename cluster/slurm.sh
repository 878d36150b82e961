#!/bin/sh
# Makes a release in a Slurm cluster whose nodes share DIR: an array of shards, and after it the build
# that signs (docs/cluster.md). Variables such as SBATCH_PARTITION and SBATCH_TIMELIMIT choose for all of them.
#
#   cluster/slurm.sh DIR RELEASE SHARDS [CORES OF A SHARD, default 4]
set -eu
[ $# -ge 3 ] || { sed -n '2,5s/^# \{0,1\}//p' "$0"; exit 2; }
# Quotes a name for the shell that runs a job.
quote() { printf %s "$1" | sed "s/'/'\\\\''/g; 1s/^/'/; \$s/\$/'/"; }
dir=$(quote "$(realpath "$1")") release=$(quote "$(realpath -m "$2")") shards=$3 cores=${4:-4}
content=$(quote "${CONTENT:-gopura-content}")
# The array's own count is not used: a shard that is submitted again alone must stay one of so many.
array=$(sbatch --parsable --requeue --job-name=gopura-shard --array="0-$((shards - 1))" --cpus-per-task="$cores" \
	--wrap "exec $content sample --jobs $cores --shard \$SLURM_ARRAY_TASK_ID/$shards $dir")
# afterany: what a lost shard left undone, the build does itself.
build=$(sbatch --parsable --requeue --job-name=gopura-build --dependency="afterany:$array" --cpus-per-task="$cores" \
	--wrap "exec $content build --jobs $cores $dir --out $release")
echo "shards: job $array; build: job $build (squeue shows them, slurm-N.out has what they say)"
