/* What the next release would change, and what gopura-content would say to the content. */
#ifndef GOPURA_CURATOR_PUBLISH_CHANGES_H
#define GOPURA_CURATOR_PUBLISH_CHANGES_H

#include "base/diagnostics.h"

struct cJSON;

/* Compares a content folder with the current release of a release folder. *out is owned by the
 * caller (cJSON_Delete); NULL on failure:
 *
 *   errors, warnings   sentences, as gopura-content says them
 *   release            the current one's number; 0: nothing was published yet
 *   model              "same", or "new" where the scans or their settings have changed since the
 *                      hierarchy was made, so that a build takes long
 *   undescribed        [{"file", "line", "picture"}]: pictures without an alternative text
 *
 * and, if there are no errors, what info_difference adds; bytes, how much terminals would fetch for
 * the texts and pictures; and content, a name for all that would be published but the model. Takes
 * seconds, and where a list of faces or the way of a tour is new the memory of the scans. Negative
 * errno, with a diagnostic. */
must_check int changes_find(struct cJSON **out, const char *folder, const char *release,
			    struct diagnostics *diagnostics);

#endif
