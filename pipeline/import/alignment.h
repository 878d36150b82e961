/* Reads which scans belong together and where each of them lies: MeshLab's alignments (.aln, text)
 * and projects (.mlp, XML), Stanford's registrations (.conf, text) and IIIF manifests (.json).
 * docs/import.md has the formats. */
#ifndef GOPURA_PIPELINE_IMPORT_ALIGNMENT_H
#define GOPURA_PIPELINE_IMPORT_ALIGNMENT_H

#include "base/diagnostics.h"
#include "pipeline/import/mesh.h"
#include "pipeline/import/transform.h"

enum { ALIGNMENT_SCANS_MAX = MESH_SCANS_MAX };

struct alignment_scan {
	char *path; /* the folder of the alignment and the scan's name in it; owned */
	struct transform transform;
	unsigned line; /* of the alignment, where the scan is named */
};

struct alignment {
	uint32_t count, room;
	struct alignment_scan *scans; /* owned */
	bool y_is_up; /* as in a manifest; otherwise the file does not say which axis is up */
	struct diagnostics left_out; /* warnings: what of a manifest is not imported */
};

/* Returns whether the name ends with .aln, .mlp, .conf or .json, in any case of letters. */
bool alignment_is_named(const char *name);

/* Reads the file and checks that every scan it names is a file in its folder or below. *out is
 * owned by the caller; it is zeroed on failure. A negative errno; diagnostics has what is wrong
 * with its line and cure, each missing scan by itself. */
must_check int alignment_read(struct alignment *out, const char *path,
			      struct diagnostics *diagnostics);
void alignment_finish(struct alignment *alignment); /* NULL and zeroed are fine */

#endif
