/* Keeps objects by hash, in memory or as a byte range of a file that is checked when it is read. */
#include "pipeline/release/object_store.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/array.h"
#include "base/log.h"

struct stored {
	uint8_t *memory; /* owned; NULL: it is in a file */
	uint32_t size;
	uint32_t file; /* index into paths */
	uint64_t offset;
};

struct object_store {
	struct map index; /* hash to index into objects */
	struct stored *objects;
	uint32_t count, room;
	char **paths;
	uint32_t path_count, path_room;
	int open_fd; /* of paths[open_file]; -1: none */
	uint32_t open_file;
};

int object_store_create(struct object_store **out)
{
	*out = calloc(1, sizeof(**out));
	if (!*out)
		return -ENOMEM;
	(*out)->open_fd = -1;
	return 0;
}

void object_store_destroy(struct object_store *store)
{
	if (!store)
		return;
	for (uint32_t i = 0; i < store->count; i++)
		free(store->objects[i].memory);
	for (uint32_t i = 0; i < store->path_count; i++)
		free(store->paths[i]);
	if (store->open_fd >= 0)
		close(store->open_fd);
	free(store->paths);
	free(store->objects);
	map_finish(&store->index);
	free(store);
}

/* Returns 1 if *object was taken, 0 if the hash was there already. */
static int insert(struct object_store *store, struct hash hash, const struct stored *object)
{
	int rc = ARRAY_RESERVE(store->objects, store->room, store->count + 1, UINT32_MAX);

	if (rc < 0)
		return rc;
	rc = map_add(&store->index, hash_key(hash), store->count);
	if (rc == 1)
		store->objects[store->count++] = *object;
	return rc;
}

int object_store_add(struct object_store *store, struct bytes bytes, struct page_child *child)
{
	struct stored object = { .size = (uint32_t)bytes.size };
	struct hash hash;
	int rc;

	if (bytes.size == 0 || bytes.size > OBJECT_BYTES_MAX)
		return -EFBIG;
	hash = hash_of(bytes);
	if (child)
		*child = (struct page_child){ .hash = hash, .size = object.size };
	if (map_get(&store->index, hash_key(hash)) != MAP_NONE)
		return 0;
	object.memory = malloc(bytes.size);
	if (!object.memory)
		return -ENOMEM;
	memcpy(object.memory, bytes.data, bytes.size);
	rc = insert(store, hash, &object);
	if (rc < 0)
		free(object.memory);
	return rc < 0 ? rc : 0;
}

int object_store_add_page(struct object_store *store, const struct page *page,
			  struct page_child *child)
{
	struct page_child made = { 0 };
	struct buffer buffer;
	int rc;

	buffer_init(&buffer, PAGE_BYTES_MAX);
	page_encode(&buffer, page);
	rc = buffer.error;
	if (rc == 0)
		rc = object_store_add(store, buffer_bytes(&buffer), &made);
	made.is_page = true;
	if (rc == 0 && child)
		*child = made;
	buffer_finish(&buffer);
	return rc;
}

static int path_index(struct object_store *store, const char *path, uint32_t *index)
{
	int rc;

	if (store->path_count > 0 && strcmp(store->paths[store->path_count - 1], path) == 0) {
		*index = store->path_count - 1;
		return 0;
	}
	rc = ARRAY_RESERVE(store->paths, store->path_room, store->path_count + 1, UINT32_MAX);
	if (rc < 0)
		return rc;
	store->paths[store->path_count] = strdup(path);
	if (!store->paths[store->path_count])
		return -ENOMEM;
	*index = store->path_count++;
	return 0;
}

int object_store_add_stretch(struct object_store *store, const char *path, uint64_t offset,
			     const struct page_child *child)
{
	struct stored object = { .size = child->size, .offset = offset };
	int rc;

	if (child->size == 0 || child->size > OBJECT_BYTES_MAX)
		return -EFBIG;
	rc = path_index(store, path, &object.file);
	if (rc == 0)
		rc = insert(store, child->hash, &object);
	return rc < 0 ? rc : 0;
}

static int read_stretch(struct object_store *store, const struct stored *object, uint8_t *to)
{
	if (store->open_fd < 0 || store->open_file != object->file) {
		if (store->open_fd >= 0)
			close(store->open_fd);
		store->open_fd = open(store->paths[object->file], O_RDONLY | O_CLOEXEC);
		store->open_file = object->file;
	}
	if (store->open_fd < 0)
		return -errno;
	return bytes_read_at(store->open_fd, to, object->size, object->offset);
}

int object_store_read(struct object_store *store, struct hash hash, struct buffer *out)
{
	const struct stored *object;
	const uint64_t index = map_get(&store->index, hash_key(hash));
	uint8_t *to;
	int rc;

	if (index == MAP_NONE)
		return -ENOENT;
	object = &store->objects[index];
	if (object->memory) {
		buffer_put(out, object->memory, object->size);
		return out->error;
	}
	to = buffer_extend(out, object->size);
	if (!to)
		return out->error;
	rc = read_stretch(store, object, to);
	if (rc == 0 && !hash_equal(hash_of((struct bytes){ to, object->size }), hash))
		rc = -EBADMSG;
	if (rc < 0)
		log_error("pipeline", "%s: %s", store->paths[object->file],
			  rc == -EBADMSG ? "changed while it was published, or is damaged: run "
					   "`gopura-content build` again, and if that says the "
					   "same, remove this file before"
					 : strerror(-rc));
	return rc;
}

int object_store_read_page(struct object_store *store, const struct page_child *child,
			   struct page *page, struct buffer *bytes)
{
	int rc;

	*page = (struct page){ 0 };
	buffer_init(bytes, PAGE_BYTES_MAX);
	rc = object_store_read(store, child->hash, bytes);
	return rc < 0 ? rc : page_decode(page, buffer_bytes(bytes));
}

int object_store_read_group(struct object_store *store, struct hash hash,
			    struct patch_mesh meshes[GROUP_PATCHES_MAX], uint32_t *count)
{
	struct buffer object;
	int rc;

	*count = 0;
	buffer_init(&object, OBJECT_BYTES_MAX);
	rc = object_store_read(store, hash, &object);
	if (rc == 0)
		rc = patch_group_decode(meshes, count, buffer_bytes(&object));
	buffer_finish(&object);
	return rc;
}

bool object_store_has(const struct object_store *store, struct hash hash)
{
	return map_get(&store->index, hash_key(hash)) != MAP_NONE;
}
