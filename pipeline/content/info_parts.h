/* Reads parts.json into the draft. Private to pipeline/content. */
#ifndef GOPURA_PIPELINE_CONTENT_INFO_PARTS_H
#define GOPURA_PIPELINE_CONTENT_INFO_PARTS_H

#include "pipeline/content/draft.h"

/* Reads parts.json. Like the other readers, it returns 0 even after faults, which it reports; a
 * negative errno means that reading cannot go on. */
must_check int draft_read_parts(struct draft *draft);
/* Returns whether id may name a part or a tour. */
bool draft_is_id(const char *id);

#endif
