/* Prints summaries of single files: recognises the form by its first bytes, decodes it and prints
 * its main figures. */
#include "pipeline/release/inspect.h"

#include <cjson/cJSON.h>
#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <sodium.h>
#include <stdlib.h>
#include <string.h>

#include "base/json_tree.h"
#include "format/hierarchy.h"
#include "format/label.h"
#include "format/metadata.h"
#include "format/patch.h"
#include "format/picture.h"
#include "format/root_page.h"
#include "format/samples.h"
#include "format/scenery_code.h"
#include "format/solid.h"
#include "format/stream.h"
#include "format/stream_page.h"
#include "format/tile.h"
#include "geometry/substance.h"
#include "storage/info.h"

enum { CHILDREN_SHOWN = 8 };

static void print_children(FILE *to, const struct page *page)
{
	for (uint32_t i = 0; i < page->child_count && i < CHILDREN_SHOWN; i++) {
		char hex[HASH_HEX_BYTES];

		hash_to_hex(page->children[i].hash, hex);
		fprintf(to, "  child %-5u %s  %9u bytes%s\n", i, hex, page->children[i].size,
			page->children[i].is_page ? "  page" : "");
	}
	if (page->child_count > CHILDREN_SHOWN)
		fprintf(to, "  and %u more\n", page->child_count - CHILDREN_SHOWN);
}

static void print_vector(FILE *to, const char *what, const float vector[3])
{
	fprintf(to, "  %-18s %.3f %.3f %.3f\n", what, (double)vector[0], (double)vector[1],
		(double)vector[2]);
}

static int print_root(FILE *to, const struct page *page)
{
	struct root_page root;
	int rc = root_page_decode(&root, page->payload);

	if (rc < 0)
		return rc;
	fprintf(to, "  name               %s\n", root.name);
	fprintf(to, "  lattice            origin %.4f %.4f %.4f, step %.6f m\n",
		root.lattice.origin_m[0], root.lattice.origin_m[1], root.lattice.origin_m[2],
		root.lattice.step_m);
	print_vector(to, "box from", root.box_min_m);
	print_vector(to, "box to", root.box_max_m);
	print_vector(to, "start eye", root.start_eye_m);
	print_vector(to, "start target", root.start_target_m);
	print_vector(to, root.lit ? "lit, sun" : "not lit, sun", root.sun);
	fprintf(to, "  background         #%02x%02x%02x\n", root.background[0], root.background[1],
		root.background[2]);
	fprintf(to, "  cut shows          %s\n", substance_names[root.cut]);
	fprintf(to, "  triangles          %" PRIu64 " published of %" PRIu64 ", %.2f %%\n",
		root.published_triangles, root.source_triangles,
		100.0 * (double)root.published_triangles / (double)root.source_triangles);
	return 0;
}

static int print_hierarchy(FILE *to, const struct page *page)
{
	struct hierarchy hierarchy;
	uint64_t triangles = 0, finest = 0;
	int rc = hierarchy_decode(&hierarchy, page->payload);

	if (rc < 0)
		return rc;
	for (uint32_t i = 0; i < hierarchy.patch_count; i++) {
		triangles += hierarchy.patches[i].triangle_count;
		if (hierarchy.patches[i].finer == HIERARCHY_NONE)
			finest += hierarchy.patches[i].triangle_count;
	}
	fprintf(to, "  groups             %u\n  patches            %u\n", hierarchy.group_count,
		hierarchy.patch_count);
	fprintf(to, "  triangles          %" PRIu64 ", %" PRIu64 " in the finest cut\n", triangles,
		finest);
	for (uint32_t i = 0; i < hierarchy.group_count && i < CHILDREN_SHOWN; i++)
		fprintf(to, "  group %-5u        %u patches, error %.4f m, radius %.3f m\n", i,
			hierarchy.groups[i].patch_count, (double)hierarchy.groups[i].error_m,
			(double)hierarchy.groups[i].radius_m);
	hierarchy_finish(&hierarchy);
	return 0;
}

static int print_samples(FILE *to, const struct page *page)
{
	struct samples_page samples;
	int rc = samples_page_decode(&samples, page->payload);

	if (rc < 0)
		return rc;
	fprintf(to, "  grid               %u x %u x %u points\n", samples.count[0],
		samples.count[1], samples.count[2]);
	print_vector(to, "from", samples.origin_m);
	print_vector(to, "spacing", samples.spacing_m);
	for (uint32_t i = 0; i < samples.vantage_count; i++)
		print_vector(to, "vantage point", samples.vantage_m[i]);
	fprintf(to, "  finest face        %u px\n", SAMPLE_TILE_PX << (samples.level_count - 1));
	samples_page_finish(&samples);
	return 0;
}

