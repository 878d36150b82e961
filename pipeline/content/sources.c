/* Reads and compiles the information once, with its lists of faces and the check of its tours. */
#include "pipeline/content/sources.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "base/log.h"
#include "pipeline/content/part_faces.h"
#include "pipeline/content/scenes.h"
#include "pipeline/content/tour_check.h"

/* All errors are logged, but only the first few warnings. */
enum { WARNINGS_SHOWN = 5, TOURS_BYTES_MAX = 64 };

struct sources {
	const struct content *content;
	struct scans *scans;
	struct part_faces_all faces;
	const char *languages[CONTENT_LANGUAGES_MAX];
	struct info_build_options options;
	struct draft *draft; /* NULL: not read yet, or compiled */
	struct info_built built;
	bool is_built;
	struct scenery scenery;
	bool has_scenery;         /* was read */
	struct diagnostics found; /* in the files of the folder */
	bool is_quiet;
	uint32_t logged, warnings; /* how many of them were logged, and how many are warnings */
};

/* Logs what was found since the last call. */
static void log_found(struct sources *sources)
{
	for (; !sources->is_quiet && sources->logged < sources->found.count; sources->logged++) {
		const struct diagnostic *found = diagnostics_get(&sources->found, sources->logged);

		if (found->error < 0)
			log_error("pipeline", "%s", found->text);
		else if (++sources->warnings <= WARNINGS_SHOWN)
			log_warn("pipeline", "%s", found->text);
	}
}

static void set_options(struct sources *sources)
{
	const struct content *content = sources->content;

	for (uint32_t i = 0; i < content->language_count; i++)
		sources->languages[i] = content->languages[i];
	sources->options = (struct info_build_options){ .folder = content->folder,
							.languages = sources->languages,
							.language_count = content->language_count,
							.tools = content->tools,
							.scan_error_m = content->error_mm / 1000,
							.diagnostics = &sources->found,
							.judge_faces = part_faces_judge,
							.place_faces = part_faces_place,
							.faces_data = &sources->faces };
}

int sources_create(struct sources **out, const struct content *content)
{
	struct sources *sources = calloc(1, sizeof(*sources));
	int rc = sources ? scans_create(&sources->scans, content) : -ENOMEM;

	*out = NULL;
	if (rc < 0) {
		free(sources);
		return rc;
	}
	sources->content = content;
	sources->found.max = INFO_DIAGNOSTICS_MAX;
	part_faces_init(&sources->faces, sources->scans);
	set_options(sources);
	*out = sources;
	return 0;
}

void sources_destroy(struct sources *sources)
{
	if (!sources)
		return;
	info_built_finish(&sources->built);
	scenery_finish(&sources->scenery);
	info_draft_destroy(sources->draft);
	part_faces_finish(&sources->faces);
	scans_destroy(sources->scans);
	diagnostics_finish(&sources->found);
	free(sources);
}

const struct content *sources_content(const struct sources *sources)
{
	return sources->content;
}

struct scans *sources_scans(struct sources *sources)
{
	return sources->scans;
}

void sources_be_quiet(struct sources *sources)
{
	sources->is_quiet = true;
}

const struct diagnostics *sources_found(const struct sources *sources)
{
	return &sources->found;
}

/* ---- the ways of the tours */

/* .work/tours holds the key of the ways that were found free, in hexadecimal. */
static bool are_known(const char *path, struct hash key)
{
	char hex[HASH_HEX_BYTES];
	struct buffer file;
	bool same;

	hash_to_hex(key, hex);
	buffer_init(&file, TOURS_BYTES_MAX);
	same = buffer_read_file(&file, path) == 0 && file.size == strlen(hex) &&
	       memcmp(file.data, hex, file.size) == 0;
	buffer_finish(&file);
	return same;
}

static int check_ways(struct sources *sources, const struct info_built *built,
		      struct diagnostics *diagnostics)
{
	struct tour_check_options options = { .diagnostics = &sources->found };
	char path[CONTENT_PATH_BYTES], hex[HASH_HEX_BYTES];
	struct hash scans, key;
	int rc = scans_key(sources->scans, &scans, diagnostics);

