/* Stores the label objects of all groups in one file with a key and a checksum. */
#include "pipeline/release/label_cache.h"

#include <errno.h>
#include <string.h>

enum {
	LABELLING_VERSION = 2, /* raise it when the same parts of the same scan get other labels */
	KEY_TEXT_MAX = 1 << 20,
	FILE_BYTES_MAX = 256 << 20,
};

static void put_floats(struct buffer *text, const float *values, uint32_t count)
{
	for (uint32_t i = 0; i < count; i++)
		buffer_put_f32(text, values[i]);
}

static void put_region(struct buffer *text, const struct region *region)
{
	buffer_put_u32(text, (uint32_t)region->kind);
	put_floats(text, region->centre_m, 3);
	buffer_put_f32(text, region->radius_m);
	put_floats(text, region->half_m, 3);
	buffer_put_f32(text, region->turn_deg);
	buffer_put_f32(text, region->floor_m);
	buffer_put_f32(text, region->roof_m);
	buffer_put_u32(text, region->corner_count);
	for (uint32_t i = 0; i < region->corner_count; i++)
		put_floats(text, region->corners_m[i], 2);
}

int label_cache_key(struct hash *out, struct hash scans, struct hash hierarchy,
		    const struct label_source_part *parts, uint32_t part_count)
{
	struct buffer text;
	int rc;

	buffer_init(&text, KEY_TEXT_MAX);
	buffer_put_u32(&text, LABELLING_VERSION);
	buffer_put(&text, scans.bytes, HASH_BYTES);
	buffer_put(&text, hierarchy.bytes, HASH_BYTES);
	for (uint32_t i = 0; i < part_count; i++) {
		buffer_put_string(&text, parts[i].id);
		put_region(&text, &parts[i].region);
		buffer_put_u8(&text, parts[i].is_list);
		buffer_put(&text, parts[i].list.bytes, HASH_BYTES);
	}
	rc = text.error;
	*out = hash_of(buffer_bytes(&text));
	buffer_finish(&text);
	return rc;
}

static struct hash read_hash(struct reader *reader)
{
	const struct bytes bytes = reader_bytes(reader, HASH_BYTES);
	struct hash hash = { 0 };

	if (bytes.size == HASH_BYTES)
		memcpy(hash.bytes, bytes.data, HASH_BYTES);
	return hash;
}

/* The file contains: the hash of everything after it, the key, the count, and each object after its
 * size. */
static int read_file(struct buffer *labels, uint32_t count, struct hash key, struct bytes file)
{
	struct reader reader;
	struct hash whole;

	if (file.size < HASH_BYTES)
		return -ENOENT;
	whole = hash_of((struct bytes){ file.data + HASH_BYTES, file.size - HASH_BYTES });
	reader_init(&reader, file);
	if (!hash_equal(whole, read_hash(&reader)) || !hash_equal(key, read_hash(&reader)) ||
	    reader_u32(&reader) != count)
		return -ENOENT;
	for (uint32_t i = 0; i < count; i++) {
		struct bytes object = reader_bytes(&reader, reader_u32(&reader));

		buffer_put(&labels[i], object.data, object.size);
		if (labels[i].error)
			return labels[i].error;
	}
	return reader.failed ? -ENOENT : 0;
}

int label_cache_load(struct buffer *labels, uint32_t count, struct hash key, const char *path)
{
	struct buffer file;
	int rc;

	buffer_init(&file, FILE_BYTES_MAX);
	rc = buffer_read_file(&file, path);
	rc = rc < 0 ? -ENOENT : read_file(labels, count, key, buffer_bytes(&file));
	buffer_finish(&file);
	for (uint32_t i = 0; rc < 0 && i < count; i++)
		buffer_clear(&labels[i]);
	return rc;
}

int label_cache_save(const struct buffer *labels, uint32_t count, struct hash key, const char *path)
{
	struct buffer file;
	struct hash whole = { 0 };
	int rc;

	buffer_init(&file, FILE_BYTES_MAX);
	buffer_put(&file, whole.bytes, HASH_BYTES);
	buffer_put(&file, key.bytes, HASH_BYTES);
	buffer_put_u32(&file, count);
	for (uint32_t i = 0; i < count; i++) {
		buffer_put_u32(&file, (uint32_t)labels[i].size);
		buffer_put(&file, labels[i].data, labels[i].size);
	}
	rc = file.error;
	if (rc == 0) {
		whole = hash_of((struct bytes){ file.data + HASH_BYTES, file.size - HASH_BYTES });
		memcpy(file.data, whole.bytes, HASH_BYTES);
		rc = bytes_write_file(buffer_bytes(&file), path);
	}
	buffer_finish(&file);
	return rc;
}
