/* Reads the JSON and the buffers of a glTF file, and checks accessors before they are read. */
#include "pipeline/scene/gltf.h"

#include <cjson/cJSON.h>
#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <sodium.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include "base/uri.h"
#include "pipeline/scene/scenery_image.h"

enum {
	GLB_HEAD_BYTES = 12,
	CHUNK_HEAD_BYTES = 8,
	CHUNK_JSON = 0x4e4f534a,
	CHUNK_BIN = 0x004e4942,
	NAME_BYTES = 512,
};

int gltf_say(const struct gltf *gltf, int error, const cJSON *object, const char *text, ...)
{
	char message[500];
	va_list args;

	va_start(args, text);
	vsnprintf(message, sizeof(message), text, args);
	va_end(args);
	return diagnostics_add(gltf->diagnostics, error, gltf->path,
			       object ? json_text_line(&gltf->json, object) : 0, "%s", message);
}

/* ---- lists */

static int list_items(struct gltf *gltf, enum gltf_list list, const char *name)
{
	const cJSON *array = cJSON_GetObjectItemCaseSensitive(gltf->json.root, name), *item;
	const int count = cJSON_IsArray(array) ? cJSON_GetArraySize(array) : 0;

	if (count > GLTF_ITEMS_MAX)
		return gltf_say(gltf, -EFBIG, NULL, "over %d \"%s\"; simplify the scene",
				GLTF_ITEMS_MAX, name);
	gltf->lists[list].items = calloc((size_t)count + 1, sizeof(*gltf->lists[list].items));
	if (!gltf->lists[list].items)
		return -ENOMEM;
	cJSON_ArrayForEach(item, array)
	{
		if (!cJSON_IsObject(item))
			return gltf_say(gltf, -EBADMSG, NULL, "\"%s\" %u is not an object", name,
					gltf->lists[list].count);
		gltf->lists[list].items[gltf->lists[list].count++] = item;
	}
	return 0;
}

static int list_all(struct gltf *gltf)
{
	static const char *const names[GLTF_LISTS] = {
		[GLTF_SCENES] = "scenes",         [GLTF_NODES] = "nodes",
		[GLTF_MESHES] = "meshes",         [GLTF_MATERIALS] = "materials",
		[GLTF_ACCESSORS] = "accessors",   [GLTF_VIEWS] = "bufferViews",
		[GLTF_ANIMATIONS] = "animations", [GLTF_TEXTURES] = "textures",
		[GLTF_IMAGES] = "images",         [GLTF_CAMERAS] = "cameras",
	};
	int rc = 0;

	for (int list = 0; list < GLTF_LISTS && rc == 0; list++)
		rc = list_items(gltf, (enum gltf_list)list, names[list]);
	return rc;
}

/* Reads a number that counts something. Returns false if it is none, or over most. */
static bool get_count(const cJSON *object, const char *field, uint64_t most, uint64_t *out)
{
	const cJSON *item = cJSON_GetObjectItemCaseSensitive(object, field);

	if (!cJSON_IsNumber(item) || !(item->valuedouble >= 0) ||
	    item->valuedouble > (double)most || floor(item->valuedouble) != item->valuedouble)
		return false;
	*out = (uint64_t)item->valuedouble;
	return true;
}

const cJSON *gltf_item(const struct gltf *gltf, enum gltf_list list, const cJSON *object,
		       const char *field, uint32_t *number)
{
	uint64_t at;

	if (!get_count(object, field, UINT32_MAX, &at) || at >= gltf->lists[list].count)
		return NULL;
	if (number)
		*number = (uint32_t)at;
	return gltf->lists[list].items[at];
}

/* ---- buffers */

static int decode_base64(struct buffer *out, const char *text)
{
	const size_t size = strlen(text), room = size / 4 * 3 + 3;
	uint8_t *bytes = malloc(room);
	size_t count = 0;
	int rc = bytes ? 0 : -ENOMEM;

	if (rc == 0 && sodium_base642bin(bytes, room, text, size, NULL, &count, NULL,
					 sodium_base64_VARIANT_ORIGINAL) != 0)
		rc = -EBADMSG;
	if (rc == 0)
		buffer_put(out, bytes, count);
	free(bytes);
	return rc < 0 ? rc : out->error;
}

