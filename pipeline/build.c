/* Runs the stages from content folder to release, and skips them if a stamp over all inputs shows
 * that nothing has changed. */
#include "pipeline/build.h"

#include <dirent.h>
#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/log.h"
#include "base/resource_usage.h"
#include "pipeline/hierarchy/master.h"
#include "pipeline/samples/sampler.h"

enum { STAMP_TEXT_BYTES_MAX = 64 << 20, PROGRAM_BYTES_MAX = 256 << 20, LEFTOVER_AGE_S = 3600 };

/* ---- has anything changed since the last build? */

static int fail(const struct diagnostics *diagnostics, int rc)
{
	log_error("pipeline", "%s", diagnostics_cause(diagnostics, rc));
	return rc;
}

static void put_state(struct buffer *text, const char *path, uint64_t bytes, struct timespec time)
{
	buffer_put_string(text, path);
	buffer_put_u64(text, bytes);
	buffer_put_u64(text, (uint64_t)time.tv_sec);
	buffer_put_u32(text, (uint32_t)time.tv_nsec);
}

static void put_file(struct buffer *text, const char *path)
{
	struct stat info = { 0 };

	if (stat(path, &info) < 0)
		info = (struct stat){ 0 };
	put_state(text, path, (uint64_t)info.st_size, info.st_mtim);
}

static int is_shown(const struct dirent *entry)
{
	return entry->d_name[0] != '.';
}

/* With the folders in it, but for those behind links. */
static void put_folder(struct buffer *text, const char *folder)
{
	char path[PATH_MAX];
	struct dirent **entries = NULL;
	int count = scandir(folder, &entries, is_shown, alphasort);

	for (int i = 0; i < count; i++) {
		struct stat info;

		if (snprintf(path, sizeof(path), "%s/%s", folder, entries[i]->d_name) < PATH_MAX) {
			put_file(text, path);
			if (lstat(path, &info) == 0 && S_ISDIR(info.st_mode))
				put_folder(text, path);
		}
		free(entries[i]);
	}
	free(entries);
}

/* Hashes the program itself, because another version may make another release from the same
 * content. */
static int put_program(struct buffer *text)
{
	struct buffer program;
	struct hash hash;
	int rc;

	buffer_init(&program, PROGRAM_BYTES_MAX);
	rc = buffer_read_file(&program, "/proc/self/exe");
	hash = hash_of(buffer_bytes(&program));
	buffer_put(text, hash.bytes, HASH_BYTES);
	buffer_finish(&program);
	return rc;
}

/* Hashes everything that a release is made from. */
static int make_stamp(struct hash *out, struct sources *sources,
		      const struct build_options *options)
{
	const struct content *content = sources_content(sources);
	static const char *const names[] = { "parts.json", "tours.json", "scenes.json" };
	char path[CONTENT_PATH_BYTES + 16];
	struct diagnostics diagnostics = { 0 };
	struct hash scans;
	struct buffer text;
	int rc = scans_key(sources_scans(sources), &scans, &diagnostics);

	if (rc < 0)
		return fail(&diagnostics, rc);
	buffer_init(&text, STAMP_TEXT_BYTES_MAX);
	rc = put_program(&text);
	buffer_put(&text, scans.bytes, HASH_BYTES);
	buffer_put_u8(&text, content->binary_tree);
	buffer_put_u64(&text, content->budget_bytes);
	buffer_put_string(&text, options->out ? options->out : "");
	buffer_put_string(&text, options->comment ? options->comment : "");
	/* As it was read: somebody may have changed it since. */
	put_state(&text, "temple.ini", content->settings_bytes, content->settings_time);
	for (size_t i = 0; i < ARRAY_COUNT(names); i++) {
		snprintf(path, sizeof(path), "%s/%s", content->folder, names[i]);
		put_file(&text, path);
	}
	for (const char *const *folder = content_folders; *folder; folder++) {
		snprintf(path, sizeof(path), "%s/%s", content->folder, *folder);
		put_folder(&text, path);
	}
	*out = hash_of(buffer_bytes(&text));
	if (rc == 0)
		rc = text.error;
	buffer_finish(&text);
	return rc;
}

