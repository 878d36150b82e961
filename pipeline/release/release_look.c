/* Reads signed files, and follows the pages to the information database. */
#include "pipeline/release/release_look.h"

#include <errno.h>
#include <inttypes.h>
#include <limits.h>
#include <stdio.h>
#include <unistd.h>

#include "format/root_page.h"
#include "pipeline/release/pack.h"
#include "pipeline/release/release_reader.h"
#include "pipeline/release/tuf_folder.h"

enum { ROOTS_MAX = 1000 };

static int read_file(struct buffer *out, const char *folder, const char *name)
{
	char path[PATH_MAX];

	if (snprintf(path, sizeof(path), "%s/%s", folder, name) >= (int)sizeof(path))
		return -ENAMETOOLONG;
	buffer_clear(out);
	return buffer_read_file(out, path);
}

static int follow_roots(struct trust_root *trust, struct buffer *file, const char *folder)
{
	char name[32];
	int rc = 0;

	while (rc == 0 && trust->version < ROOTS_MAX) {
		snprintf(name, sizeof(name), "root/%u.json", trust->version + 1);
		rc = read_file(file, folder, name);
		if (rc == -ENOENT)
			return 0;
		if (rc == 0)
			rc = trust_root_next(trust, buffer_bytes(file), NULL);
	}
	return rc;
}

int release_look_trust(struct trust_root *out, const char *folder)
{
	struct buffer file;
	int rc;

	buffer_init(&file, METADATA_FILE_BYTES_MAX);
	rc = read_file(&file, folder, "root/1.json");
	if (rc == 0)
		rc = trust_root_first(out, buffer_bytes(&file), NULL);
	if (rc == 0)
		rc = follow_roots(out, &file, folder);
	if (read_file(&file, folder, "release.json") == -ENOENT &&
	    read_file(&file, folder, "tuf/1.root.json") == 0) {
		*out = (struct trust_root){ .version = 0 };
		rc = 0;
	}
	buffer_finish(&file);
	return rc;
}

/* Returns whether there is a version of the file that names releases. Numbers may be left out, many
 * at once, and opening the folder for each would take long. */
static bool has_version(const struct release_place *place, uint64_t sequence)
{
	char path[PATH_MAX];

	return snprintf(path, sizeof(path), "%s/tuf/%" PRIu64 ".%s.json", place->folder, sequence,
			place->role && *place->role ? place->role : "targets") >= PATH_MAX ||
	       access(path, F_OK) == 0 || errno != ENOENT;
}

/* The roots of the release folder have the names of those in a keys' folder. */
static int look_at_target(struct release *out, const struct release_place *where, uint64_t sequence,
			  struct buffer *file)
{
	const struct tuf_place place = { .release = where->folder,
					 .keys_folder = where->folder,
					 .target = where->target,
					 .role = where->role };
	struct tuf_folder tuf;
	int rc;

	if (sequence > 0 && !has_version(where, sequence))
		return -ENOENT;
	rc = tuf_folder_open(&tuf, &place);

	if (rc == 0)
		rc = sequence > 0 ? tuf_folder_at(&tuf, sequence, out, file)
				  : tuf_folder_current(&tuf, out, file);
	tuf_folder_finish(&tuf);
	return rc;
}

int release_look_at(struct release *out, const struct release_place *place,
		    const struct trust_root *trust, uint64_t sequence)
{
	char name[64] = "release.json";
	struct buffer file;
	int rc;

	*out = (struct release){ 0 };
	if (sequence > 0)
		snprintf(name, sizeof(name), "history/%" PRIu64 ".json", sequence);
	buffer_init(&file, METADATA_FILE_BYTES_MAX);
	if (trust->version == 0) {
		rc = look_at_target(out, place, sequence, &file);
		buffer_finish(&file);
		return rc;
	}
	rc = read_file(&file, place->folder, name);
	if (rc == 0)
		rc = release_decode(out, trust, buffer_bytes(&file), NULL);
	buffer_finish(&file);
	return rc;
}

/* ---- the database */

/* Reads a page and finds its child. *out names the child; its place in the block is *offset. */
static int find_child(struct page_child *out, uint64_t *offset, struct bytes object, uint32_t child)
{
	struct page page;
	int rc = page_decode(&page, object);

	if (rc < 0)
		return rc;
	if (child >= page.child_count) {
		page_finish(&page);
		return -EBADMSG;
	}
	*out = page.children[child];
	*offset = page_child_offset(&page, child);
	page_finish(&page);
	return 0;
}

static int read_info(struct buffer *out, struct release_reader *reader,
		     const struct locator *locator, const struct release *release)
{
	const struct page_child root = { release->root, release->root_bytes, true };
	struct page_child info, database;
	struct bytes object;
	uint64_t offset;
	int rc = release_reader_child(reader, locator, (struct hash){ 0 }, 0, &root, &object);

	if (rc == 0)
		rc = find_child(&info, &offset, object, ROOT_CHILD_INFO);
	if (rc == 0)
		rc = release_reader_child(reader, locator, root.hash, offset, &info, &object);
	if (rc == 0)
		rc = find_child(&database, &offset, object, 0);
	if (rc == 0)
		rc = release_reader_child(reader, locator, info.hash, offset, &database, &object);
	if (rc == 0)
		buffer_put(out, object.data, object.size);
	return rc == 0 ? out->error : rc;
}

int release_look_info(struct buffer *out, const char *folder, const struct release *release,
		      uint64_t *size_bytes)
{
	const struct release_reader_options options = { .place = folder };
	struct release_reader *reader;
	struct locator locator = { 0 };
	int rc = release_reader_create(&reader, &options);

	*size_bytes = 0;
	if (rc == 0)
		rc = pack_read_locator(&locator, folder, release->root);
	if (rc == 0)
		rc = read_info(out, reader, &locator, release);
	for (uint32_t n = 0; n < locator.block_count; n++)
		*size_bytes += locator.blocks[n].size;
	locator_finish(&locator);
	release_reader_destroy(reader);
	return rc;
}
