/* What saves have in common: the version that one began from, and the answer if it failed. */
#ifndef GOPURA_CURATOR_PAGES_SAVE_ANSWER_H
#define GOPURA_CURATOR_PAGES_SAVE_ANSWER_H

#include "base/diagnostics.h"
#include "curator/api/http_api.h"
#include "curator/store/documents.h"

/* Reads If-Match: "TAG" into base, or If-None-Match: * as "". -EINVAL: there is neither, and the
 * response says so. */
must_check int save_base_read(const struct api_request *request, struct api_response *response,
			      char base[DOCUMENT_TAG_BYTES]);

/* {"message": SENTENCE, "problems": [...]} with the status of api_fail_with. */
void save_answer_fail(struct api_response *response, int rc, const struct diagnostics *problems);

#endif
