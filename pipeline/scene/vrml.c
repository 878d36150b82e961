/* Reads a scene, and gives the values of its nodes. */
#include "pipeline/scene/vrml.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/scene/vrml_files.h"
#include "pipeline/scene/vrml_parser.h"

int vrml_read(struct vrml **out, struct bytes text, const char *path,
	      const struct vrml_options *options, struct diagnostics *diagnostics,
	      struct diagnostics *warnings)
{
	struct vrml_parser parser = { .options = options,
				      .diagnostics = diagnostics,
				      .warnings = warnings };
	struct vrml_source *source;
	int rc;

	*out = NULL;
	parser.scene = calloc(1, sizeof(*parser.scene));
	if (!parser.scene)
		return -ENOMEM;
	parser.scene->arena.ceiling_bytes = VRML_MEMORY_BYTES_MAX;
	source = vrml_add_source(&parser, path);
	parser.scene->path = source ? source->path : NULL;
	rc = source ? vrml_source_text(&parser, source, text) : -ENOMEM;
	if (rc == 0)
		rc = vrml_parse_source(&parser, source);
	if (rc == 0) {
		parser.scene->roots = source->roots;
		parser.scene->root_count = source->root_count;
		*out = parser.scene;
	}
	for (uint32_t i = 0; i < parser.source_count; i++)
		buffer_finish(&parser.sources[i]->text);
	if (rc < 0)
		vrml_destroy(parser.scene);
	return rc;
}

void vrml_destroy(struct vrml *scene)
{
	if (!scene)
		return;
	arena_finish(&scene->arena);
	free(scene);
}

/* ---- fields */

const struct vrml_value *vrml_get(const struct vrml_node *node, const char *field)
{
	int i = vrml_field_named(node->type, field, strlen(field));

	return i < 0 ? NULL : node->values[i];
}

const struct vrml_node *vrml_get_node(const struct vrml_node *node, const char *field)
{
	const struct vrml_value *value = vrml_get(node, field);

	return value && value->count > 0 ? value->nodes[0] : NULL;
}

int32_t vrml_get_integer(const struct vrml_node *node, const char *field, int32_t otherwise)
{
	const struct vrml_value *value = vrml_get(node, field);

	return value && value->count > 0 ? value->integers[0] : otherwise;
}

float vrml_get_float(const struct vrml_node *node, const char *field, float otherwise)
{
	vrml_get_floats(&otherwise, node, field, 1, &otherwise);
	return otherwise;
}

void vrml_get_floats(float *out, const struct vrml_node *node, const char *field, uint32_t count,
		     const float *otherwise)
{
	const struct vrml_value *value = vrml_get(node, field);
	const float *from = value && value->count >= count ? value->floats : otherwise;

	for (uint32_t i = 0; i < count; i++)
		out[i] = from[i];
}
