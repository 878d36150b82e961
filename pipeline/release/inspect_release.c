/* Walks through the pages of a release, to summarise it or to find one of its objects. */
#include "pipeline/release/inspect_release.h"

#include <errno.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "format/metadata.h"
#include "pipeline/release/inspect.h"
#include "pipeline/release/tuf_reading.h"

enum { LOCATOR_BYTES_MAX = 256 << 20 };

/* A page found while walking through the release. */
struct place {
	struct hash parent; /* the page whose child it is; zero for the root */
	uint64_t offset;
	struct page_child child;
};

struct walk {
	FILE *to;
	struct release_reader *reader;
	const char *target; /* of The Update Framework; NULL: release.json */
	struct locator locator;
	struct release release;
	struct place *places; /* owned; in breadth-first order */
	uint32_t count, room;
	struct map seen;
};

static int complain(struct walk *walk, int rc, const char *text)
{
	fprintf(walk->to, "%s\n", text);
	return rc;
}

/* Reads release.json where The Update Framework alone says which it is. */
static int read_target(struct walk *walk, bool show)
{
	const struct bytes own = { NULL, 0 };
	struct tuf_reading reading;
	struct buffer file;
	int rc;

	buffer_init(&file, METADATA_FILE_BYTES_MAX);
	rc = tuf_reading_release(&reading, walk->reader, own, walk->target, 0, &walk->release,
				 &file);
	if (rc < 0)
		complain(walk, rc, reading.why);
	else if (show)
		rc = inspect_bytes(walk->to, buffer_bytes(&file));
	tuf_reading_finish(&reading);
	buffer_finish(&file);
	return rc;
}

/* Reads release.json, trusting the release's own first root: to look, not to verify. */
static int read_release(struct walk *walk, bool show)
{
	struct buffer root, file;
	struct trust_root trust;
	const char *why = NULL;
	int rc;

	buffer_init(&root, METADATA_FILE_BYTES_MAX);
	buffer_init(&file, METADATA_FILE_BYTES_MAX);
	if (walk->target || release_reader_file(walk->reader, "release.json", &file) == -ENOENT) {
		buffer_finish(&root);
		buffer_finish(&file);
		return read_target(walk, show);
	}
	rc = release_reader_file(walk->reader, "root/1.json", &root);
	if (rc == 0)
		rc = trust_root_first(&trust, buffer_bytes(&root), &why);
	for (uint32_t n = 2; rc == 0; n++) {
		char name[32];

		snprintf(name, sizeof(name), "root/%u.json", n);
		if (release_reader_file(walk->reader, name, &root) < 0)
			break;
		rc = trust_root_next(&trust, buffer_bytes(&root), &why);
	}
	if (rc == 0)
		rc = release_reader_file(walk->reader, "release.json", &file);
	if (rc == 0)
		rc = release_decode(&walk->release, &trust, buffer_bytes(&file), &why);
	if (rc < 0)
		complain(walk, rc, why ? why : release_reader_why(walk->reader));
	else if (show)
		rc = inspect_bytes(walk->to, buffer_bytes(&file));
	buffer_finish(&root);
	buffer_finish(&file);
	return rc;
}

static int read_locator(struct walk *walk, bool show)
{
	char name[64] = "locator/";
	struct buffer file;
	int rc;

	hash_to_hex(walk->release.root, name + strlen(name));
	buffer_init(&file, LOCATOR_BYTES_MAX);
	rc = release_reader_file(walk->reader, name, &file);
	if (rc < 0)
		complain(walk, rc, release_reader_why(walk->reader));
	if (rc == 0)
		rc = locator_decode(&walk->locator, buffer_bytes(&file));
	if (rc == -EBADMSG)
		complain(walk, rc, "the locator is damaged");
	if (rc == 0 && show)
		rc = inspect_bytes(walk->to, buffer_bytes(&file));
	buffer_finish(&file);
	return rc;
}

static int add_place(struct walk *walk, const struct place *place)
{
	int rc = map_add(&walk->seen, hash_key(place->child.hash), 0);

	if (rc <= 0)
		return rc;
	rc = ARRAY_RESERVE(walk->places, walk->room, walk->count + 1, UINT32_MAX);
	if (rc == 0)
		walk->places[walk->count++] = *place;
	return rc;
}