static int read_buffer(struct gltf *gltf, struct buffer *out, const cJSON *json,
		       const struct gltf_options *options)
{
	const char *uri = cJSON_GetStringValue(cJSON_GetObjectItemCaseSensitive(json, "uri"));
	const char *data = uri && strncmp(uri, "data:", 5) == 0 ? strstr(uri, ";base64,") : NULL;
	char name[NAME_BYTES] = "";
	int fd, rc;

	if (data) {
		rc = decode_base64(out, data + strlen(";base64,"));
		return rc == -EBADMSG ? gltf_say(gltf, rc, json,
						 "a buffer is not valid base64; export it anew")
				      : rc;
	}
	if (!uri || !uri_decode(name, sizeof(name), uri))
		return gltf_say(gltf, -EBADMSG, json,
				"a buffer has no \"uri\" and no chunk of a GLB; export it anew");
	fd = options->open_file ? options->open_file(options->data, name) : -ENOENT;
	if (fd < 0)
		return gltf_say(gltf, fd, json,
				"the buffer %.200s cannot be opened: %s; put it beside the file",
				name, strerror(-fd));
	rc = buffer_read_fd(out, fd);
	if (rc < 0)
		return gltf_say(gltf, rc, json, "the buffer %.200s cannot be read: %s", name,
				rc == -EFBIG ? "too large; simplify the scene" : strerror(-rc));
	return 0;
}

static int read_buffers(struct gltf *gltf, struct bytes bin, const struct gltf_options *options)
{
	const cJSON *array = cJSON_GetObjectItemCaseSensitive(gltf->json.root, "buffers"), *json;
	int rc = 0;

	cJSON_ArrayForEach(json, array)
	{
		struct buffer *out = &gltf->buffers[gltf->buffer_count];

		if (rc < 0)
			break;
		if (gltf->buffer_count == GLTF_BUFFERS_MAX)
			return gltf_say(gltf, -EFBIG, json,
					"over %d buffers; export one, as GLB has it",
					GLTF_BUFFERS_MAX);
		gltf->buffer_count++;
		buffer_init(out, GLTF_BYTES_MAX);
		if (gltf->buffer_count == 1 && bin.data && !cJSON_HasObjectItem(json, "uri")) {
			buffer_put(out, bin.data, bin.size);
			rc = out->error;
		} else {
			rc = read_buffer(gltf, out, json, options);
		}
	}
	return rc;
}

/* ---- the document */

static uint32_t get_u32(const uint8_t *at)
{
	return (uint32_t)at[0] | (uint32_t)at[1] << 8 | (uint32_t)at[2] << 16 |
	       (uint32_t)at[3] << 24;
}

/* Splits a GLB into its JSON and its binary chunk; other files are JSON. */
static int split(const struct gltf *gltf, struct bytes file, struct bytes *json, struct bytes *bin)
{
	size_t at = GLB_HEAD_BYTES;

	*json = file;
	*bin = (struct bytes){ 0 };
	if (file.size < 4 || memcmp(file.data, "glTF", 4) != 0)
		return 0;
	*json = (struct bytes){ 0 };
	if (file.size >= GLB_HEAD_BYTES && get_u32(file.data + 4) != 2)
		return gltf_say(gltf, -EBADMSG, NULL, "is glTF %u; export it as glTF 2.0",
				get_u32(file.data + 4));
	while (file.size >= at + CHUNK_HEAD_BYTES) {
		const uint32_t size = get_u32(file.data + at), type = get_u32(file.data + at + 4);
		struct bytes *chunk = type == CHUNK_JSON ? json : bin;

		at += CHUNK_HEAD_BYTES;
		if (size > file.size - at)
			break;
		if ((type == CHUNK_JSON || type == CHUNK_BIN) && !chunk->data)
			*chunk = (struct bytes){ file.data + at, size };
		at += size;
	}
	if (!json->data || at != file.size)
		return gltf_say(gltf, -EBADMSG, NULL, "is cut off; copy it anew");
	return 0;
}

static int check_version(const struct gltf *gltf)
{
	const cJSON *asset = cJSON_GetObjectItemCaseSensitive(gltf->json.root, "asset");
	const char *version =
		cJSON_GetStringValue(cJSON_GetObjectItemCaseSensitive(asset, "version"));

	return version && strncmp(version, "2.", 2) == 0
		       ? 0
		       : gltf_say(gltf, -EBADMSG, NULL,
				  "is not glTF 2.0 by its \"asset\"; export it as that");
}

