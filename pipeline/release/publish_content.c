/* Collects the parts of a release from a content folder (hierarchy, samples, information, labels)
 * and publishes them with the folder's keys. */
#include "pipeline/release/publish_content.h"

#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include "base/log.h"
#include "pipeline/content/start_view.h"
#include "pipeline/hierarchy/master.h"
#include "pipeline/keys/keys_place.h"
#include "pipeline/release/publish_budget.h"
#include "pipeline/release/publish_hierarchy.h"
#include "pipeline/release/publish_info.h"
#include "pipeline/release/publish_labels.h"
#include "pipeline/release/publish_samples.h"
#include "pipeline/release/publish_scenery.h"
#include "pipeline/release/publish_solid.h"
#include "pipeline/release/publish_stream.h"
#include "pipeline/release/published.h"
#include "pipeline/release/release_tuf.h"

/* The target folder and the signing keys. */
struct destination {
	char keys_folder[PATH_MAX];
	struct publisher_keys keys;
	struct publish_target target;
};

static int open_keys(struct destination *destination, const struct publish_content_options *options)
{
	bool made;
	const struct content *content = sources_content(options->sources);
	int rc = keys_open(content->tuf_alone ? NULL : &destination->keys, destination->keys_folder,
			   content->folder, options->keys, &made);

	if (rc == 0 && made)
		log_info(
			"pipeline",
			"made signing keys in %s: keep a copy of root.key in a safe place, and give "
			"terminals root/1.json",
			destination->keys_folder);
	return rc;
}

static int destination_init(struct destination *destination, char release[PATH_MAX],
			    const struct publish_content_options *options)
{
	const struct content *content = sources_content(options->sources);
	int size = options->out ? snprintf(release, PATH_MAX, "%s", options->out)
				: snprintf(release, PATH_MAX, "%s/../release", content->folder);

	if (size >= PATH_MAX)
		return -ENAMETOOLONG;
	destination->target = (struct publish_target){ .release = release,
						       .keys_folder = destination->keys_folder,
						       .keys = &destination->keys,
						       .tuf_alone = content->tuf_alone,
						       .tuf_target = content->tuf_target,
						       .tuf_role = content->tuf_role,
						       .unsigned_folder = options->unsigned_folder,
						       .trust_clock = options->trust_clock,
						       .above = options->above,
						       .comment = options->comment,
						       .release_life_s = options->release_life_s };
	if (!content->tuf_alone && (options->unsigned_folder || content->tuf_role[0])) {
		log_error("pipeline",
			  "%s/temple.ini: only releases in the form of The Update Framework alone "
			  "can be signed elsewhere or by a role: metadata = tuf in [release]",
			  content->folder);
		return -EINVAL;
	}
	return open_keys(destination, options);
}

/* Measures the current release by its locator. Errors of pack_read_whole. */
static int measure(struct publish_content_report *report)
{
	struct locator locator;
	int rc = pack_read_whole(&locator, report->release, report->publish.release.root);

	for (uint32_t i = 0; rc == 0 && i < locator.block_count; i++)
		report->release_bytes += locator.blocks[i].size;
	report->release_packs = locator.pack_count;
	locator_finish(&locator);
	return rc;
}

/* ---- the root page */

/* Decides whether the model is lit. Only "auto" depends on the scans. */
static int judge_light(bool *lit, struct scans *scans)
{
	const struct content *content = scans_content(scans);
	const struct scans_shape *shape = NULL;
	struct diagnostics diagnostics = { 0 };
	int rc =
		content->lit == CONTENT_LIT_AUTO ? scans_get_shape(scans, &shape, &diagnostics) : 0;

	if (rc < 0)
		log_error("pipeline", "%s", diagnostics_cause(&diagnostics, rc));
	else
		*lit = content_is_lit(content, shape && shape->had_pictures);
	return rc;
}