static int print_brick(FILE *to, const struct page *page)
{
	struct brick_page *brick = malloc(sizeof(*brick));
	int rc = brick ? brick_page_decode(brick, page->payload) : -ENOMEM;

	for (uint32_t p = 0; rc == 0 && p < BRICK_POINTS; p++)
		for (int f = 0; f < CUBE_FACES; f++)
			if (brick->face_child[p][f] != SAMPLE_NONE)
				fprintf(to,
					"  point %u %u %u %s  child %-4u shows %2d/16 of the face, "
					"%.2f to %.2f m away\n",
					p % 4, p / 4 % 4, p / 16, cube_face_names[f],
					brick->face_child[p][f],
					__builtin_popcount(brick->coverage[p][f]),
					(double)brick->near_m[p][f], (double)brick->far_m[p][f]);
	free(brick);
	return rc;
}

static int print_face(FILE *to, const struct page *page)
{
	struct face_page face;
	int rc = face_page_decode(&face, page->payload);

	for (uint32_t level = 0; rc == 0 && level < face.level_count; level++) {
		uint32_t there = 0, all = 1u << (2 * level);

		for (uint32_t i = 0; i < all; i++)
			there += face.tile_child[face_tile_index(level, 0, 0) + i] != SAMPLE_NONE;
		fprintf(to, "  %4u px            %u of %u tiles\n", SAMPLE_TILE_PX << level, there,
			all);
	}
	return rc;
}

static int print_stream(FILE *to, const struct page *page)
{
	struct stream_decoder *decoder = NULL;
	struct stream_page stream;
	int rc = stream_page_decode(&stream, page->payload, page->child_count);

	if (rc == 0)
		rc = stream_decoder_create(&decoder);
	if (rc == 0)
		rc = stream_decoder_advance(decoder, stream.start);
	if (rc == 0) {
		const struct stream_mesh *mesh = stream_decoder_mesh(decoder);

		fprintf(to, "  base               %u vertices, %u triangles, error %.4f m\n",
			mesh->vertex_count, mesh->triangle_count,
			(double)stream_page_error_m(&stream, 0));
		fprintf(to, "  whole              %u vertices, %u triangles, as groups 0 to %u\n",
			mesh->vertex_room, mesh->triangle_room, stream.group_count - 1);
	}
	stream_decoder_destroy(decoder);
	return rc;
}

static int print_page(FILE *to, struct bytes bytes)
{
	static const struct {
		const char *name;
		int (*print)(FILE *, const struct page *);
	} kinds[] = {
		[PAGE_ROOT] = { "root", print_root },
		[PAGE_HIERARCHY] = { "hierarchy", print_hierarchy },
		[PAGE_SAMPLES] = { "samples", print_samples },
		[PAGE_BRICK] = { "brick", print_brick },
		[PAGE_FACE] = { "face", print_face },
		[PAGE_INFO] = { "information", NULL },
		[PAGE_LABELS] = { "labels", NULL },
		[PAGE_STREAM] = { "stream", print_stream },
	};
	struct page page;
	int rc = page_decode(&page, bytes);

	if (rc < 0)
		return rc;
	fprintf(to, "%s page, %zu bytes, %u children\n", kinds[page.kind].name, bytes.size,
		page.child_count);
	if (kinds[page.kind].print)
		rc = kinds[page.kind].print(to, &page);
	print_children(to, &page);
	page_finish(&page);
	return rc;
}

static int print_patch_group(FILE *to, struct bytes bytes)
{
	struct patch_mesh meshes[GROUP_PATCHES_MAX];
	uint32_t count = 0;
	int rc = patch_group_decode(meshes, &count, bytes);

	if (rc < 0)
		return rc;
	fprintf(to, "patch group, %zu bytes, %u patches\n", bytes.size, count);
	for (uint32_t i = 0; i < count; i++) {
		fprintf(to, "  patch %-4u         %u vertices, %u triangles\n", i,
			meshes[i].vertex_count, meshes[i].triangle_count);
		patch_mesh_finish(&meshes[i]);
	}
	return 0;
}