int gltf_read(struct gltf *out, struct bytes file, const char *path,
	      const struct gltf_options *options, struct diagnostics *diagnostics)
{
	struct bytes json, bin;
	struct buffer text;
	int rc;

	*out = (struct gltf){ .path = path, .diagnostics = diagnostics, .options = *options };
	rc = split(out, file, &json, &bin);
	if (rc < 0)
		return rc;
	buffer_init(&text, GLTF_BYTES_MAX);
	buffer_put(&text, json.data, json.size);
	rc = text.error;
	if (rc == 0)
		rc = json_text_parse(&out->json, &text, path, diagnostics);
	buffer_finish(&text);
	if (rc == 0)
		rc = check_version(out);
	if (rc == 0)
		rc = list_all(out);
	if (rc == 0)
		rc = read_buffers(out, bin, options);
	if (rc == -ENOMEM)
		gltf_say(out, rc, NULL, "too large for this machine's memory");
	return rc;
}

void gltf_finish(struct gltf *gltf)
{
	for (int list = 0; list < GLTF_LISTS; list++)
		free(gltf->lists[list].items);
	for (uint32_t i = 0; i < gltf->buffer_count; i++)
		buffer_finish(&gltf->buffers[i]);
	json_text_finish(&gltf->json);
	*gltf = (struct gltf){ 0 };
}

/* ---- accessors */

static uint32_t component_bytes(uint64_t type)
{
	switch (type) {
	case 5120:
	case 5121:
		return 1;
	case 5122:
	case 5123:
		return 2;
	case 5125:
	case 5126:
		return 4;
	default:
		return 0;
	}
}

static uint32_t width_named(const char *type)
{
	static const char *const names[] = { "SCALAR", "VEC2", "VEC3", "VEC4" };

	for (uint32_t i = 0; i < 4; i++)
		if (type && strcmp(type, names[i]) == 0)
			return i + 1;
	return 0;
}

/* Finds the bytes of an accessor. Returns what is wrong with it, or NULL. */
static const char *find_bytes(struct gltf_numbers *out, const struct gltf *gltf,
			      const cJSON *accessor, uint32_t element_bytes)
{
	const cJSON *view = gltf_item(gltf, GLTF_VIEWS, accessor, "bufferView", NULL);
	uint64_t buffer = 0, offset = 0, own = 0, length = 0, stride = 0, end;

	out->stride = element_bytes;
	if (!cJSON_HasObjectItem(accessor, "bufferView"))
		return NULL; /* all are 0 */
	if (!view || !get_count(view, "buffer", GLTF_BUFFERS_MAX, &buffer) ||
	    buffer >= gltf->buffer_count)
		return "has no buffer";
	if ((cJSON_HasObjectItem(view, "byteOffset") &&
	     !get_count(view, "byteOffset", UINT32_MAX, &offset)) ||
	    (cJSON_HasObjectItem(accessor, "byteOffset") &&
	     !get_count(accessor, "byteOffset", UINT32_MAX, &own)) ||
	    !get_count(view, "byteLength", UINT32_MAX, &length) ||
	    (cJSON_HasObjectItem(view, "byteStride") &&
	     (!get_count(view, "byteStride", 252, &stride) || stride < element_bytes)))
		return "has an offset, length or stride that is none";
	if (stride > 0)
		out->stride = (uint32_t)stride;
	end = out->count == 0 ? 0 : own + (uint64_t)out->stride * (out->count - 1) + element_bytes;
	if (end > length || offset + length > gltf->buffers[buffer].size)
		return "reaches past the end of its buffer";
	out->data = gltf->buffers[buffer].data + offset + own;
	return NULL;
}

int gltf_numbers_of(struct gltf_numbers *out, const struct gltf *gltf, const cJSON *object,
		    const char *field, uint32_t width)
{
	uint32_t number = 0;
	const cJSON *accessor = gltf_item(gltf, GLTF_ACCESSORS, object, field, &number);
	const char *fault = NULL;
	uint64_t count = 0, type = 0;

	*out = (struct gltf_numbers){ 0 };
	if (!accessor)
		return gltf_say(gltf, -EBADMSG, object, "\"%s\" is no accessor; export it anew",
				field);
	out->width = width_named(
		cJSON_GetStringValue(cJSON_GetObjectItemCaseSensitive(accessor, "type")));
	if (!get_count(accessor, "count", 1 << 24, &count))
		fault = "has no count, or one over 16777216";
	else if (!get_count(accessor, "componentType", 5126, &type) || !component_bytes(type))
		fault = "has an unknown type of numbers";
	else if (out->width != width)
		fault = "has elements of another width than its use";
	else if (cJSON_HasObjectItem(accessor, "sparse"))
		fault = "is sparse, which is not read here";
	out->count = (uint32_t)count;
	out->type = (uint32_t)type;
	out->is_normalised = cJSON_IsTrue(cJSON_GetObjectItemCaseSensitive(accessor, "normalized"));
	if (!fault)
		fault = find_bytes(out, gltf, accessor, width * component_bytes(type));
	return fault ? gltf_say(gltf, -EBADMSG, accessor,
				"accessor %u %s; export it anew without it", number, fault)
		     : 0;
}