static int fill_root(struct root_page *root, struct scans *scans, const struct master *master)
{
	const struct content *content = scans_content(scans);
	bool lit = false;
	int rc = judge_light(&lit, scans);

	snprintf(root->name, sizeof(root->name), "%s", content->name);
	root->lattice = master->lattice;
	memcpy(root->box_min_m, master->box_min_m, sizeof(root->box_min_m));
	memcpy(root->box_max_m, master->box_max_m, sizeof(root->box_max_m));
	memcpy(root->sun, content->sun, sizeof(root->sun));
	memcpy(root->background, content->background, sizeof(root->background));
	root->source_triangles = master->source_triangles;
	root->lit = lit;
	root->cut = (uint8_t)content->cut;
	start_view(root->start_eye_m, root->start_target_m, root->box_min_m, root->box_max_m);
	if (content->has_start) {
		memcpy(root->start_eye_m, content->start_eye_m, sizeof(root->start_eye_m));
		memcpy(root->start_target_m, content->start_target_m, sizeof(root->start_target_m));
	}
	return rc;
}

/* ---- the parts */

static int open_master(struct master **master, const struct content *content)
{
	char folder[CONTENT_PATH_BYTES];
	int rc = content_work_path(content, "master", folder);

	*master = NULL;
	if (rc == 0)
		rc = master_open(master, folder, NULL);
	if (rc < 0)
		log_error("pipeline", "%s: %s; run 'gopura-content build' or 'hierarchy' first",
			  folder, strerror(-rc));
	return rc;
}

static int add_hierarchy(struct object_store *objects, struct root_page *root,
			 struct sources *sources, struct page_child *out, uint64_t *patch_bytes)
{
	const struct content *content = sources_content(sources);
	struct published_patches published = { 0 };
	struct master *master;
	int rc = open_master(&master, content);

	if (rc == 0)
		rc = fill_root(root, sources_scans(sources), master);
	if (rc == 0)
		rc = publish_hierarchy(objects, master, content->publish_share, out, &published);
	root->published_triangles = published.triangle_count;
	*patch_bytes = published.bytes;
	master_destroy(master);
	return rc;
}

/* Opens the samples. With a budget their pages are made twice: first with the smallest tiles. */
static int add_samples(struct object_store *objects, struct samples_store **store,
		       const struct content *content, struct page_child *out)
{
	int rc = samples_store_open(store, content->folder);

	if (rc == 0 && content->budget_bytes > 0)
		rc = publish_budget_begin(*store);
	return rc < 0 ? rc : publish_samples(objects, *store, out);
}

/* Adds what a release may lack: the streaming mesh, scenery, the octree of where an eye may be. */
static int add_extras(struct object_store *objects, struct root_page *root, struct sources *sources,
		      const struct info_built *built, struct page_child *children,
		      uint32_t *child_count)
{
	struct info *info = NULL;
	int rc = publish_stream(objects, &root->lattice, &children[ROOT_CHILD_HIERARCHY],
				&children[*child_count]);

	root->has_stream = rc == 1;
	*child_count += root->has_stream;
	if (rc >= 0)
		rc = publish_scenery(objects, sources, &children[*child_count]);
	root->has_scenery = rc == 1;
	*child_count += root->has_scenery;
	if (rc >= 0)
		rc = info_open(&info, buffer_bytes(&built->database));
	if (rc == 0)
		rc = publish_solid(objects, root, &children[ROOT_CHILD_HIERARCHY], info,
				   &children[*child_count]);
	info_close(info);
	root->has_solid = rc == 1;
	*child_count += root->has_solid;
	return rc;
}

static int publish_objects(struct publish_content_report *report,
			   const struct publish_target *target, struct object_store *objects,
			   struct sources *sources)
{
	const struct content *content = sources_content(sources);
	struct samples_store *store = NULL;
	struct page_child children[ROOT_CHILDREN_MAX];
	uint32_t child_count = ROOT_CHILD_COUNT;
	const struct info_built *info;
	struct root_page root = { 0 };
	int rc = add_hierarchy(objects, &root, sources, &children[ROOT_CHILD_HIERARCHY],
			       &report->patch_bytes);

