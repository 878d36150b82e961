/* The node types of VRML97 (ISO/IEC 14772-1, clause 6, and NURBS of amendment 1) and their fields,
 * as one table. */
#ifndef GOPURA_PIPELINE_SCENE_VRML_TYPES_H
#define GOPURA_PIPELINE_SCENE_VRML_TYPES_H

#include <stddef.h>
#include <stdint.h>

enum { VRML_FIELDS_MAX = 24 };

enum vrml_base { VRML_INTEGERS, VRML_FLOATS, VRML_STRINGS, VRML_NODES, VRML_BOOLS, VRML_IMAGE };

/* The type of a field: what one item consists of, and whether it is a list of items. */
struct vrml_type {
	const char *name; /* "SFVec3f" */
	enum vrml_base base;
	uint8_t width; /* numbers in an item */
	uint8_t is_list;
};

struct vrml_field_type {
	const char *name; /* NULL: the list of fields ends */
	const struct vrml_type *type;
};

/* Fields and exposed fields; the names of events are in neither. */
struct vrml_node_type {
	const char *name;
	struct vrml_field_type fields[VRML_FIELDS_MAX];
};

/* Finds a type by its name, which is not terminated. NULL: there is none. */
const struct vrml_type *vrml_type_named(const char *name, size_t length);
const struct vrml_node_type *vrml_node_type_named(const char *name, size_t length);
/* Returns the number of a field in the type's list, or -1. */
int vrml_field_named(const struct vrml_node_type *type, const char *name, size_t length);

#endif
