/* Reads the credits of a part into the draft. Private to pipeline/content. */
#ifndef GOPURA_PIPELINE_CONTENT_INFO_CREDITS_H
#define GOPURA_PIPELINE_CONTENT_INFO_CREDITS_H

#include "pipeline/content/draft.h"

/* Adds the credits of a part: `json` is the part's own "credits", and `all` those stated for all
 * parts, used for elements that json lacks. Either may be NULL. Reports faults with the part's
 * line. -ENOMEM. */
must_check int draft_read_credits(struct draft *draft, struct draft_part *part,
				  const struct cJSON *json, const struct cJSON *all);

#endif
