/* The regions of a content folder that are lists of faces. They are checked before hours of work
 * begin, and found on the imported scan when it is published. */
#ifndef GOPURA_PIPELINE_CONTENT_PART_FACES_H
#define GOPURA_PIPELINE_CONTENT_PART_FACES_H

#include "pipeline/content/content.h"
#include "pipeline/content/info_build.h"

/* The faces of one part, on the mesh. */
struct part_faces {
	char *id;            /* owned */
	uint32_t *triangles; /* ascending; owned */
	uint32_t count;
};

struct part_faces_all {
	const struct content *content; /* borrowed */
	bool only_judge;               /* check by the scans' headers only; nothing is imported */
	bool has_mesh;
	struct mesh mesh;         /* imported once it is needed; owned */
	struct part_faces *parts; /* owned */
	uint32_t part_count;
};

/* Frees everything. A struct that is zeroed except for content is ready for use. */
void part_faces_finish(struct part_faces_all *all);
/* Imports the scans as one mesh, at most once, into all->mesh. Errors and fault as for
 * content_import. */
must_check int part_faces_mesh(struct part_faces_all *all, struct fault *fault);

/* Checks and places a list of faces, as info_place_faces; data is a struct part_faces_all. Also
 * -ENOMEM and the errors of content_import. */
int part_faces_place(void *data, struct info_faces *faces, struct fault *fault);
/* Returns the faces of a part, borrowed. NULL: its region is not a list of faces. */
const struct part_faces *part_faces_find(const struct part_faces_all *all, const char *id);

#endif