/* ---- pictures */

/* Finds the bytes of a bufferView; none if it is not there. */
static struct bytes view_bytes(const struct gltf *gltf, const cJSON *view)
{
	uint64_t buffer, offset = 0, length;

	if (!view || !get_count(view, "buffer", GLTF_BUFFERS_MAX, &buffer) ||
	    buffer >= gltf->buffer_count || !get_count(view, "byteLength", UINT32_MAX, &length) ||
	    (cJSON_HasObjectItem(view, "byteOffset") &&
	     !get_count(view, "byteOffset", UINT32_MAX, &offset)) ||
	    offset + length > gltf->buffers[buffer].size)
		return (struct bytes){ 0 };
	return (struct bytes){ gltf->buffers[buffer].data + offset, length };
}

int gltf_picture(struct picture *out, const struct gltf *gltf, const cJSON *texture,
		 struct diagnostics *warnings)
{
	const cJSON *image = gltf_item(gltf, GLTF_IMAGES, texture, "source", NULL);
	const char *uri = cJSON_GetStringValue(cJSON_GetObjectItemCaseSensitive(image, "uri"));
	const char *data = uri && strncmp(uri, "data:", 5) == 0 ? strstr(uri, ";base64,") : NULL;
	const unsigned line = image ? json_text_line(&gltf->json, image) : 0;
	char name[NAME_BYTES] = "of a texture";
	struct buffer decoded;
	int rc;

	*out = (struct picture){ 0 };
	if (data) {
		buffer_init(&decoded, GLTF_BYTES_MAX);
		rc = decode_base64(&decoded, data + strlen(";base64,"));
		if (rc != -ENOMEM)
			rc = scenery_image_decode(out, buffer_bytes(&decoded), name, gltf->path,
						  line, warnings);
		buffer_finish(&decoded);
		return rc;
	}
	if (!uri)
		return scenery_image_decode(
			out,
			view_bytes(gltf, gltf_item(gltf, GLTF_VIEWS, image, "bufferView", NULL)),
			name, gltf->path, line, warnings);
	rc = !uri_decode(name, sizeof(name), uri) ? -ENAMETOOLONG
	     : gltf->options.open_file ? gltf->options.open_file(gltf->options.data, name)
				       : -ENOENT;
	return scenery_image_read(out, rc, name, gltf->path, line, warnings);
}

/* ---- numbers */

/* Integers as they are stored. */
static int64_t raw_integer(const struct gltf_numbers *numbers, const uint8_t *at)
{
	switch (numbers->type) {
	case 5120:
		return (int8_t)at[0];
	case 5121:
		return at[0];
	case 5122:
		return (int16_t)(at[0] | at[1] << 8);
	case 5123:
		return at[0] | at[1] << 8;
	default:
		return get_u32(at);
	}
}

float gltf_number(const struct gltf_numbers *numbers, uint32_t element, uint32_t k)
{
	static const float most[] = { 127, 255, 32767, 65535, 1, 4294967295.0f };
	const uint8_t *at = numbers->data;
	float value;

	if (!at)
		return 0;
	at += (size_t)numbers->stride * element + (size_t)k * component_bytes(numbers->type);
	if (numbers->type == 5126) {
		const uint32_t bits = get_u32(at);

		memcpy(&value, &bits, sizeof(value));
		return value;
	}
	value = (float)raw_integer(numbers, at);
	return numbers->is_normalised ? fmaxf(value / most[numbers->type - 5120], -1) : value;
}

uint32_t gltf_index(const struct gltf_numbers *numbers, uint32_t element)
{
	const int64_t value =
		numbers->data && numbers->type != 5126
			? raw_integer(numbers, numbers->data + (size_t)numbers->stride * element)
			: 0;

	return value >= 0 ? (uint32_t)value : UINT32_MAX;
}