	if (rc == 0)
		rc = add_samples(objects, &store, content, &children[ROOT_CHILD_SAMPLES]);
	if (rc == 0)
		rc = sources_info(sources, &info);
	if (rc == 0)
		rc = publish_info(objects, info, content->folder, &children[ROOT_CHILD_INFO]);
	if (rc == 0)
		rc = publish_labels(objects, &root, sources, children,
				    &children[ROOT_CHILD_LABELS]);
	scans_drop_mesh(sources_scans(sources));
	if (rc > 0)
		child_count = ROOT_CHILD_LABELS + 1;
	if (rc >= 0)
		rc = add_extras(objects, &root, sources, info, children, &child_count);
	if (rc >= 0 && content->budget_bytes > 0)
		rc = publish_budget_meet(
			&report->budget, objects, store, children, child_count, &root,
			content->quality_rule == CONTENT_QUALITY_GAIN ? TILE_CHOICE_GAIN
								      : TILE_CHOICE_QUALITY,
			content->budget_bytes);
	samples_store_close(store);
	if (rc >= 0)
		rc = publish_parts(&report->publish, target, objects, &root, children, child_count);
	report->published_triangles = root.published_triangles;
	memcpy(report->start_eye_m, root.start_eye_m, sizeof(root.start_eye_m));
	memcpy(report->start_target_m, root.start_target_m, sizeof(root.start_target_m));
	report->lit = root.lit;
	return rc;
}

int publish_content(struct publish_content_report *report,
		    const struct publish_content_options *options)
{
	struct object_store *objects = NULL;
	struct destination destination = { 0 };
	int rc;

	*report = (struct publish_content_report){ 0 };
	rc = destination_init(&destination, report->release, options);
	if (rc == 0)
		rc = object_store_create(&objects);
	if (rc == 0)
		rc = publish_objects(report, &destination.target, objects, options->sources);
	object_store_destroy(objects);
	keys_finish(&destination.keys);
	return rc < 0 ? rc : measure(report);
}

int publish_content_again(struct publish_content_report *report,
			  const struct publish_content_options *options, uint64_t sequence)
{
	struct destination destination = { 0 };
	int rc;

	*report = (struct publish_content_report){ 0 };
	rc = destination_init(&destination, report->release, options);
	if (rc == 0)
		rc = publish_again(&report->publish, &destination.target, sequence);
	keys_finish(&destination.keys);
	return rc < 0 ? rc : measure(report);
}

static int look_at_current(struct publish_content_report *report,
			   const struct publish_content_options *options, bool renew)
{
	struct destination destination = { 0 };
	int rc;

	*report = (struct publish_content_report){ 0 };
	rc = destination_init(&destination, report->release, options);
	if (rc == 0) {
		rc = published_current(&destination.target, &report->publish.release);
		if (rc == 0)
			rc = measure(report);
		if (renew && (rc == -ENOENT || rc == -ENODATA))
			log_error("pipeline",
				  "%s: there is no whole release that the present keys have "
				  "signed: run `gopura-content publish` or `build`, which make one",
				  report->release);
	}
	if (rc == 0 && renew)
		rc = publish_renew(&report->publish, &destination.target);
	keys_finish(&destination.keys);
	return rc;
}

int publish_content_add_signatures(struct publish_content_report *report,
				   const struct publish_content_options *options,
				   const char *staged_folder)
{
	struct destination destination = { 0 };
	struct tuf_place place;
	int rc;

	*report = (struct publish_content_report){ 0 };
	rc = destination_init(&destination, report->release, options);
	place = published_place(&destination.target);
	if (rc == 0)
		rc = release_tuf_add_signatures(&place, staged_folder);
	if (rc == 0) {
		published_drop_earlier(&destination.target);
		rc = published_current(&destination.target, &report->publish.release);
	}
	keys_finish(&destination.keys);
	report->publish.changed = rc == 0;
	return rc < 0 ? rc : measure(report);
}

int publish_content_current(struct publish_content_report *report,
			    const struct publish_content_options *options)
{
	return look_at_current(report, options, false);
}

int publish_content_renew(struct publish_content_report *report,
			  const struct publish_content_options *options)
{
	return look_at_current(report, options, true);
}

void publish_content_print(FILE *to, const struct publish_content_report *report)
{
	const struct publish_report *publish = &report->publish;
	char hex[HASH_HEX_BYTES];

	hash_to_hex(publish->release.root, hex);
	fprintf(to, "release %" PRIu64 "%s in %s: %.1f MB in %u packs, root %s\n",
		publish->release.sequence, publish->changed ? "" : " (nothing changed)",
		report->release, (double)report->release_bytes / 1e6, report->release_packs, hex);
	if (publish->packs.blocks_written > 0)
		fprintf(to, "written %.1f MB in %u new packs, reused %.1f MB\n",
			(double)publish->packs.written_bytes / 1e6, publish->packs.packs_written,
			(double)publish->packs.reused_bytes / 1e6);
}
