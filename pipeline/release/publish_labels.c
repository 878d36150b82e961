/* Publishes the labels page: labels every published patch group by the scan, or takes the labels
 * from the cache. */
#include "pipeline/release/publish_labels.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/log.h"
#include "base/parallel.h"
#include "base/progress.h"
#include "format/hierarchy.h"
#include "geometry/vec.h"
#include "pipeline/release/label_cache.h"
#include "pipeline/release/label_patch.h"

/* The groups as published, and their labels. */
struct labelling {
	struct object_store *objects;
	struct page page; /* the hierarchy page; page_bytes holds its payload */
	struct buffer page_bytes;
	struct hierarchy hierarchy;
	const struct label_source *source;
	struct lattice lattice;
	struct buffer *groups; /* owned; patch group objects */
	struct buffer *labels; /* owned; the label object of each group, empty: none */
	struct progress *progress;
};

/* ---- the parts */

/* Lists the parts that have a surface. Returns how many. */
static uint32_t list_parts(struct label_source_part *parts, const struct info *info,
			   const struct sources *sources)
{
	uint32_t count = 0;

	for (uint32_t i = 0; i < info_part_count(info); i++) {
		const struct info_part *from = info_part(info, i);
		struct label_source_part *part = &parts[count];
		struct sources_faces faces = { 0 };

		*part = (struct label_source_part){ .id = from->id };
		part->region = from->region;
		part->is_list = sources_faces_of(sources, from->id, &faces);
		part->list = faces.key;
		count += part->is_list || part->region.kind != REGION_POINT;
	}
	return count;
}

static int open_info(struct object_store *objects, const struct page_child *child,
		     struct info **info)
{
	struct buffer page_bytes, image;
	struct page page = { 0 };
	int rc = object_store_read_page(objects, child, &page, &page_bytes);

	buffer_init(&image, OBJECT_BYTES_MAX);
	if (rc == 0)
		rc = object_store_read(objects, page.children[0].hash, &image);
	if (rc == 0)
		rc = info_open(info, buffer_bytes(&image));
	page_finish(&page);
	buffer_finish(&page_bytes);
	buffer_finish(&image);
	return rc;
}

/* ---- the groups */

/* The resolution of outlines, metres: the spacing of the scan. On coarser patches, which are seen
 * from afar, it is the smallest error of the patches, if that is larger. */
static float cell_of(const struct labelling *l, uint32_t group)
{
	const struct hierarchy_group *g = &l->hierarchy.groups[group];
	float error_m = INFINITY;

	for (uint32_t p = g->first_patch; p < g->first_patch + g->patch_count; p++) {
		uint32_t finer = l->hierarchy.patches[p].finer;

		error_m = vec_least(
			error_m, finer == HIERARCHY_NONE ? 0 : l->hierarchy.groups[finer].error_m);
	}
	return vec_most(label_source_spacing_m(l->source), error_m);
}

static int label_one(void *user, uint32_t piece, uint32_t worker)
{
	struct labelling *l = user;
	struct patch_mesh meshes[GROUP_PATCHES_MAX];
	struct label_group labels = { 0 };
	uint32_t count = 0;
	int rc = patch_group_decode(meshes, &count, buffer_bytes(&l->groups[piece]));

	(void)worker;
	if (rc < 0)
		return rc;
	rc = label_patch_group(&labels, l->source, &l->lattice, meshes, count, cell_of(l, piece));
	if (rc == 0 && labels.part_count > 0)
		rc = label_group_encode(&l->labels[piece], &labels);
	label_group_finish(&labels);
	for (uint32_t p = 0; p < count; p++)
		patch_mesh_finish(&meshes[p]);
	progress_add(l->progress, 1);
	return rc;
}

static int open_groups(struct labelling *l, const struct page_child *hierarchy)
{
	int rc = object_store_read_page(l->objects, hierarchy, &l->page, &l->page_bytes);

	if (rc == 0)
		rc = hierarchy_decode(&l->hierarchy, l->page.payload);
	if (rc < 0)
		return rc;
	l->groups = calloc(l->page.child_count + 1, sizeof(*l->groups));
	l->labels = calloc(l->page.child_count + 1, sizeof(*l->labels));
	if (!l->groups || !l->labels)
		return -ENOMEM;
	for (uint32_t g = 0; g < l->page.child_count; g++) {
		buffer_init(&l->groups[g], OBJECT_BYTES_MAX);
		buffer_init(&l->labels[g], OBJECT_BYTES_MAX);
	}
	return rc;
}

static int read_groups(struct labelling *l)
{
	int rc = 0;

	for (uint32_t g = 0; rc == 0 && g < l->page.child_count; g++)
		rc = object_store_read(l->objects, l->page.children[g].hash, &l->groups[g]);
	return rc;
}

