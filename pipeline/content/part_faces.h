/* The regions of a content folder that are lists of faces: judged before hours of work, and found
 * on the imported scan when it is published. */
#ifndef GOPURA_PIPELINE_CONTENT_PART_FACES_H
#define GOPURA_PIPELINE_CONTENT_PART_FACES_H

#include "pipeline/content/content.h"
#include "pipeline/content/info_build.h"

/* One part's, on the mesh. */
struct part_faces {
	char *id;            /* owned */
	uint32_t *triangles; /* ascending; owned */
	uint32_t count;
};

struct part_faces_all {
	const struct content *content; /* borrowed */
	bool only_judge;               /* by the scans' headers; nothing is imported */
	bool has_mesh;
	struct mesh mesh;         /* once a list, or somebody else, needed it; owned */
	struct part_faces *parts; /* owned */
	uint32_t part_count;
};

/* Finished by the caller; zeroed but for content it is ready for use. */
void part_faces_finish(struct part_faces_all *all);
/* The scans as one mesh, imported at most once. *fault as content_import. */
must_check int part_faces_mesh(struct part_faces_all *all, struct fault *fault);

/* As info_place_faces; data is a struct part_faces_all. */
int part_faces_place(void *data, struct info_faces *faces, struct fault *fault);
/* NULL: the part's region is no list of faces. */
const struct part_faces *part_faces_find(const struct part_faces_all *all, const char *id);

#endif
