/* Answers to saves that failed. */
#ifndef GOPURA_CURATOR_PAGES_SAVE_ANSWER_H
#define GOPURA_CURATOR_PAGES_SAVE_ANSWER_H

#include "base/diagnostics.h"
#include "curator/api/http_api.h"

/* {"message": SENTENCE, "problems": [...]} with the status of api_fail_with. */
void save_answer_fail(struct api_response *response, int rc, const struct diagnostics *problems);

#endif