static int start(struct walk *walk, bool show)
{
	struct place root = { 0 };
	int rc = read_release(walk, show);

	if (rc == 0)
		rc = read_locator(walk, show);
	root.child = (struct page_child){ .hash = walk->release.root,
					  .size = walk->release.root_bytes,
					  .is_page = true };
	return rc < 0 ? rc : add_place(walk, &root);
}

static void finish(struct walk *walk)
{
	locator_finish(&walk->locator);
	map_finish(&walk->seen);
	free(walk->places);
}

/* Reads an object; its bytes are borrowed until the next call. */
static int read_place(struct walk *walk, const struct place *place, struct bytes *out)
{
	int rc = release_reader_child(walk->reader, &walk->locator, place->parent, place->offset,
				      &place->child, out);

	return rc < 0 ? complain(walk, rc, release_reader_why(walk->reader)) : 0;
}

static int show_found(struct walk *walk, const struct place *place, uint32_t child)
{
	const struct locator_block *block = locator_find(&walk->locator, place->parent);
	char hex[HASH_HEX_BYTES], pack[HASH_HEX_BYTES];
	struct bytes bytes;
	int rc = read_place(walk, place, &bytes);

	if (rc < 0)
		return rc;
	hash_to_hex(place->parent, hex);
	hash_to_hex(walk->locator.packs[block->pack], pack);
	if (hash_is_zero(place->parent))
		fprintf(walk->to, "the root page of the release\n");
	else
		fprintf(walk->to, "child %u of page %s\n", child, hex);
	fprintf(walk->to, "in packs/%s at byte %" PRIu64 "\n", pack, block->offset + place->offset);
	return inspect_bytes(walk->to, bytes);
}

/* Looks for the object among a page's children. Returns 1 if it was found and shown. */
static int look_among(struct walk *walk, const struct place *at, struct hash object)
{
	struct place child = { .parent = at->child.hash };
	struct bytes bytes;
	struct page page;
	int rc = read_place(walk, at, &bytes);

	if (rc == 0)
		rc = page_decode(&page, bytes);
	if (rc < 0)
		return rc;
	for (uint32_t i = 0; rc == 0 && i < page.child_count; i++) {
		child.child = page.children[i];
		if (hash_equal(child.child.hash, object)) {
			rc = show_found(walk, &child, i);
			rc = rc < 0 ? rc : 1;
		} else if (child.child.is_page) {
			rc = add_place(walk, &child);
		}
		child.offset += page.children[i].size;
	}
	page_finish(&page);
	return rc;
}

int inspect_object(FILE *to, struct release_reader *reader, const char *target, struct hash object)
{
	struct walk walk = { .to = to, .reader = reader, .target = target };
	int rc = start(&walk, false);

	if (rc == 0 && hash_equal(object, walk.release.root)) {
		rc = show_found(&walk, &walk.places[0], 0);
		finish(&walk);
		return rc;
	}
	for (size_t i = 0; rc == 0 && i < walk.count; i++) {
		struct place at = walk.places[i]; /* a copy: the array may move */

		rc = look_among(&walk, &at, object);
	}
	if (rc == 0)
		rc = complain(&walk, -ENOENT, "the current release has no object of that name");
	finish(&walk);
	return rc == 1 ? 0 : rc;
}

/* Adds the children of the root page, of which not all are pages. */
static int add_children(struct walk *walk, const struct place *root, struct bytes bytes)
{
	struct place child = { .parent = root->child.hash };
	struct page page;
	int rc = page_decode(&page, bytes);

	if (rc < 0)
		return rc;
	for (uint32_t c = 0; rc == 0 && c < page.child_count; c++) {
		child.child = page.children[c];
		rc = add_place(walk, &child);
		child.offset += page.children[c].size;
	}
	page_finish(&page);
	return rc;
}

int inspect_release(FILE *to, struct release_reader *reader, const char *target)
{
	struct walk walk = { .to = to, .reader = reader, .target = target };
	int rc = start(&walk, true);

	/* The root and its children. Hundreds of bricks are below them; ask for them by name. */
	for (size_t i = 0; rc == 0 && i < walk.count; i++) {
		const struct place at = walk.places[i]; /* a copy: the array may move */
		struct bytes bytes;

		rc = read_place(&walk, &at, &bytes);
		if (rc == 0)
			rc = inspect_bytes(to, bytes);
		if (rc == 0 && i == 0)
			rc = add_children(&walk, &at, bytes);
	}
	finish(&walk);
	return rc;
}
