/* Parses the text of a VRML97 file into nodes. Private to pipeline/scene. */
#ifndef GOPURA_PIPELINE_SCENE_VRML_PARSER_H
#define GOPURA_PIPELINE_SCENE_VRML_PARSER_H

#include "pipeline/scene/vrml_scope.h"

/* Parses a whole file: its nodes and prototypes become the source's. Errors as vrml_read. */
must_check int vrml_parse_source(struct vrml_parser *parser, struct vrml_source *source);

#endif