static int print_labels(FILE *to, struct bytes bytes)
{
	struct label_group labels;
	int rc = label_group_decode(&labels, bytes);

	if (rc < 0)
		return rc;
	fprintf(to, "labels, %zu bytes: %u patches, %u sets of %u parts\n", bytes.size,
		labels.patch_count, labels.set_count, labels.part_count);
	for (uint32_t i = 0; i < labels.part_count; i++) {
		uint32_t whole = 0, crossed = 0;

		for (uint32_t p = 0; p < labels.patch_count; p++) {
			for (uint32_t t = 0; t < labels.patches[p].triangle_count; t++)
				whole += label_holds(&labels, p, t, i);
			for (uint32_t b = 0; b < labels.patches[p].border_count; b++)
				crossed += labels.patches[p].borders[b].part == i;
		}
		fprintf(to, "  %-24s %.2f m2; here %u triangles and %u that its outline crosses\n",
			labels.parts[i].id, (double)labels.parts[i].area_m2, whole, crossed);
	}
	label_group_finish(&labels);
	return 0;
}

static int print_scenery(FILE *to, struct bytes bytes)
{
	struct scenery scenery;
	int rc = scenery_decode(&scenery, bytes);

	if (rc < 0)
		return rc;
	fprintf(to, "scenery, %zu bytes: %u triangles in %u meshes, %u nodes, %u motions\n",
		bytes.size, scenery_triangles(&scenery), scenery.mesh_count, scenery.node_count,
		scenery.motion_count);
	for (uint32_t i = 0; i < scenery.texture_count; i++)
		fprintf(to, "  picture %u: %u x %u pixels, %u bytes\n", i + 1,
			scenery.textures[i].width, scenery.textures[i].height,
			scenery.textures[i].jpeg_bytes);
	for (uint32_t i = 0; i < scenery.layer_count; i++)
		fprintf(to, "  layer %-13u %s\n", i,
			scenery.titles[scenery.layers[i].first_title].text);
	scenery_finish(&scenery);
	return 0;
}

static int print_solid(FILE *to, struct bytes bytes)
{
	struct solid solid;
	double free_m3 = 0;
	int rc = solid_decode(&solid, bytes);

	if (rc < 0)
		return rc;
	for (uint32_t i = 0, level = 0, end = 1; i < solid.node_count; i++) {
		double side_m;

		if (i == end) {
			end = solid.nodes[i].first;
			level++;
		}
		side_m = ldexp((double)solid.cell_m, (int)(solid.depth - level) - 1);
		for (uint32_t child = 0; child < SOLID_CHILDREN; child++)
			if (solid_child_state(&solid.nodes[i], child) == SOLID_FREE)
				free_m3 += side_m * side_m * side_m;
	}
	fprintf(to, "space for the eye, %zu bytes: %u nodes in %u levels\n", bytes.size,
		solid.node_count, solid.depth);
	fprintf(to, "  cells              %.3f m, at least %.3f m from stone\n",
		(double)solid.cell_m, (double)solid.room_m);
	fprintf(to, "  free               %.1f of %.1f m3\n", free_m3,
		pow(ldexp((double)solid.cell_m, (int)solid.depth), 3));
	print_vector(to, "from", solid.low_m);
	solid_finish(&solid);
	return 0;
}

static int print_locator(FILE *to, struct bytes bytes)
{
	struct locator locator;
	uint64_t all = 0;
	int rc = locator_decode(&locator, bytes);

	if (rc < 0)
		return rc;
	for (uint32_t i = 0; i < locator.block_count; i++)
		all += locator.blocks[i].size;
	fprintf(to, "locator, %zu bytes: %u blocks with %" PRIu64 " bytes in %u packs\n",
		bytes.size, locator.block_count, all, locator.pack_count);
	for (uint32_t i = 0; i < locator.pack_count; i++) {
		uint32_t blocks = 0;
		uint64_t used = 0;
		char hex[HASH_HEX_BYTES];

		for (uint32_t k = 0; k < locator.block_count; k++) {
			if (locator.blocks[k].pack != i)
				continue;
			blocks++;
			used += locator.blocks[k].size;
		}
		hash_to_hex(locator.packs[i], hex);
		fprintf(to, "  pack %s  %u blocks, %" PRIu64 " bytes\n", hex, blocks, used);
	}
	locator_finish(&locator);
	return 0;
}

