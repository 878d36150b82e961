#include <errno.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "base/log.h"
#include "pipeline/publish_sources.h"

struct candidate {
	uint32_t group;
	float error_m;
};

/* Coarsest first. Errors never grow towards the finer groups, and where they are equal the order of
 * the hierarchy decides, so a group comes after all that it refines. */
static int compare_candidates(const void *a, const void *b)
{
	const struct candidate *left = a, *right = b;

	if (left->error_m != right->error_m)
		return left->error_m > right->error_m ? -1 : 1;
	return left->group < right->group ? -1 : 1;
}

static uint64_t triangles_of(const struct hierarchy *hierarchy, uint32_t group)
{
	const struct hierarchy_group *at = &hierarchy->groups[group];
	uint64_t triangles = 0;

	for (uint32_t i = 0; i < at->patch_count; i++)
		triangles += hierarchy->patches[at->first_patch + i].triangle_count;
	return triangles;
}

/* How many patches of groups that are not chosen (yet) each group replaces. */
static uint32_t *count_missing(const struct hierarchy *hierarchy)
{
	uint32_t *missing = calloc(hierarchy->group_count, sizeof(*missing));

	for (uint32_t i = 0; missing && i < hierarchy->patch_count; i++)
		if (hierarchy->patches[i].finer != HIERARCHY_NONE)
			missing[hierarchy->patches[i].finer]++;
	return missing;
}

static void choose(bool *chosen, uint32_t *missing, const struct hierarchy *hierarchy,
		   uint32_t group)
{
	const struct hierarchy_group *at = &hierarchy->groups[group];

	chosen[group] = true;
	for (uint32_t i = 0; i < at->patch_count; i++) {
		uint32_t finer = hierarchy->patches[at->first_patch + i].finer;

		if (finer != HIERARCHY_NONE)
			missing[finer]--;
	}
}

int publish_choose_groups(bool *chosen, const struct publish_master *master, double share,
			  uint64_t *published_triangles)
{
	const struct hierarchy *hierarchy = master->hierarchy;
	uint64_t most = (uint64_t)(share * (double)master->source_triangles);
	struct candidate *candidates = calloc(hierarchy->group_count, sizeof(*candidates));
	uint32_t *missing = count_missing(hierarchy);
	uint64_t total = 0;

	if (!candidates || !missing) {
		free(candidates);
		free(missing);
		return -ENOMEM;
	}
	for (uint32_t i = 0; i < hierarchy->group_count; i++)
		candidates[i] = (struct candidate){ i, hierarchy->groups[i].error_m };
	qsort(candidates, hierarchy->group_count, sizeof(*candidates), compare_candidates);
	memset(chosen, 0, hierarchy->group_count * sizeof(*chosen));
	for (uint32_t i = 0; i < hierarchy->group_count; i++) {
		uint32_t group = candidates[i].group;
		uint64_t triangles = triangles_of(hierarchy, group);

		if (missing[group] > 0 || (group > 0 && total + triangles > most))
			continue;
		choose(chosen, missing, hierarchy, group);
		total += triangles;
	}
	free(candidates);
	free(missing);
	*published_triangles = total;
	return 0;
}

/* The chosen part of the hierarchy, numbered anew. */
static int extract(struct hierarchy *out, const struct hierarchy *from, const bool *chosen)
{
	uint32_t *number = calloc(from->group_count, sizeof(*number));

	*out = (struct hierarchy){ 0 };
	out->groups = calloc(from->group_count, sizeof(*out->groups));
	out->patches = calloc(from->patch_count, sizeof(*out->patches));
	if (!number || !out->groups || !out->patches) {
		free(number);
		hierarchy_finish(out);
		return -ENOMEM;
	}
	for (uint32_t i = 0; i < from->group_count; i++) {
		if (!chosen[i])
			continue;
		number[i] = out->group_count;
		out->groups[out->group_count] = from->groups[i];
		out->groups[out->group_count].first_patch = out->patch_count;
		for (uint32_t k = 0; k < from->groups[i].patch_count; k++) {
			struct hierarchy_patch *patch = &out->patches[out->patch_count++];

			*patch = from->patches[from->groups[i].first_patch + k];
			patch->group = out->group_count;
		}
		out->group_count++;
	}
	for (uint32_t i = 0; i < out->patch_count; i++) {
		uint32_t finer = out->patches[i].finer;

		out->patches[i].finer =
			finer != HIERARCHY_NONE && chosen[finer] ? number[finer] : HIERARCHY_NONE;
	}
	free(number);
	return 0;
}

static int add_groups(struct object_store *objects, const struct publish_master *master,
		      const bool *chosen, struct page_child *children)
{
	struct buffer object;
	uint32_t next = 0;
	int rc = 0;

	buffer_init(&object, OBJECT_BYTES_MOST);
	for (uint32_t i = 0; rc == 0 && i < master->hierarchy->group_count; i++) {
		if (!chosen[i])
			continue;
		buffer_clear(&object);
		rc = master->read_group(master->data, i, &object);
		if (rc == 0)
			rc = object_store_add(objects, buffer_bytes(&object), &children[next++]);
	}
	buffer_finish(&object);
	return rc;
}

static int add_page(struct object_store *objects, const struct hierarchy *hierarchy,
		    struct page_child *children, struct page_child *out)
{
	struct page page = { .kind = PAGE_HIERARCHY,
			     .child_count = hierarchy->group_count,
			     .children = children };
	struct buffer payload;
	int rc;

	buffer_init(&payload, PAGE_BYTES_MOST);
	rc = hierarchy_encode(&payload, hierarchy);
	page.payload = buffer_bytes(&payload);
	if (rc == 0)
		rc = object_store_add_page(objects, &page, out);
	if (rc < 0)
		log_error("pipeline", "the hierarchy page: %s%s", strerror(-rc),
			  rc == -EFBIG ? "; publish a smaller share" : "");
	buffer_finish(&payload);
	return rc;
}

int publish_hierarchy(struct object_store *objects, const struct publish_master *master,
		      double share, struct page_child *out, uint64_t *published_triangles)
{
	uint32_t count = master->hierarchy->group_count;
	struct page_child *children = calloc(count, sizeof(*children));
	bool *chosen = calloc(count, sizeof(*chosen));
	struct hierarchy part = { 0 };
	int rc = children && chosen ? 0 : -ENOMEM;

	if (rc == 0)
		rc = publish_choose_groups(chosen, master, share, published_triangles);
	if (rc == 0 && (double)*published_triangles > share * (double)master->source_triangles)
		log_warn("pipeline",
			 "the coarsest cut alone has %" PRIu64 " of the scan's %" PRIu64
			 " triangles, more than the published share of %.1f %%",
			 *published_triangles, master->source_triangles, 100.0 * share);
	if (rc == 0)
		rc = extract(&part, master->hierarchy, chosen);
	if (rc == 0)
		rc = add_groups(objects, master, chosen, children);
	if (rc == 0)
		rc = add_page(objects, &part, children, out);
	hierarchy_finish(&part);
	free(children);
	free(chosen);
	return rc;
}