	if (rc == 0)
		rc = tour_check_key(&key, built, scans);
	if (rc == 0)
		rc = content_work_path(sources->content, "tours", path);
	if (rc < 0 || are_known(path, key))
		return rc;
	rc = scans_get_mesh(sources->scans, &options.mesh, diagnostics);
	if (rc == 0)
		rc = tour_check(built, &options);
	if (rc < 0)
		return rc;
	hash_to_hex(key, hex);
	return bytes_write_file((struct bytes){ (const uint8_t *)hex, strlen(hex) }, path);
}

/* ---- the information */

static int read_folder(struct sources *sources)
{
	int rc = info_read(&sources->draft, &sources->options);

	log_found(sources);
	return rc;
}

static int compile(struct sources *sources, struct diagnostics *diagnostics)
{
	int rc = info_compile(&sources->built, sources->draft);

	if (rc == 0 && sources->faces.part_count > 0)
		rc = part_faces_keep(&sources->faces, diagnostics);
	if (rc == 0 && sources->built.tour_count > 0)
		rc = check_ways(sources, &sources->built, diagnostics);
	log_found(sources);
	if (rc < 0) {
		info_built_finish(&sources->built);
		return rc;
	}
	info_draft_destroy(sources->draft);
	sources->draft = NULL;
	sources->is_built = true;
	if (sources->warnings > WARNINGS_SHOWN)
		log_warn("pipeline", "%s: and %u warnings more of pages and parts",
			 sources->content->folder, sources->warnings - WARNINGS_SHOWN);
	return 0;
}

/* The faults of the folder have been logged; this logs any other. */
static int tell(const struct sources *sources, int rc, const struct diagnostics *diagnostics)
{
	if (sources->is_quiet)
		return rc;
	if (rc < 0 && sources->found.dropped > 0)
		log_error("pipeline", "%s: and %u more", sources->content->folder,
			  sources->found.dropped);
	if (rc < 0 && diagnostics->count > 0)
		log_error("pipeline", "%s", diagnostics_cause(diagnostics, rc));
	else if (rc < 0 && rc != -EINVAL)
		log_error("pipeline", "%s: %s", sources->content->folder, strerror(-rc));
	return rc;
}

int sources_check_texts(struct sources *sources)
{
	const struct diagnostics none = { 0 };
	int rc = 0;

	if (!sources->draft && !sources->is_built)
		rc = read_folder(sources);
	return tell(sources, rc, &none);
}

int sources_scenery(struct sources *sources, const struct scenery **out)
{
	const struct diagnostics none = { 0 };
	int rc = 0;

	*out = NULL;
	if (!sources->has_scenery)
		rc = scenes_read(&sources->scenery, sources->content, &sources->found);
	log_found(sources);
	if (rc < 0)
		return tell(sources, rc, &none);
	sources->has_scenery = true;
	*out = &sources->scenery;
	return 0;
}

int sources_check(struct sources *sources)
{
	const struct info_built *built;
	const struct scenery *scenery;
	int rc = sources_check_texts(sources);

	if (rc == 0)
		rc = sources_scenery(sources, &scenery);

	if (rc == 0 && sources->draft && info_has_tours(sources->draft))
		return sources_info(sources, &built);
	return rc;
}

int sources_info(struct sources *sources, const struct info_built **out)
{
	struct diagnostics diagnostics = { 0 };
	int rc = 0;

	*out = NULL;
	if (!sources->draft && !sources->is_built)
		rc = read_folder(sources);
	if (rc == 0 && !sources->is_built)
		rc = compile(sources, &diagnostics);
	if (rc == 0)
		*out = &sources->built;
	return tell(sources, rc, &diagnostics);
}

int sources_find_faces(struct sources *sources, struct diagnostics *diagnostics)
{
	return part_faces_find_all(&sources->faces, diagnostics);
}

bool sources_faces_of(const struct sources *sources, const char *part, struct sources_faces *out)
{
	const struct part_faces *faces = part_faces_of(&sources->faces, part);

	if (!faces)
		return false;
	*out = (struct sources_faces){ faces->key, faces->triangles, faces->triangle_count };
	return true;
}
