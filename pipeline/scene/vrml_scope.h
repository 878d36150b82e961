/* What the parser of VRML97 works on: files, names, prototypes, tokens. Private to pipeline/scene.
 */
#ifndef GOPURA_PIPELINE_SCENE_VRML_SCOPE_H
#define GOPURA_PIPELINE_SCENE_VRML_SCOPE_H

#include <stdbool.h>

#include "base/map.h"
#include "pipeline/scene/vrml.h"
#include "pipeline/scene/vrml_lexer.h"

enum { VRML_FILES_MAX = 64 };

#define VRML_MEMORY_BYTES_MAX (1ull << 30)

/* A file of the scene. */
struct vrml_source {
	char *path;
	struct buffer text;
	bool is_parsed;
	bool is_open;              /* it is being parsed now */
	struct vrml_proto *protos; /* the last one that it declares */
	struct vrml_node *const *roots;
	uint32_t root_count;
};

struct vrml_binding {
	const char *name;
	const struct vrml_type *type;
	const struct vrml_value *value; /* NULL: an event */
};

struct vrml_proto {
	struct vrml_proto *before; /* declared before it */
	const char *name;
	struct vrml_source *source;
	struct vrml_lexer body;        /* after its { */
	const struct vrml_value *urls; /* of an EXTERNPROTO; NULL: it has a body */
	struct vrml_binding *bindings;
	uint32_t binding_count;
};

struct vrml_definition {
	struct vrml_definition *before; /* of the same hash */
	const char *name;
	struct vrml_node *node; /* NULL: it is being parsed */
};

/* Names are known within a file, or within the body of a prototype. */
struct vrml_scope {
	struct vrml_source *source;
	struct vrml_lexer lexer;
	struct map definitions;
	struct vrml_proto *protos;
	const struct vrml_binding *bindings;
	uint32_t binding_count;
};

struct vrml_parser {
	const struct vrml_options *options;
	struct diagnostics *diagnostics, *warnings;
	struct vrml *scene;
	struct vrml_scope *scope;
	struct vrml_source *sources[VRML_FILES_MAX]; /* owned */
	uint32_t source_count, depth, node_count;
	uint64_t reread_bytes;
};

/* A list that grows while it is read. */
struct vrml_list {
	void *items;
	uint32_t count, room;
};

/* Adds a diagnostic for a line of the file that is being parsed, and returns rc. */
#define VRML_FAIL(parser, rc, at, ...)                                                             \
	diagnostics_add((parser)->diagnostics, rc, (parser)->scope->source->path, at, __VA_ARGS__)

/* All return a negative errno with a diagnostic on failure. */
must_check int vrml_fail_memory(struct vrml_parser *parser); /* -EFBIG */
/* -EBADMSG: another token stands where `wanted` should. */
must_check int vrml_fail_token(struct vrml_parser *parser, const struct vrml_token *token,
			       const char *wanted);
/* How many bytes of a token a message shows. */
int vrml_shown(const struct vrml_token *token);

struct vrml_token vrml_take_any(struct vrml_parser *parser);
struct vrml_token vrml_peek(struct vrml_parser *parser);
/* Takes the next token if it is this word or mark. */
bool vrml_take(struct vrml_parser *parser, const char *text);
/* The same, but anything else is an error. */
must_check int vrml_expect(struct vrml_parser *parser, const char *mark);
/* *out is the scene's. */
must_check int vrml_take_name(struct vrml_parser *parser, const char **out, const char *wanted);

/* Reads one number of a type: int32_t, or float if its base is VRML_FLOATS. */
must_check int vrml_read_number(struct vrml_parser *parser, const struct vrml_type *type,
				void *out);
must_check int vrml_read_bool(struct vrml_parser *parser, int32_t *out);
/* *out is the scene's. */
must_check int vrml_read_string(struct vrml_parser *parser, const char **out);

/* Appends an item; all items of a list have the same size. The owner frees list->items. */
must_check int vrml_push(struct vrml_parser *parser, struct vrml_list *list, const void *item,
			 size_t bytes);
/* Moves the items into the scene's memory; count stays. NULL: no memory. */
void *vrml_settle(struct vrml_parser *parser, struct vrml_list *list, size_t bytes);

/* NULL: no node is called so. */
struct vrml_definition *vrml_find_definition(const struct vrml_scope *scope, const char *name);
/* name is the scene's. The node of *out is still to be set. */
must_check int vrml_define(struct vrml_parser *parser, const char *name,
			   struct vrml_definition **out);

#endif
