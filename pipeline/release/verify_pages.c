/* Checks the pages of each kind and those of their children that are not pages. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "format/article.h"
#include "format/label.h"
#include "format/scenery_code.h"
#include "format/scenery_texture_code.h"
#include "format/solid.h"
#include "format/stream.h"
#include "format/stream_page.h"
#include "pipeline/release/verify_pages.h"

static int blame_page(struct verify_walk *walk, const struct verify_page *page, const char *text)
{
	char hex[HASH_HEX_BYTES];

	hash_to_hex(page->name, hex);
	return diagnostics_add(&walk->report->diagnostics, -EBADMSG, NULL, 0, "page %s: %s", hex,
			       text);
}

static int blame_child(struct verify_walk *walk, const struct verify_page *page, uint32_t child,
		       const char *what, const char *text)
{
	char hex[HASH_HEX_BYTES], child_hex[HASH_HEX_BYTES];

	hash_to_hex(page->name, hex);
	hash_to_hex(page->page.children[child].hash, child_hex);
	return diagnostics_add(&walk->report->diagnostics, -EBADMSG, NULL, 0,
			       "%s %s (child %u of page %s): %s", what, child_hex, child, hex,
			       text);
}

static void count(struct verify_sum *sum, struct bytes object)
{
	sum->count++;
	sum->bytes += object.size;
}

static int check_scenery(struct verify_walk *walk, const struct verify_page *page, uint32_t child)
{
	struct scenery scenery;
	struct bytes object;
	int rc = verify_child(walk, page, child, &object);

	if (rc < 0)
		return rc;
	count(&walk->report->scenery, object);
	rc = scenery_decode(&scenery, object);
	if (rc == 0)
		rc = scenery_decode_textures(&scenery);
	scenery_finish(&scenery);
	return rc == -EBADMSG ? blame_child(walk, page, child, "scenery", "does not decode") : rc;
}

static int check_solid(struct verify_walk *walk, const struct verify_page *page, uint32_t child)
{
	struct bytes object;
	struct solid solid;
	int rc = verify_child(walk, page, child, &object);

	if (rc < 0)
		return rc;
	count(&walk->report->solid, object);
	rc = solid_decode(&solid, object);
	solid_finish(&solid);
	return rc == -EBADMSG ? blame_child(walk, page, child, "octree of where an eye may be",
					    "does not decode")
			      : rc;
}

int verify_root_page(struct verify_walk *walk, const struct verify_page *page)
{
	static const enum page_kind kinds[] = {
		[ROOT_CHILD_HIERARCHY] = PAGE_HIERARCHY,
		[ROOT_CHILD_SAMPLES] = PAGE_SAMPLES,
		[ROOT_CHILD_INFO] = PAGE_INFO,
		[ROOT_CHILD_LABELS] = PAGE_LABELS,
	};
	const struct root_page *root = &walk->report->root;
	int rc = root_page_decode(&walk->report->root, page->page.payload);
	uint32_t plain;

	if (rc < 0)
		return rc;
	plain = root_page_plain(root, page->page.child_count);
	if (plain < ROOT_CHILD_COUNT || plain > ROOT_CHILD_LABELS + 1)
		return blame_page(walk, page,
				  "a root page has three children, and one each for labels, the "
				  "streaming mesh, scenery and the space for the eye");
	for (uint32_t i = 0; rc == 0 && i < plain + root->has_stream; i++)
		rc = verify_later(walk, page, i, i < plain ? kinds[i] : PAGE_STREAM);
	if (rc == 0 && root->has_scenery)
		rc = check_scenery(walk, page, plain + root->has_stream);
	if (rc == 0 && root->has_solid)
		rc = check_solid(walk, page, page->page.child_count - 1);
	return rc;
}

/* ---- the hierarchy ---- */

static const char *compare_group(const struct hierarchy *hierarchy, uint32_t index,
				 const struct patch_mesh *meshes, uint32_t mesh_count)
{
	const struct hierarchy_group *group = &hierarchy->groups[index];

	if (mesh_count != group->patch_count)
		return "holds another number of patches than the page says";
	for (uint32_t i = 0; i < mesh_count; i++) {
		const struct hierarchy_patch *patch = &hierarchy->patches[group->first_patch + i];

		if (patch->triangle_count != meshes[i].triangle_count ||
		    patch->vertex_count != meshes[i].vertex_count)
			return "a patch has other counts than the page says";
	}
	return NULL;
}

