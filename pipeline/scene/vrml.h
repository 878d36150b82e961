/* Reads VRML97 (ISO/IEC 14772-1) into a graph of nodes: DEF and USE share nodes, prototypes are put
 * in place, Inline files are read. Script is refused. docs/scene.md has what is read. */
#ifndef GOPURA_PIPELINE_SCENE_VRML_H
#define GOPURA_PIPELINE_SCENE_VRML_H

#include "base/arena.h"
#include "base/bytes.h"
#include "base/diagnostics.h"
#include "pipeline/scene/vrml_types.h"

struct vrml_node;

/* The value of a field, as its type says. Numbers of vectors and colours follow one another. */
struct vrml_value {
	uint32_t count;          /* items of the array that is set; for floats: numbers */
	const int32_t *integers; /* integers, booleans, images */
	const float *floats;     /* finite */
	const char *const *strings;
	struct vrml_node *const *nodes; /* none is NULL */
};

/* A node may be reached on several ways (USE), but never from itself. All is owned by the scene. */
struct vrml_node {
	const struct vrml_node_type *type;
	const char *file; /* where it stands */
	unsigned line;
	const char *name;                                 /* of DEF; NULL: none */
	const struct vrml_value *values[VRML_FIELDS_MAX]; /* NULL: not given */
	/* of an Inline: the nodes of its file */
	struct vrml_node *const *children;
	uint32_t child_count;
};

/* ROUTE from.out TO to.in: what happens at one node is told to another. */
struct vrml_route {
	const struct vrml_route *before; /* in the order of the files, from the last one */
	struct vrml_node *const *from, *const *to; /* what they point to is not NULL */
	const char *out, *in;                      /* the names of events */
	const char *file;
	unsigned line;
};

struct vrml {
	struct arena arena; /* holds all the others */
	const char *path;   /* of its file; nodes of files that it names have another in `file` */
	struct vrml_node *const *roots;
	uint32_t root_count;
	const struct vrml_route *routes; /* the last one; NULL: none */
	uint32_t route_count;
};

struct vrml_options {
	/* Opens a file that the scene names. Returns a descriptor, owned by the caller, or a
	 * negative errno. NULL: the scene may name no files. */
	int (*open_file)(void *data, const char *name);
	void *data;
};

/* Reads the text of a scene, gzip'd or not. path is for messages. *out is owned by the caller; NULL
 * on failure. Returns a negative errno with a diagnostic: -EBADMSG: not valid; -ENOTSUP: Script;
 * -EFBIG: past a limit. What is left out is a diagnostic in warnings. */
must_check int vrml_read(struct vrml **out, struct bytes text, const char *path,
			 const struct vrml_options *options, struct diagnostics *diagnostics,
			 struct diagnostics *warnings);
void vrml_destroy(struct vrml *scene); /* NULL is fine */

enum { VRML_NAME_BYTES = 256 }; /* of a file in the scene's folder, with its folders */

/* Opens what a node names: beside the file that it stands in; else as it is named, in the scene's
 * folder, where open_file may look for what other machines called "C:\\...". name becomes what
 * open_file was asked for last; "" if that is longer. Returns its descriptor, or a negative errno.
 */
must_check int vrml_open(const struct vrml *scene, const struct vrml_node *node, const char *url,
			 const struct vrml_options *options, char name[VRML_NAME_BYTES]);

/* Returns the value of a field that the node's type has; NULL: it was not given. */
const struct vrml_value *vrml_get(const struct vrml_node *node, const char *field);
/* The same for single values, with their defaults. */
const struct vrml_node *vrml_get_node(const struct vrml_node *node, const char *field);
int32_t vrml_get_integer(const struct vrml_node *node, const char *field, int32_t otherwise);
float vrml_get_float(const struct vrml_node *node, const char *field, float otherwise);
/* Copies `count` numbers to out. */
void vrml_get_floats(float *out, const struct vrml_node *node, const char *field, uint32_t count,
		     const float *otherwise);

#endif