static int print_info(FILE *to, struct bytes bytes)
{
	struct info *info;
	int rc = info_open(&info, bytes);

	if (rc < 0)
		return rc;
	fprintf(to, "information database, %zu bytes: %u parts, %u pictures, languages", bytes.size,
		info_part_count(info), info_picture_count(info));
	for (uint32_t i = 0; i < info_language_count(info); i++)
		fprintf(to, " %s", info_language(info, i));
	fputc('\n', to);
	for (uint32_t i = 0; i < info_part_count(info); i++)
		fprintf(to, "  %-24s %s%s\n", info_part(info, i)->id,
			info_text(info, i, info_language(info, 0)).title,
			info_part(info, i)->has_page ? "" : " (no page)");
	info_close(info);
	return 0;
}

/* Prints what a signed file says. Signatures are not checked here; verify does that. */
static int print_signed(FILE *to, struct bytes bytes)
{
	cJSON *json;
	int rc = json_parse(&json, bytes);
	const cJSON *payload = cJSON_GetObjectItemCaseSensitive(json, "payload"), *signature;
	uint8_t text[METADATA_FILE_BYTES_MAX];
	size_t size = 0;
	cJSON *inner = NULL;
	char *shown = NULL;

	if (bytes.size <= METADATA_FILE_BYTES_MAX && cJSON_IsString(payload) &&
	    sodium_base642bin(text, sizeof(text), payload->valuestring,
			      strlen(payload->valuestring), NULL, &size, NULL,
			      sodium_base64_VARIANT_ORIGINAL) == 0)
		rc = json_parse(&inner, (struct bytes){ text, size });
	if (inner) {
		shown = json_indented(inner);
		rc = shown ? 0 : -ENOMEM;
	}
	if (shown) {
		fprintf(to,
			"signed file, %zu bytes (signatures not checked here, see verify)\n%s\n",
			bytes.size, shown);
		cJSON_ArrayForEach(signature, cJSON_GetObjectItemCaseSensitive(json, "signatures"))
		{
			const cJSON *key = cJSON_GetObjectItemCaseSensitive(signature, "key");

			fprintf(to, "  signed by %s\n",
				cJSON_IsString(key) ? key->valuestring : "?");
		}
	}
	cJSON_free(shown);
	cJSON_Delete(inner);
	cJSON_Delete(json);
	return shown || rc < 0 ? rc : -EBADMSG;
}

/* Prints the size of a picture or, if it does not decode as one, of a tile. */
static int print_picture(FILE *to, struct bytes bytes)
{
	uint8_t rgb[SAMPLE_IMAGE_PX * SAMPLE_IMAGE_PX * 3];
	struct picture picture;
	int rc;

	if (picture_decode(&picture, bytes) == 0) {
		fprintf(to, "picture, %zu bytes, %u x %u pixels\n", bytes.size, picture.width,
			picture.height);
		picture_finish(&picture);
		return 0;
	}
	rc = tile_decode(rgb, SAMPLE_IMAGE_PX, bytes);
	if (rc == 0)
		fprintf(to, "tile, %zu bytes, %d x %d pixels\n", bytes.size, SAMPLE_IMAGE_PX,
			SAMPLE_IMAGE_PX);
	return rc;
}

int inspect_bytes(FILE *to, struct bytes bytes)
{
	static const struct {
		const char *magic;
		int (*print)(FILE *, struct bytes);
	} forms[] = {
		{ "GPag", print_page },
		{ "GPpg", print_patch_group },
		{ "GPlb", print_labels },
		{ "GPsy", print_scenery },
		{ "GPso", print_solid },
		{ "GLoc", print_locator },
		{ "SQLite format 3", print_info },
		{ "{", print_signed },
		{ "\xff\xd8", print_picture },
		{ "\x89PNG", print_picture },
	};
	int rc = -EBADMSG;

	for (size_t i = 0; i < ARRAY_COUNT(forms); i++) {
		size_t size = strlen(forms[i].magic);

		if (bytes.size < size || memcmp(bytes.data, forms[i].magic, size) != 0)
			continue;
		rc = forms[i].print(to, bytes);
		if (rc == -ENOMEM)
			fprintf(to, "cannot be decoded: no memory is left\n");
		else if (rc < 0)
			fprintf(to,
				"damaged: begins like an object of a release, but cannot be decoded\n");
		return rc;
	}
	fprintf(to, "%zu bytes of an unknown format\n", bytes.size);
	return rc;
}