static int check_group(struct verify_walk *walk, const struct verify_page *page,
		       const struct hierarchy *hierarchy, uint32_t index)
{
	struct patch_mesh meshes[GROUP_PATCHES_MAX];
	const char *wrong = "does not decode";
	uint32_t mesh_count = 0;
	struct bytes object;
	int rc = verify_child(walk, page, index, &object);

	if (rc < 0)
		return rc;
	rc = patch_group_decode(meshes, &mesh_count, object);
	if (rc == 0)
		wrong = compare_group(hierarchy, index, meshes, mesh_count);
	for (uint32_t i = 0; rc == 0 && i < mesh_count; i++)
		patch_mesh_finish(&meshes[i]);
	count(&walk->report->groups, object);
	return wrong ? blame_child(walk, page, index, "patch group", wrong) : 0;
}

int verify_hierarchy_page(struct verify_walk *walk, const struct verify_page *page)
{
	struct hierarchy *hierarchy = &walk->hierarchy;
	int rc = hierarchy_decode(hierarchy, page->page.payload);

	if (rc < 0)
		return rc;
	if (hierarchy->group_count != page->page.child_count)
		rc = blame_page(walk, page, "has another number of children than of patch groups");
	for (uint32_t i = 0; rc == 0 && i < hierarchy->group_count; i++)
		rc = check_group(walk, page, hierarchy, i);
	for (uint32_t i = 0; i < hierarchy->patch_count; i++)
		walk->report->hierarchy_triangles += hierarchy->patches[i].triangle_count;
	walk->report->patches = hierarchy->patch_count;
	return rc;
}

/* ---- the streaming mesh ---- */

/* Decodes the whole stream as it arrives: the beginning on the page, then block by block. */
static int check_stream(struct verify_walk *walk, const struct verify_page *page,
			struct stream_decoder *decoder, struct buffer *stream)
{
	int rc = stream_decoder_advance(decoder, buffer_bytes(stream));

	if (rc == 0 && stream_decoder_mesh(decoder)->triangle_count == 0)
		return blame_page(walk, page, "has no whole base");
	if (rc == 0 && stream_decoder_mesh(decoder)->vertex_room > STREAM_PAGE_VERTICES_MAX)
		return blame_page(walk, page, "has more vertices than a kiosk draws as one mesh");
	for (uint32_t i = 0; rc == 0 && i < page->page.child_count; i++) {
		const uint32_t before = stream_decoder_records(decoder);
		struct bytes object;

		rc = verify_child(walk, page, i, &object);
		if (rc < 0)
			return rc;
		count(&walk->report->stream_blocks, object);
		buffer_put(stream, object.data, object.size);
		rc = stream->error ? stream->error
				   : stream_decoder_advance(decoder, buffer_bytes(stream));
		if (rc == -EBADMSG || (rc == 0 && stream_decoder_records(decoder) == before))
			return blame_child(walk, page, i, "block of the streaming mesh",
					   "does not decode");
	}
	if (rc == 0 && !stream_decoder_complete(decoder))
		return blame_page(walk, page, "lacks blocks of the streaming mesh");
	return rc;
}

int verify_stream_page(struct verify_walk *walk, const struct verify_page *page)
{
	struct stream_decoder *decoder = NULL;
	struct stream_page stream;
	struct buffer bytes;
	int rc = stream_page_decode(&stream, page->page.payload, page->page.child_count);

	if (rc == 0 && stream.group_count > walk->hierarchy.group_count)
		rc = blame_page(walk, page, "names more patch groups than there are");
	buffer_init(&bytes, OBJECT_BYTES_MAX);
	if (rc == 0)
		rc = stream_decoder_create(&decoder);
	if (rc == 0) {
		buffer_put(&bytes, stream.start.data, stream.start.size);
		rc = check_stream(walk, page, decoder, &bytes);
	}
	stream_decoder_destroy(decoder);
	buffer_finish(&bytes);
	return rc;
}

/* ---- samples ---- */

/* Returns how many children the numbers imply: they are consecutive, so it is the largest plus
 * one. */
static uint32_t children_named(const uint32_t *children, uint32_t length)
{
	uint32_t named = 0;

	for (uint32_t i = 0; i < length; i++)
		if (children[i] != SAMPLE_NONE && children[i] + 1 > named)
			named = children[i] + 1;
	return named;
}

