/* Reads tours.json into the draft. Private to pipeline/content. */
#ifndef GOPURA_PIPELINE_CONTENT_INFO_TOURS_H
#define GOPURA_PIPELINE_CONTENT_INFO_TOURS_H

#include "pipeline/content/draft.h"

/* Reads tours.json. Call it after draft_read_parts, because stops may name parts. */
must_check int draft_read_tours(struct draft *draft);
/* Computes and checks the views of stops that name a part. Call it when all parts have a place. */
void draft_place_stops(struct draft *draft);

#endif
