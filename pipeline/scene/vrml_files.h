/* The files of a VRML97 scene. Private to pipeline/scene. */
#ifndef GOPURA_PIPELINE_SCENE_VRML_FILES_H
#define GOPURA_PIPELINE_SCENE_VRML_FILES_H

#include "pipeline/scene/vrml_scope.h"

/* Adds a file; its text is still empty, and the parser's. NULL: no memory, or too many. */
struct vrml_source *vrml_add_source(struct vrml_parser *parser, const char *path);
/* Takes the text of its bytes. Errors as vrml_text, with a diagnostic. */
must_check int vrml_source_text(struct vrml_parser *parser, struct vrml_source *source,
				struct bytes file);
/* Finds the first file of the addresses that there is; one that was opened before is found again. A
 * negative errno with a diagnostic for the line: it is missing, damaged, or contains itself. */
must_check int vrml_open_source(struct vrml_parser *parser, struct vrml_source **out,
				const struct vrml_value *urls, unsigned line);

#endif