int verify_samples_page(struct verify_walk *walk, const struct verify_page *page)
{
	struct samples_page *samples = &walk->samples;
	int rc = samples_page_decode(samples, page->page.payload);

	if (rc < 0)
		return rc;
	if (children_named(samples->brick_child, samples_page_bricks(samples)) !=
	    page->page.child_count)
		return blame_page(walk, page, "has another number of children than of bricks");
	for (uint32_t i = 0; rc == 0 && i < page->page.child_count; i++)
		rc = verify_later(walk, page, i, PAGE_BRICK);
	return rc;
}

int verify_brick_page(struct verify_walk *walk, const struct verify_page *page)
{
	struct brick_page *brick = malloc(sizeof(*brick));
	int rc = brick ? brick_page_decode(brick, page->page.payload) : -ENOMEM;

	if (rc == 0 && children_named(&brick->face_child[0][0], BRICK_POINTS * CUBE_FACES) !=
			       page->page.child_count)
		rc = blame_page(walk, page, "has another number of children than of faces");
	for (uint32_t p = 0; rc == 0 && p < BRICK_POINTS; p++) {
		uint32_t faces = 0;

		for (int f = 0; f < CUBE_FACES; f++)
			faces += brick->face_child[p][f] != SAMPLE_NONE;
		walk->report->points += faces > 0;
		walk->report->faces += faces;
	}
	for (uint32_t i = 0; rc == 0 && i < page->page.child_count; i++)
		rc = verify_later(walk, page, i, PAGE_FACE);
	free(brick);
	return rc;
}

static int check_tile(struct verify_walk *walk, const struct verify_page *page, uint32_t child)
{
	uint8_t rgb[SAMPLE_IMAGE_PX * SAMPLE_IMAGE_PX * 3];
	struct bytes object;
	int rc = verify_child(walk, page, child, &object);

	if (rc < 0)
		return rc;
	count(&walk->report->tiles, object);
	rc = tile_decode(rgb, SAMPLE_IMAGE_PX, object);
	return rc == -EBADMSG ? blame_child(walk, page, child, "tile", "does not decode") : rc;
}

int verify_face_page(struct verify_walk *walk, const struct verify_page *page)
{
	struct face_page face;
	int rc = face_page_decode(&face, page->page.payload);

	if (rc < 0)
		return rc;
	if (face.level_count > walk->samples.level_count)
		return blame_page(walk, page, "is finer than the samples page says");
	if (children_named(face.tile_child, face_tile_index(face.level_count, 0, 0)) !=
	    page->page.child_count)
		return blame_page(walk, page, "has another number of children than of tiles");
	for (uint32_t i = 0; rc == 0 && i < page->page.child_count; i++)
		rc = check_tile(walk, page, i);
	return rc;
}

/* ---- information ---- */

/* Whether what is spoken on a part's page in a language is among the children. */
static int check_spoken(struct verify_walk *walk, const struct map *children, struct info *info,
			uint32_t part, const char *language)
{
	struct info_spoken spoken;
	int rc = info_spoken(info, part, language, &spoken);

	if (rc == -ENOENT)
		return 0;
	if (rc < 0)
		return rc == -EBADMSG ? diagnostics_add(&walk->report->diagnostics, rc, NULL, 0,
							"the spoken text of %s in %s is damaged",
							info_part(info, part)->id, language)
				      : rc;
	if (map_get(children, hash_key(spoken.hash)) != MAP_NONE)
		return 0;
	return diagnostics_add(&walk->report->diagnostics, -EBADMSG, NULL, 0,
			       "the spoken text of %s in %s is not in the release",
			       info_part(info, part)->id, language);
}

/* Pictures and spoken texts. */
static int check_files(struct verify_walk *walk, const struct verify_page *page, struct info *info)
{
	const uint32_t languages = info_language_count(info);
	struct map children = { 0 };
	struct bytes object;
	int rc = 0;

	for (uint32_t i = 1; rc >= 0 && i < page->page.child_count; i++) {
		rc = verify_child(walk, page, i, &object);
		if (rc == 0) {
			count(&walk->report->files, object);
			rc = map_add(&children, hash_key(page->page.children[i].hash), i);
		}
		if (rc == 0)
			rc = blame_child(walk, page, i, "picture or spoken text",
					 "is contained twice");
	}
	for (uint32_t i = 0; rc >= 0 && i < info_picture_count(info); i++) {
		const struct info_picture *picture = info_picture(info, i);

		if (map_get(&children, hash_key(picture->hash)) == MAP_NONE)
			rc = diagnostics_add(
				&walk->report->diagnostics, -EBADMSG, NULL, 0,
				"the information names %s, which is not in the release",
				picture->name);
	}
	for (uint32_t i = 0; rc >= 0 && i < info_part_count(info) * languages; i++)
		rc = check_spoken(walk, &children, info, i / languages,
				  info_language(info, i % languages));
	map_finish(&children);
	return rc < 0 ? rc : 0;
}