static int label_all(struct labelling *l)
{
	long processors = sysconf(_SC_NPROCESSORS_ONLN);
	int rc;

	l->progress = progress_start("labelling", "groups", l->page.child_count);
	rc = parallel_run(processors > 0 ? (uint32_t)processors : 1, l->page.child_count, label_one,
			  l);
	progress_end(l->progress);
	return rc;
}

static void labelling_finish(struct labelling *l)
{
	for (uint32_t g = 0; l->groups && l->labels && g < l->page.child_count; g++) {
		buffer_finish(&l->groups[g]);
		buffer_finish(&l->labels[g]);
	}
	free(l->groups);
	free(l->labels);
	hierarchy_finish(&l->hierarchy);
	page_finish(&l->page);
	buffer_finish(&l->page_bytes);
}

/* ---- the page */

static int add_page(struct labelling *l, struct page_child *out)
{
	const uint32_t groups = l->page.child_count;
	uint32_t *child_of_group = calloc(groups + 1, sizeof(*child_of_group));
	struct page page = { .kind = PAGE_LABELS };
	struct buffer payload;
	int rc = 0;

	buffer_init(&payload, PAGE_BYTES_MAX);
	page.children = calloc(groups + 1, sizeof(*page.children));
	if (!child_of_group || !page.children)
		rc = -ENOMEM;
	for (uint32_t g = 0; rc == 0 && g < groups; g++) {
		child_of_group[g] = LABEL_NONE;
		if (l->labels[g].size == 0)
			continue;
		child_of_group[g] = page.child_count;
		rc = object_store_add(l->objects, buffer_bytes(&l->labels[g]),
				      &page.children[page.child_count++]);
	}
	if (rc == 0) {
		label_page_encode(&payload, child_of_group, groups);
		page.payload = buffer_bytes(&payload);
		rc = payload.error;
	}
	if (rc == 0)
		rc = object_store_add_page(l->objects, &page, out);
	buffer_finish(&payload);
	free(page.children);
	free(child_of_group);
	return rc;
}

static int label_by_scan(struct labelling *l, struct label_source_part *parts, uint32_t count,
			 struct sources *sources, struct diagnostics *diagnostics)
{
	struct label_source *source = NULL;
	const struct mesh *mesh;
	int rc = scans_get_mesh(sources_scans(sources), &mesh, diagnostics);

	if (rc == 0)
		rc = sources_find_faces(sources, diagnostics);
	for (uint32_t i = 0; rc == 0 && i < count; i++) {
		struct sources_faces faces;

		if (!sources_faces_of(sources, parts[i].id, &faces))
			continue;
		parts[i].triangles = faces.triangles;
		parts[i].triangle_count = faces.triangle_count;
	}
	if (rc == 0)
		rc = label_source_create(&source, mesh, parts, count);
	l->source = source;
	if (rc == 0)
		rc = read_groups(l);
	if (rc == 0)
		rc = label_all(l);
	label_source_destroy(source);
	return rc;
}

static int make_labels(struct labelling *l, struct label_source_part *parts, uint32_t count,
		       struct sources *sources, const struct page_child *hierarchy,
		       struct page_child *out)
{
	char path[CONTENT_PATH_BYTES];
	struct diagnostics diagnostics = { 0 };
	struct hash scans, key;
	int rc = open_groups(l, hierarchy);

	if (rc == 0)
		rc = scans_key(sources_scans(sources), &scans, &diagnostics);
	if (rc == 0)
		rc = label_cache_key(&key, scans, hierarchy->hash, parts, count);
	if (rc == 0)
		rc = content_work_path(sources_content(sources), "labels", path);
	if (rc == 0 && label_cache_load(l->labels, l->page.child_count, key, path) < 0) {
		rc = label_by_scan(l, parts, count, sources, &diagnostics);
		if (rc == 0)
			rc = label_cache_save(l->labels, l->page.child_count, key, path);
	}
	if (rc == 0)
		rc = add_page(l, out);
	if (diagnostics.count > 0)
		log_error("pipeline", "%s", diagnostics_cause(&diagnostics, rc));
	labelling_finish(l);
	return rc;
}

int publish_labels(struct object_store *objects, const struct root_page *root,
		   struct sources *sources, const struct page_child children[ROOT_CHILD_COUNT],
		   struct page_child *out)
{
	struct labelling l = { .objects = objects, .lattice = root->lattice };
	struct label_source_part *parts = NULL;
	struct info *info = NULL;
	uint32_t count = 0;
	int rc = open_info(objects, &children[ROOT_CHILD_INFO], &info);

	if (rc == 0) {
		parts = calloc(info_part_count(info) + 1, sizeof(*parts));
		rc = parts ? 0 : -ENOMEM;
	}
	if (rc == 0)
		count = list_parts(parts, info, sources);
	if (rc == 0 && count > 0)
		rc = make_labels(&l, parts, count, sources, &children[ROOT_CHILD_HIERARCHY], out);
	if (rc < 0)
		log_error("pipeline", "the labels: %s", strerror(-rc));
	free(parts);
	info_close(info);
	return rc < 0 ? rc : count > 0;
}