/* Contents of the stamp file after a release was made: the stamp, and the root of that release. */
struct stamp_file {
	char text[2 * HASH_HEX_BYTES + 1];
};

static struct stamp_file stamp_text(struct hash stamp, struct hash root)
{
	struct stamp_file file;
	char first[HASH_HEX_BYTES], second[HASH_HEX_BYTES];

	hash_to_hex(stamp, first);
	hash_to_hex(root, second);
	snprintf(file.text, sizeof(file.text), "%s %s\n", first, second);
	return file;
}

/* Sets nothing_changed if the current release was built from exactly these inputs and is complete.
 * What runs out of it is then signed anew, which may fail. -EKEYREJECTED: these keys cannot
 * publish, which is logged. */
static int renew_if_built(struct build_report *report, const char *stamp_path, struct hash stamp,
			  const struct publish_content_options *publish)
{
	struct stamp_file expected;
	struct buffer file;
	int rc;

	if (access(stamp_path, R_OK) < 0)
		return 0;
	rc = publish_content_current(&report->publish, publish);
	if (rc < 0)
		return rc == -EKEYREJECTED ? rc : 0;
	expected = stamp_text(stamp, report->publish.publish.release.root);
	buffer_init(&file, sizeof(expected.text));
	report->nothing_changed = buffer_read_file(&file, stamp_path) == 0 &&
				  file.size == strlen(expected.text) &&
				  memcmp(file.data, expected.text, file.size) == 0;
	buffer_finish(&file);
	return report->nothing_changed ? publish_content_renew(&report->publish, publish) : 0;
}

/* ---- the stages */

static struct master_options master_options(const struct content *content,
					    const struct build_master_options *options)
{
	return (struct master_options){
		.multires = { .kind = content->binary_tree ? MULTIRES_TREE : MULTIRES_GROUPS,
			      .simplifier = content->simplify_features ? MULTIRES_FEATURES
								       : MULTIRES_QUADRIC,
			      .patch_triangles = content->patch_triangles,
			      .block_triangles = content->block_triangles,
			      .step_max_m = content->lattice_mm / 1000,
			      .jobs = options->jobs,
			      .shard = options->shard },
		.material_colours = content->colours == CONTENT_COLOURS_PROCEDURAL,
		.substance = content->substance,
	};
}

static int make_master(const char *folder, struct scans *scans, struct hash stamp,
		       const struct master_options *options, struct master_report *report,
		       struct diagnostics *diagnostics)
{
	const struct mesh *mesh;
	int rc = scans_get_mesh(scans, &mesh, diagnostics);

	if (rc == 0)
		rc = master_build(folder, mesh, stamp, options, report);
	if (rc == -E2BIG)
		diagnostics_add(diagnostics, rc, folder, 0,
				"the coarsest patches do not fit in one group; use --hierarchy "
				"groups");
	if (rc == -EPROTO)
		diagnostics_add(diagnostics, rc, folder, 0,
				"its groups break a rule of their format, which is a fault of this "
				"program: please report it");
	return rc;
}

/* Finds where the master lies and what its stamp must be. */
static int locate_master(char folder[CONTENT_PATH_BYTES], struct hash *stamp, struct scans *scans,
			 const struct master_options *options, struct diagnostics *diagnostics)
{
	struct hash key;
	int rc = content_work_path(scans_content(scans), "master", folder);

	if (rc == 0)
		rc = scans_key(scans, &key, diagnostics);
	if (rc == 0)
		*stamp = master_stamp(key, options);
	return rc;
}

int build_master(struct master **out, struct scans *scans,
		 const struct build_master_options *options, struct build_master_report *report,
		 struct diagnostics *diagnostics)
{
	const struct content *content = scans_content(scans);
	const struct master_options master = master_options(content, options);
	char folder[CONTENT_PATH_BYTES];
	struct hash stamp;
	int rc = locate_master(folder, &stamp, scans, &master, diagnostics);