/* Decodes the page of every part and language, and looks up the pictures that it shows. */
static int check_articles(struct verify_walk *walk, struct info *info)
{
	const uint32_t languages = info_language_count(info);
	int rc = 0;

	for (uint32_t i = 0; rc == 0 && i < info_part_count(info) * languages; i++) {
		const char *language = info_language(info, i % languages), *found = "";
		const char *part = info_part(info, i / languages)->id, *missing = NULL;
		struct article_blocks article = { 0 };
		struct bytes bytes;

		rc = info_page(info, i / languages, language, &bytes, &found);
		if (rc == 0 && strcmp(found, language) == 0)
			rc = article_decode(&article, bytes);
		for (uint32_t k = 0; !missing && k < article.block_count; k++)
			if (article.blocks[k].kind == ARTICLE_IMAGE &&
			    !info_find_picture(info, article.blocks[k].text))
				missing = article.blocks[k].text;
		if (missing)
			rc = diagnostics_add(&walk->report->diagnostics, -EBADMSG, NULL, 0,
					     "the page of %s in %s shows %s, which the information "
					     "has not",
					     part, language, missing);
		else if (rc == -EBADMSG)
			rc = diagnostics_add(&walk->report->diagnostics, rc, NULL, 0,
					     "the page of %s in %s is damaged", part, language);
		else if (rc == -ENOENT)
			rc = 0;
		article_finish(&article);
	}
	return rc;
}

int verify_info_page(struct verify_walk *walk, const struct verify_page *page)
{
	struct bytes image;
	int rc;

	if (page->page.child_count < 1)
		return blame_page(walk, page, "has no information database");
	rc = verify_child(walk, page, 0, &image);
	if (rc < 0)
		return rc;
	count(&walk->report->database, image);
	rc = info_open(&walk->info, image);
	if (rc < 0)
		return rc == -EBADMSG ? blame_child(walk, page, 0, "information database",
						    "is damaged or of another version")
				      : rc;
	walk->report->parts = info_part_count(walk->info);
	rc = check_articles(walk, walk->info);
	return rc < 0 ? rc : check_files(walk, page, walk->info);
}

/* ---- labels ---- */

static const char *compare_labels(const struct verify_walk *walk, uint32_t index,
				  const struct label_group *labels)
{
	const struct hierarchy_group *group = &walk->hierarchy.groups[index];

	if (labels->patch_count != group->patch_count)
		return "are of another number of patches than their group";
	for (uint32_t p = 0; p < labels->patch_count; p++)
		if (labels->patches[p].triangle_count !=
		    walk->hierarchy.patches[group->first_patch + p].triangle_count)
			return "are of another number of triangles than a patch of their group";
	for (uint32_t p = 0; p < labels->part_count; p++)
		if (info_find(walk->info, labels->parts[p].id) < 0)
			return "name a part that the information database lacks";
	return NULL;
}

static int check_labels(struct verify_walk *walk, const struct verify_page *page, uint32_t child,
			uint32_t group)
{
	struct label_group labels;
	const char *wrong = "do not decode";
	struct bytes object;
	int rc = verify_child(walk, page, child, &object);

	if (rc < 0)
		return rc;
	count(&walk->report->labels, object);
	rc = label_group_decode(&labels, object);
	if (rc == -ENOMEM)
		return rc;
	if (rc == 0)
		wrong = compare_labels(walk, group, &labels);
	label_group_finish(&labels);
	return wrong ? blame_child(walk, page, child, "labels", wrong) : 0;
}

int verify_labels_page(struct verify_walk *walk, const struct verify_page *page)
{
	uint32_t *child_of_group;
	int rc;

	if (!walk->info || walk->hierarchy.group_count == 0)
		return blame_page(walk, page, "comes before what it labels");
	rc = label_page_decode(&child_of_group, walk->hierarchy.group_count, page->page.child_count,
			       page->page.payload);
	for (uint32_t g = 0; rc == 0 && g < walk->hierarchy.group_count; g++)
		if (child_of_group[g] != LABEL_NONE)
			rc = check_labels(walk, page, child_of_group[g], g);
	free(child_of_group);
	return rc;
}
