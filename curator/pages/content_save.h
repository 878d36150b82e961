/* Saves documents if 'gopura-content build' would take them: the same readers judge the folder as
 * it would be. Faults that were there before stand in nobody's way. */
#ifndef GOPURA_CURATOR_PAGES_CONTENT_SAVE_H
#define GOPURA_CURATOR_PAGES_CONTENT_SAVE_H

#include "curator/session/site.h"
#include "pipeline/content/info_build.h"

struct cJSON;

enum { CONTENT_PROBLEMS_MAX = 1000 };

/* Lists what a build would say, faults and warnings, with texts instead of files. Lists of faces,
 * the pixels of pictures and the samples of sound are not looked at. Negative errno: it cannot be
 * found out; faults are no error. *out is for diagnostics_finish. */
must_check int content_check(const struct site *site, const struct info_text_instead *instead,
			     uint32_t count, struct diagnostics *out);

/* Makes changes as documents_save does, unless they bring new faults into the folder: -EINVAL, and
 * *problems has them all. Other errors have one diagnostic there. */
must_check int content_save(struct site *site, struct document_change *changes, uint32_t count,
			    const char *author, const char *what, struct diagnostics *problems);

/* Returns a list of {"file", "line", "text", "error"} for a page in the browser; file "": all. The
 * caller owns it; NULL: no memory is left. */
struct cJSON *content_problems(const struct diagnostics *problems, const char *file);

#endif