	*out = NULL;
	*report = (struct build_master_report){ 0 };
	if (rc < 0)
		return diagnostics_add(diagnostics, rc, content->folder, 0, "%s", strerror(-rc));
	if (!options->force && master_open(out, folder, &stamp) == 0) {
		master_drop_leftovers(folder, stamp);
		return 0;
	}
	report->made = true;
	rc = make_master(folder, scans, stamp, &master, &report->master, diagnostics);
	if (rc == 0)
		rc = master_open(out, folder, &stamp);
	return rc < 0 ? diagnostics_add(diagnostics, rc, folder, 0, "%s", strerror(-rc)) : 0;
}

void build_known_master(struct master **out, struct scans *scans)
{
	const struct build_master_options none = { .jobs = 0 };
	const struct master_options options = master_options(scans_content(scans), &none);
	char folder[CONTENT_PATH_BYTES];
	struct hash stamp;

	*out = NULL;
	if (locate_master(folder, &stamp, scans, &options, NULL) < 0 ||
	    master_open(out, folder, &stamp) < 0)
		*out = NULL;
}

bool build_is_current(struct scans *scans)
{
	struct content other = *scans_content(scans);
	struct scans *alike = NULL;
	struct master *master;
	bool is_current;

	other.binary_tree = !other.binary_tree;
	build_known_master(&master, scans);
	if (!master && scans_create(&alike, &other) == 0)
		build_known_master(&master, alike);
	is_current = master && sampler_is_current(scans, master);
	master_destroy(master);
	scans_destroy(alike);
	return is_current;
}

int build_samples(struct scans *scans, const struct master *master,
		  const struct sampler_options *options, struct diagnostics *diagnostics)
{
	struct sampler_options chosen = *options;
	const struct scans_shape *shape;
	int rc = scans_get_shape(scans, &shape, diagnostics);

	/* patches have no pictures */
	chosen.master = rc == 0 && !shape->has_textures ? master : NULL;
	return rc == 0 ? sampler_run(scans, &chosen, diagnostics) : rc;
}

/* Measures a stage: from begin_stage to end_stage. */
struct stopwatch {
	int64_t ms;
	struct resource_usage usage;
};

static void begin_stage(struct stopwatch *watch)
{
	resource_usage_reset_own();
	watch->ms = clock_now_ms();
	resource_usage_now(&watch->usage);
}

/* The largest child is known only if no earlier one was larger. */
static void end_stage(const struct stopwatch *watch, struct report_stage *stage, const char *name)
{
	struct resource_usage now;

	resource_usage_now(&now);
	stage->name = name;
	stage->ms = clock_now_ms() - watch->ms;
	stage->processor_us = now.processor_us - watch->usage.processor_us;
	stage->memory_bytes = now.own_bytes;
	if (now.child_bytes > watch->usage.child_bytes && now.child_bytes > stage->memory_bytes)
		stage->memory_bytes = now.child_bytes;
}

static int make_surface(struct build_report *report, struct scans *scans)
{
	struct report_stage *stage = &report->stages[BUILD_SURFACE];
	struct diagnostics diagnostics = { 0 };
	struct scans_surface surface;
	struct stopwatch watch;
	bool made;
	int rc;

	scans_surface(scans, &surface);
	if (surface.scan_count == 0)
		return 0;
	begin_stage(&watch);
	rc = scans_make_surface(scans, &made, &diagnostics);
	end_stage(&watch, stage, "surface");
	stage->was_there = !made;
	return rc < 0 ? fail(&diagnostics, rc) : 0;
}

