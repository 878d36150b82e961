/* Extensions are looked for in the text: their names have no escapes, and nothing is built from
 * what the file says but the message. */
#include "pipeline/import/gltf_check.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "base/json_tree.h"
#include "pipeline/import/json.h"

enum { GLB_HEAD_BYTES = 20, NAME_BYTES = 64, FLOAT = 5126 };

/* Extensions that change neither places nor the base colour, and one that is read. */
static const char *const harmless[] = { "KHR_materials_", "KHR_lights_punctual", "KHR_xmp",
					"KHR_texture_transform" };

static const struct {
	const char *extension, *what, *command;
} cures[] = {
	{ "KHR_draco_mesh_compression", "its meshes are compressed with Draco", "copy" },
	{ "EXT_meshopt_compression", "its meshes are compressed with meshoptimizer", "dequantize" },
	{ "KHR_mesh_quantization", "its places are quantised", "dequantize" },
	{ "EXT_texture_webp", "its pictures are WebP", "png --formats webp" },
	{ "KHR_texture_basisu", "its pictures are KTX2", "ktxdecompress" },
};

/* The JSON of a GLB is its first chunk. */
static struct bytes json_of(struct bytes file)
{
	uint32_t size;

	if (file.size < GLB_HEAD_BYTES || memcmp(file.data, "glTF", 4) != 0)
		return file;
	size = (uint32_t)file.data[12] | (uint32_t)file.data[13] << 8 |
	       (uint32_t)file.data[14] << 16 | (uint32_t)file.data[15] << 24;
	file.data += GLB_HEAD_BYTES;
	file.size -= GLB_HEAD_BYTES;
	if (size < file.size)
		file.size = size;
	return file;
}

/* Moves *text behind the next occurrence of what. Returns false if there is none. */
static bool skip_past(struct bytes *text, const char *what)
{
	const uint8_t *found = memmem(text->data, text->size, what, strlen(what));

	if (!found)
		return false;
	found += strlen(what);
	text->size -= (size_t)(found - text->data);
	text->data = found;
	return true;
}

/* Reads the next name of the list. Returns false at its end, or where it is none. */
static bool next_name(struct bytes *list, char name[NAME_BYTES])
{
	size_t length = 0;

	while (list->size > 0 && *list->data != '"' && *list->data != ']') {
		list->data++;
		list->size--;
	}
	if (list->size == 0 || *list->data == ']')
		return false;
	list->data++;
	list->size--;
	while (length < list->size && list->data[length] != '"')
		length++;
	if (length == list->size || length >= NAME_BYTES)
		return false;
	memcpy(name, list->data, length);
	name[length] = '\0';
	for (size_t i = 0; i < length; i++) /* it goes into a message */
		if (name[i] < ' ' || name[i] > '~')
			name[i] = '?';
	list->data += length + 1;
	list->size -= length + 1;
	return true;
}

static int judge(const char *name, const char *path, struct diagnostics *diagnostics)
{
	for (size_t i = 0; i < ARRAY_COUNT(harmless); i++)
		if (strncmp(name, harmless[i], strlen(harmless[i])) == 0)
			return 0;
	for (size_t i = 0; i < ARRAY_COUNT(cures); i++)
		if (strcmp(name, cures[i].extension) == 0)
			return diagnostics_add(diagnostics, -ENOTSUP, path, 0,
					       "%s (%s), which is not read here; convert it: npx "
					       "@gltf-transform/cli %s IN.glb OUT.glb",
					       cures[i].what, name, cures[i].command);
	return diagnostics_add(diagnostics, -ENOTSUP, path, 0,
			       "it requires the extension %s, which is not read here; export it "
			       "without",
			       name);
}

int gltf_check_extensions(struct bytes file, const char *path, struct diagnostics *diagnostics)
{
	struct bytes text = json_of(file);
	char name[NAME_BYTES];
	int rc = 0;

	if (!skip_past(&text, "\"extensionsRequired\"") || !skip_past(&text, "["))
		return 0;
	while (rc == 0 && next_name(&text, name))
		rc = judge(name, path, diagnostics);
	return rc;
}

/* ---- texture coordinates */

/* Returns for each accessor whether its numbers are floats; NULL: no memory. */
static bool *list_floats(const cJSON *accessors, int count)
{
	bool *floats = calloc((size_t)count + 1, sizeof(*floats));
	const cJSON *accessor;
	int i = 0;

	cJSON_ArrayForEach(accessor, accessors)
	{
		const cJSON *type = json_member(accessor, "componentType");

		if (floats && i < count)
			floats[i++] = cJSON_IsNumber(type) && type->valuedouble == FLOAT;
	}
	return floats;
}

static bool names_integers(const cJSON *attributes, const bool *floats, int count)
{
	const cJSON *attribute;

	cJSON_ArrayForEach(attribute, attributes)
	{
		if (strncmp(attribute->string ? attribute->string : "", "TEXCOORD_", 9) == 0 &&
		    cJSON_IsNumber(attribute) && attribute->valuedouble >= 0 &&
		    attribute->valuedouble < count && !floats[(int)attribute->valuedouble])
			return true;
	}
	return false;
}

static bool has_integers(const cJSON *json, const bool *floats, int count)
{
	const cJSON *mesh, *primitive;

	cJSON_ArrayForEach(mesh, json_member(json, "meshes"))
	{
		cJSON_ArrayForEach(primitive, json_member(mesh, "primitives"))
		{
			if (names_integers(json_member(primitive, "attributes"), floats, count))
				return true;
		}
	}
	return false;
}

int gltf_check_coordinates(struct bytes file, const char *path, struct diagnostics *diagnostics)
{
	const struct bytes text = json_of(file);
	cJSON *json;
	const int parsed = json_parse(&json, text);
	const cJSON *accessors = json_member(json, "accessors");
	const int count = cJSON_IsArray(accessors) ? cJSON_GetArraySize(accessors) : 0;
	bool *floats = list_floats(accessors, count);
	int rc = floats && parsed != -ENOMEM ? 0 : -ENOMEM;

	if (rc == 0 && has_integers(json, floats, count))
		rc = diagnostics_add(diagnostics, -ENOTSUP, path, 0,
				     "its texture coordinates are quantised, which is not read "
				     "here; convert it: npx @gltf-transform/cli dequantize IN.glb "
				     "OUT.glb");
	free(floats);
	cJSON_Delete(json);
	return rc;
}