static int make_master_and_samples(struct build_report *report, uint32_t jobs, struct scans *scans)
{
	const struct build_master_options mastering = { .jobs = jobs };
	const struct sampler_options sampling = { .jobs = jobs };
	struct diagnostics diagnostics = { 0 };
	struct build_master_report made;
	struct master *master;
	struct stopwatch watch;
	int rc;

	begin_stage(&watch);
	rc = build_master(&master, scans, &mastering, &made, &diagnostics);
	if (rc == 0)
		report->source_triangles = master->source_triangles;
	end_stage(&watch, &report->stages[BUILD_HIERARCHY], "import and hierarchy");
	report->stages[BUILD_HIERARCHY].was_there = !made.made;
	begin_stage(&watch);
	if (rc == 0)
		rc = build_samples(scans, master, &sampling, &diagnostics);
	end_stage(&watch, &report->stages[BUILD_SAMPLES], "samples");
	master_destroy(master);
	return rc < 0 ? fail(&diagnostics, rc) : 0;
}

static int run_stages(struct build_report *report, uint32_t jobs,
		      const struct publish_content_options *publish)
{
	int rc = sources_check_texts(publish->sources); /* before the long work, not after it */
	struct stopwatch watch;

	if (rc == 0)
		rc = make_surface(report, sources_scans(publish->sources));
	if (rc == 0)
		rc = sources_check(publish->sources);
	if (rc == 0)
		rc = make_master_and_samples(report, jobs, sources_scans(publish->sources));
	begin_stage(&watch);
	if (rc == 0)
		rc = publish_content(&report->publish, publish);
	end_stage(&watch, &report->stages[BUILD_PUBLISHING], "publishing");
	return rc;
}

/* A release without a report is a release; but a full disk must be told. */
static int write_report(struct build_report *report, struct sources *sources)
{
	const uint32_t first = report->stages[BUILD_SURFACE].name ? BUILD_SURFACE : BUILD_HIERARCHY;
	const struct report_options options = { .sources = sources,
						.publish = &report->publish,
						.stages = &report->stages[first],
						.stage_count = BUILD_STAGES - first };
	int rc = report_write(&options, report->page);

	if (rc < 0)
		report->page[0] = '\0';
	return rc == -ENOSPC ? rc : 0;
}

/* Removes temporary files of builds that were killed; young ones may be those of a shard that works
 * beside us (docs/cluster.md). */
static void sweep_work(const struct content *content)
{
	static const char *const folders[] = { ".work", ".work/samples", ".work/master" };
	char path[CONTENT_PATH_BYTES + 16];

	for (size_t i = 0; i < ARRAY_COUNT(folders); i++) {
		snprintf(path, sizeof(path), "%s/%s", content->folder, folders[i]);
		bytes_sweep_folder(path, clock_wall_s() - LEFTOVER_AGE_S);
	}
}

static int build_from(struct build_report *report, struct sources *sources,
		      const struct build_options *options)
{
	const struct publish_content_options publish = { .sources = sources,
							 .out = options->out,
							 .keys = options->keys,
							 .comment = options->comment };
	char stamp_path[CONTENT_PATH_BYTES];
	struct stamp_file file;
	struct hash stamp;
	int rc = content_work_path(sources_content(sources), "built", stamp_path);

	sweep_work(sources_content(sources));
	if (rc == 0)
		rc = make_stamp(&stamp, sources, options);
	if (rc < 0)
		return rc;
	rc = renew_if_built(report, stamp_path, stamp, &publish);
	if (rc < 0 || report->nothing_changed)
		return rc;
	rc = run_stages(report, options->jobs, &publish);
	if (rc < 0)
		return rc;
	rc = write_report(report, sources);
	if (rc < 0)
		return rc;
	file = stamp_text(stamp, report->publish.publish.release.root);
	return bytes_write_file((struct bytes){ (uint8_t *)file.text, strlen(file.text) },
				stamp_path);
}

int build_content(struct build_report *report, const struct content *content,
		  const struct build_options *options)
{
	int64_t start = clock_now_ms();
	struct sources *sources;
	int rc = sources_create(&sources, content);

	*report = (struct build_report){ 0 };
	if (rc == 0)
		rc = build_from(report, sources, options);
	sources_destroy(sources);
	report->all_ms = clock_now_ms() - start;
	return rc;
}
