/* Counts what there is to do, measures what this machine needs for a piece of each, and multiplies.
 * The factors were measured: docs/estimate.md. */
#include "pipeline/estimate.h"

#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include "base/log.h"
#include "base/parallel.h"
#include "base/proc_number.h"
#include "base/resource_usage.h"
#include "pipeline/hierarchy/master_cut.h"
#include "pipeline/import/scan_look.h"
#include "pipeline/octree/closed_surface.h"
#include "pipeline/octree/reconstruct.h"
#include "pipeline/samples/sampling_forecast.h"
#include "pipeline/samples/sampling_trial.h"

enum { MESA_BYTES = 110 << 20 }; /* of a process that draws with it */
enum { TRIAL_MESH = 100, PLACES_MAX = SCAN_LOOK_PLACES_MAX, JOBS_MAX = 64 };

/* What this machine takes. */
struct speeds {
	double hierarchy_s; /* for each triangle */
	struct sampling_trial sampling;
};

/* Everything that is looked at. */
struct looking {
	const struct content *content;
	const struct build_options *options;
	struct sources *sources;
	struct estimate *out;
	struct speeds speeds;
	float low_m[3], high_m[3];
	struct scans_surface surface;
	float (*places_m)[3]; /* owned */
	uint32_t place_count;
	struct master *master; /* owned; NULL: to be made */
	struct sample_grid grid;
	double tile_bytes; /* of a tile as the trial has them, to that of this content */
	uint64_t samples_done_bytes;
	double triangle_share; /* of a face */
};

static int fail(const struct diagnostics *diagnostics, int rc)
{
	log_error("pipeline", "%s", diagnostics_cause(diagnostics, rc));
	return rc;
}

/* ---- the scans */

/* Triangles of the surface of a point, with cubes of the default size, where scans overlap as those
 * of a statue; docs/estimate.md. */
static const double points_triangles = 0.45;

static void grow_box(struct looking *looking, const float (*places_m)[3], uint32_t count)
{
	for (uint32_t i = 0; i < count; i++)
		for (int k = 0; k < 3; k++) {
			looking->low_m[k] = fminf(looking->low_m[k], places_m[i][k]);
			looking->high_m[k] = fmaxf(looking->high_m[k], places_m[i][k]);
		}
}

static int look_at_scan(struct looking *looking, struct scan_look *look, uint32_t scan)
{
	struct estimate_work *work = &looking->out->work;
	struct diagnostics diagnostics = { 0 };
	uint32_t scan_count = looking->content->scan_count, share = PLACES_MAX / scan_count;
	struct import_options options = looking->content->import;
	uint32_t step;
	int rc = 0;

	options.transform = looking->content->transforms[scan];
	if (looking->surface.is_points[scan])
		rc = range_scan_check(looking->content->scans[scan], &diagnostics);
	if (rc == 0)
		rc = scan_look(look, looking->content->scans[scan], &options, &diagnostics);
	if (rc < 0)
		return fail(&diagnostics, rc);
	if (look->is_points) {
		look->triangle_count = (uint64_t)(points_triangles * (double)look->vertex_count);
		look->vertex_count = look->triangle_count / 2;
	}
	work->triangle_count += look->triangle_count;
	work->vertex_count += look->vertex_count;
	work->is_counted &= look->is_counted && !look->is_points;
	work->is_text |= look->is_text;
	work->is_foreign |= strcmp(look->format, "PLY") != 0;
	work->has_pictures |= look->has_pictures;
	grow_box(looking, (const float(*)[3])look->places_m, look->place_count);
	step = look->place_count / share + 1;
	for (uint32_t i = 0; i < look->place_count; i += step)
		memcpy(looking->places_m[looking->place_count++], look->places_m[i],
		       sizeof(looking->places_m[0]));
	return 0;
}

/* With surface = octree: guesses the triangles of the closed surface from the scan's box;
 * docs/estimate.md. */
static void guess_closed(struct looking *looking)
{
	static const double box_share = 0.5;
	struct estimate_work *work = &looking->out->work;
	double area = 0, longest = 0, cell;

	if (looking->content->surface != CONTENT_SURFACE_OCTREE)
		return;
	for (int k = 0; k < 3; k++) {
		const int a = (k + 1) % 3, b = (k + 2) % 3;

		area += 2 * box_share * (double)(looking->high_m[a] - looking->low_m[a]) *
			(double)(looking->high_m[b] - looking->low_m[b]);
		longest = fmax(longest, (double)(looking->high_m[k] - looking->low_m[k]));
	}
	cell = closed_surface_cell(looking->content->cell_mm / 1000, area,
				   (uint32_t)fmin(UINT32_MAX, (double)work->triangle_count),
				   longest);
	work->closed_from = work->triangle_count;
	work->triangle_count =
		cell > 0 ? (uint64_t)(CLOSED_SURFACE_TRIANGLES * area / (cell * cell)) : 0;
	work->vertex_count = work->triangle_count / 2;
	work->is_counted = false;
	work->has_pictures = false; /* colours instead */
}

/* Scatters places over the box's sides where the scan gave next to none. */
static void fill_places(struct looking *looking)
{
	enum { FEW = 100, SIDE = 20 };

	if (looking->place_count >= FEW)
		return;
	looking->place_count = 0;
	for (int n = 0; n < 6 * SIDE * SIDE; n++) {
		float *place = looking->places_m[looking->place_count++];
		int axis = n % 3, i = n / 6 % SIDE, j = n / 6 / SIDE;
		float at[3];

		at[axis] = n % 6 < 3 ? 0 : 1;
		at[(axis + 1) % 3] = (float)i / (SIDE - 1);
		at[(axis + 2) % 3] = (float)j / (SIDE - 1);
		for (int k = 0; k < 3; k++)
			place[k] = looking->low_m[k] +
				   at[k] * (looking->high_m[k] - looking->low_m[k]);
	}
}

static int look_at_scans(struct looking *looking)
{
	const struct content *content = looking->content;
	struct scan_look *look = malloc(sizeof(*look));
	const struct scans_shape *shape = scans_known_shape(sources_scans(looking->sources));
	int rc = look ? 0 : -ENOMEM;

	looking->out->work.is_counted = true;
	scans_surface(sources_scans(looking->sources), &looking->surface);
	looking->out->work.surface_points = looking->surface.point_count;
	looking->out->stages[ESTIMATE_SURFACE].is_done = looking->surface.is_made;
	for (int k = 0; k < 3; k++) {
		looking->low_m[k] = INFINITY;
		looking->high_m[k] = -INFINITY;
	}
	for (uint32_t i = 0; rc == 0 && i < content->scan_count; i++)
		rc = look_at_scan(looking, look, i);
	free(look);
	for (int k = 0; k < 3 && rc == 0; k++)
		if (!(looking->low_m[k] <= looking->high_m[k])) {
			looking->low_m[k] = 0;
			looking->high_m[k] = 1;
		}
	if (rc == 0)
		guess_closed(looking);
	if (rc == 0 && shape) {
		memcpy(looking->low_m, shape->low_m, sizeof(shape->low_m));
		memcpy(looking->high_m, shape->high_m, sizeof(shape->high_m));
		looking->out->work.has_pictures = shape->has_textures;
		looking->out->stages[ESTIMATE_IMPORT].is_done = true;
	}
	if (rc == 0)
		fill_places(looking);
	return rc;
}

/* ---- what is there */

static void look_for_master(struct looking *looking)
{
	build_known_master(&looking->master, sources_scans(looking->sources));
	if (!looking->master)
		return;
	looking->out->stages[ESTIMATE_HIERARCHY].is_done = true;
	looking->out->work.triangle_count = looking->master->source_triangles;
	looking->out->work.is_counted = true;
}

static int look_for_samples(struct looking *looking)
{
	struct estimate_work *work = &looking->out->work;
	struct sampler_options options = { .master = work->has_pictures ? NULL : looking->master };
	struct diagnostics diagnostics = { 0 };
	struct sampling_forecast forecast;
	struct sampler_progress progress = { 0 };
	int rc = 0;

	/* The key of samples includes the hierarchy they are drawn from. */
	if (work->has_pictures || looking->master)
		rc = sampler_look(&progress, sources_scans(looking->sources), &options,
				  &diagnostics);
	if (rc < 0 && rc != -ENOENT)
		return fail(&diagnostics, rc);
	looking->grid = progress.grid;
	if (progress.point_count == 0) {
		sampler_grid(&looking->grid, looking->low_m, looking->high_m,
			     looking->content->grid_points, looking->content->face_px, false);
		sampler_add_first_view(&looking->grid, looking->content, looking->low_m,
				       looking->high_m);
	}
	sampling_forecast(&forecast, &looking->grid, (const float(*)[3])looking->places_m,
			  looking->place_count, looking->low_m, looking->high_m);
	work->point_count = forecast.point_count;
	work->points_done = progress.done_count;
	work->face_count = forecast.face_count;
	work->tile_count = forecast.tile_count;
	work->seconds_a_point = progress.seconds_a_point;
	looking->triangle_share = forecast.triangle_share;
	looking->samples_done_bytes = progress.done_bytes;
	looking->out->stages[ESTIMATE_SAMPLES].is_done =
		progress.point_count > 0 && progress.done_count == progress.point_count;
	return 0;
}

/* ---- this machine */

static int try_hierarchy(struct looking *looking)
{
	struct master_options options = { .multires = { .jobs = 1 } };
	char folder[CONTENT_PATH_BYTES];
	struct master_report report;
	struct resource_usage before, after;
	struct mesh mesh;
	int rc = content_work_path(looking->content, "trial-XXXXXX", folder);

	if (rc == 0 && !mkdtemp(folder))
		rc = -errno;
	if (rc < 0) {
		log_error("pipeline", "%s: %s", folder, strerror(-rc));
		return rc;
	}
	rc = sampling_trial_mesh(&mesh, TRIAL_MESH);
	resource_usage_now(&before);
	if (rc == 0)
		rc = master_build(folder, &mesh, (struct hash){ { 0 } }, &options, &report);
	resource_usage_now(&after);
	looking->speeds.hierarchy_s = (double)(after.processor_us - before.processor_us) / 1e6 /
				      (4.0 * TRIAL_MESH * TRIAL_MESH);
	mesh_finish(&mesh);
	bytes_remove_folder(folder);
	return rc;
}

static int try_machine(struct looking *looking)
{
	enum { budget_quality = 80 };
	const struct content *content = looking->content;
	struct content tried = *content;
	const struct estimate_stage *stages = looking->out->stages;
	int rc = 0;

	if (!stages[ESTIMATE_HIERARCHY].is_done || !stages[ESTIMATE_IMPORT].is_done)
		rc = try_hierarchy(looking);
	tried.quality = content->budget_bytes > 0 ? budget_quality : content->quality;
	if (rc == 0 && !stages[ESTIMATE_SAMPLES].is_done)
		rc = sampling_trial(&looking->speeds.sampling, &tried,
				    content_is_lit(content, looking->out->work.has_pictures));
	return rc;
}

/* ---- the stages */

/* Measured factors; docs/estimate.md. */
static const double
	/* reading a triangle, in costs of a triangle of the hierarchy */
	import_binary = 0.04,
	import_text = 0.09, import_foreign = 0.14,
	/* reading a point twice and adding it to the distances around it, likewise */
	surface_point = 0.5, surface_serial = 0.9,
	/* closing a scan, for each triangle of the surface, likewise */
	closing = 3.5, closing_serial = 0.2,
	/* a triangle of a real scan to one of the trial's ball */
	hierarchy_real = 0.68,
	/* of the scan's triangles, to the power of which that cost falls */
	hierarchy_fall = 0.13,
	/* bytes of a tile to those of the trial's */
	bytes_plain = 2.33, bytes_pictures = 2.0, bytes_procedural = 5.5,
	/* processor time of a tile's bytes beyond those of the trial's, in costs of such a tile for
	 * each 1000 of them */
	more_thorough = 0.65, more_quick = 0.25,
	/* of a tile whose face is drawn by Mesa, which a scan with pictures needs, to the trial's
	 */
	tile_pictures = 2.4,
	/* processor time of a triangle that is drawn: those of the trial are far away, and most of
	 * them smaller than a pixel */
	triangle_real = 5, triangle_pictures = 3.5,
	/* with a budget, bytes of a tile at its lowest quality, at its best one, and at all five
	 * together, to those at the one that the trial encodes, which is budget_quality */
	choice_least = 0.43, choice_most = 1.9, choice_all = 4.6,
	/* processor time of encoding five to that of one; not measured */
	choice_time = 5,
	/* bytes of the objects of all groups, for each triangle of the scan */
	master_bytes = 4.2,
	/* of published patches, for each of their triangles */
	published_bytes = 2.7,
	/* processor time of publishing, for each byte */
	publish_s_a_byte = 14e-9;

/* How long work takes on the processors if all but `serial` of it can be shared. */
static double spread(const struct looking *looking, double processor_s, double serial)
{
	return processor_s * (serial + (1 - serial) / looking->out->jobs);
}

static void judge_surface(struct looking *looking)
{
	/* Bytes of a scan's points, of the distances near a point, and of the file. */
	enum { RESIDENT = 512 << 20, A_POINT = 40, A_TRIANGLE = 22 };
	const struct estimate_work *work = &looking->out->work;
	struct estimate_stage *stage = &looking->out->stages[ESTIMATE_SURFACE];
	const double points = (double)work->surface_points;

	if (work->surface_points == 0)
		return;
	stage->disk_bytes = A_TRIANGLE * work->triangle_count;
	stage->processor_s = surface_point * looking->speeds.hierarchy_s * points;
	stage->time_s = spread(looking, stage->processor_s, surface_serial);
	stage->memory_bytes = (uint64_t)fmin(RESIDENT, A_POINT * points) + (25u << 20);
}

static void judge_import(struct looking *looking)
{
	struct estimate_work *work = &looking->out->work;
	struct estimate_stage *stage = &looking->out->stages[ESTIMATE_IMPORT];
	double each = work->is_foreign ? import_foreign
		      : work->is_text  ? import_text
				       : import_binary;
	/* A vertex on the seam of a picture is there more than once. */
	uint64_t mesh_bytes = work->triangle_count * (work->has_pictures ? 18 : 16) +
			      work->vertex_count * (work->has_pictures ? 48 : 16);

	stage->disk_bytes = mesh_bytes;
	stage->processor_s = each * looking->speeds.hierarchy_s * (double)work->triangle_count;
	stage->time_s = spread(looking, stage->processor_s, 1);
	stage->memory_bytes = (16u << 20) + (work->is_foreign ? 6 : 2) * mesh_bytes;
	if (work->closed_from > 0) {
		enum { RESIDENT = 512 << 20, A_TRIANGLE = 250 };
		const double closing_s =
			closing * looking->speeds.hierarchy_s * (double)work->triangle_count;

		stage->processor_s += closing_s;
		stage->time_s += spread(looking, closing_s, closing_serial);
		stage->memory_bytes +=
			(uint64_t)fmin(RESIDENT, A_TRIANGLE * (double)work->closed_from);
	}
}

static void judge_hierarchy(struct looking *looking)
{
	const struct estimate_work *work = &looking->out->work;
	struct estimate_stage *stage = &looking->out->stages[ESTIMATE_HIERARCHY];

	stage->disk_bytes = (uint64_t)(master_bytes * (double)work->triangle_count);
	stage->processor_s = hierarchy_real * looking->speeds.hierarchy_s *
			     (double)work->triangle_count *
			     pow((double)work->triangle_count / 1e5, -hierarchy_fall);
	stage->time_s = spread(looking, stage->processor_s, 0.5);
	stage->memory_bytes =
		(40u << 20) + 250 * (work->triangle_count < 600000 ? work->triangle_count : 600000);
}

/* The files of the blocks of a scan that is built in several, which are removed at the end. */
static uint64_t blocks_bytes(const struct estimate_work *work)
{
	enum { BLOCK = 1 << 19, A_TRIANGLE = 20 };

	return work->triangle_count > BLOCK ? work->triangle_count * A_TRIANGLE : 0;
}

static double content_tile_bytes(const struct looking *looking)
{
	double factor = looking->out->work.has_pictures                           ? bytes_pictures
			: looking->content->colours == CONTENT_COLOURS_PROCEDURAL ? bytes_procedural
										  : bytes_plain;

	return factor * looking->speeds.sampling.tile_bytes;
}

/* Tiles that show more than the trial's take the encoder longer. */
static double content_tile_s(const struct looking *looking)
{
	const struct sampling_trial *trial = &looking->speeds.sampling;
	double more = looking->content->effort == TILE_QUICK ? more_quick : more_thorough;
	double bytes = fmax(0, content_tile_bytes(looking) - trial->tile_bytes);

	return (looking->content->budget_bytes > 0 ? choice_time : 1) * trial->tile_s *
	       (1 + more * bytes / 1000) * (looking->out->work.has_pictures ? tile_pictures : 1);
}

/* What a process of the sampler keeps of the surface, beyond what the trial has. */
static uint64_t surface_bytes(const struct estimate_work *work)
{
	enum { TRIAL_BYTES = 20 << 20, A_TRIANGLE = 250, MOST = 90 << 20 };
	uint64_t bytes = work->triangle_count * A_TRIANGLE;

	bytes = bytes < MOST ? bytes : MOST;
	return bytes > TRIAL_BYTES ? bytes - TRIAL_BYTES : 0;
}

static void judge_samples(struct looking *looking)
{
	const struct estimate_work *work = &looking->out->work;
	const struct sampling_trial *trial = &looking->speeds.sampling;
	struct estimate_stage *stage = &looking->out->stages[ESTIMATE_SAMPLES];
	double todo = 1 - (double)work->points_done / fmax(1, work->point_count);
	double triangles = looking->triangle_share * (double)work->triangle_count;
	double texels = 0.75 * SAMPLE_TILE_PX * SAMPLE_TILE_PX * (double)work->tile_count /
			fmax(1, (double)work->face_count);
	double jobs = looking->out->jobs;
	double each = work->has_pictures ? triangle_pictures : triangle_real;

	/* Of a master only a cut is drawn, whose vertices are about a texel apart; as many of its
	 * triangles show their backs. */
	if (!work->has_pictures)
		triangles = fmin(triangles, 3 * texels);

	stage->disk_bytes =
		(uint64_t)(todo * (double)work->tile_count * content_tile_bytes(looking) *
			   (looking->content->budget_bytes > 0 ? choice_all : 1));
	if (work->points_done >= 8) /* what is done tells more than a trial */
		stage->disk_bytes = looking->samples_done_bytes / work->points_done *
				    (work->point_count - work->points_done);
	stage->disk_bytes += looking->samples_done_bytes;
	if (stage->is_done)
		return;
	stage->processor_s =
		jobs * trial->start_s +
		todo * ((double)work->face_count *
				(trial->face_s + each * trial->triangle_s * triangles) +
			(double)work->tile_count * content_tile_s(looking));
	stage->time_s = stage->processor_s / jobs;
	if (work->seconds_a_point > 0) {
		stage->time_s = work->seconds_a_point * (work->point_count - work->points_done);
		stage->processor_s = stage->time_s * jobs;
	}
	stage->memory_bytes = (uint64_t)jobs * (trial->process_bytes + surface_bytes(work) +
						(work->has_pictures ? MESA_BYTES : 0));
}

/* Adds tiles to a release of all else, as many bytes as the budget lets. */
static void spend_budget(struct estimate *out, uint64_t budget_bytes)
{
	double tiles = (double)out->stages[ESTIMATE_SAMPLES].disk_bytes / choice_all;
	uint64_t most_bytes = out->release_bytes + (uint64_t)(choice_most * tiles);

	out->budget_bytes = budget_bytes;
	out->least_bytes = out->release_bytes + (uint64_t)(choice_least * tiles);
	out->release_bytes = budget_bytes < most_bytes ? budget_bytes : most_bytes;
	if (out->release_bytes < out->least_bytes)
		out->release_bytes = out->least_bytes;
}

static void judge_publishing(struct looking *looking)
{
	struct estimate *out = looking->out;
	struct estimate_stage *stage = &out->stages[ESTIMATE_PUBLISHING];
	/* Bytes of pages, and of the smallest information. */
	enum { A_TILE = 24, A_FACE = 100, INFORMATION = 90000 };
	struct master_cut cut;
	double share = looking->content->publish_share;
	uint64_t patches_bytes = 0;

	out->work.published_triangles = (uint64_t)(share * (double)out->work.triangle_count);
	if (share >= 1)
		out->work.published_triangles =
			out->work.triangle_count + out->work.triangle_count / 3;
	patches_bytes = (uint64_t)(published_bytes * (double)out->work.published_triangles);
	if (looking->master && master_cut_create(&cut, looking->master, share) == 0) {
		patches_bytes = 0;
		for (uint32_t i = 0; i < cut.hierarchy.group_count; i++)
			patches_bytes += looking->master->sizes[cut.groups[i]];
		out->work.published_triangles = cut.triangle_count;
		master_cut_finish(&cut);
	}
	out->release_bytes = patches_bytes + A_TILE * out->work.tile_count +
			     A_FACE * out->work.face_count + INFORMATION;
	if (looking->content->budget_bytes > 0)
		spend_budget(out, looking->content->budget_bytes);
	else
		out->release_bytes += out->stages[ESTIMATE_SAMPLES].disk_bytes;
	stage->disk_bytes = out->release_bytes;
	stage->processor_s = 0.03 + publish_s_a_byte * (double)out->release_bytes;
	stage->time_s = spread(looking, stage->processor_s, 1);
	stage->memory_bytes = (20u << 20) + out->release_bytes / 16;
}

static void judge(struct looking *looking)
{
	struct estimate *out = looking->out;
	uint64_t blocks = blocks_bytes(&out->work);

	judge_surface(looking);
	judge_import(looking);
	judge_hierarchy(looking);
	judge_samples(looking);
	judge_publishing(looking);
	for (int i = 0; i < ESTIMATE_STAGES; i++) {
		struct estimate_stage *stage = &out->stages[i];

		if (stage->is_done) {
			stage->time_s = stage->processor_s = 0;
			stage->memory_bytes = 0;
			out->disk_present_bytes += stage->disk_bytes;
		}
		out->time_s += stage->time_s;
		if (stage->memory_bytes > out->memory_bytes)
			out->memory_bytes = stage->memory_bytes;
		if (i != ESTIMATE_PUBLISHING)
			out->work_bytes += stage->disk_bytes;
	}
	out->disk_peak_bytes = out->work_bytes + out->release_bytes;
	blocks += out->stages[ESTIMATE_IMPORT].disk_bytes;
	if (!out->stages[ESTIMATE_HIERARCHY].is_done && blocks > out->disk_peak_bytes)
		out->disk_peak_bytes = blocks;
}

/* ---- the machine's room */

static uint64_t available_memory(void)
{
	unsigned long long kib;

	return proc_number("/proc/meminfo", "MemAvailable: %llu", &kib) ? kib * 1024 : 0;
}

static void look_at_room(struct looking *looking)
{
	struct estimate *out = looking->out;
	struct statvfs room;
	uint32_t cores = parallel_cores();

	out->disk_free_bytes = statvfs(looking->content->folder, &room) == 0
				       ? (uint64_t)room.f_bavail * room.f_frsize
				       : UINT64_MAX;
	out->memory_free_bytes = available_memory();
	if (getloadavg(&out->load, 1) != 1)
		out->load = 0;
	out->processors = cores;
	out->jobs = looking->options->jobs ? looking->options->jobs : cores;
	out->jobs = out->jobs > cores ? cores : out->jobs;
}

static int look(struct looking *looking)
{
	int rc = sources_check_texts(looking->sources);

	look_at_room(looking);
	if (rc == 0)
		rc = look_at_scans(looking);
	if (rc < 0)
		return rc;
	look_for_master(looking);
	rc = look_for_samples(looking);
	if (rc == 0)
		rc = try_machine(looking);
	if (rc == 0)
		judge(looking);
	return rc;
}

int estimate_build(struct estimate *out, const struct content *content,
		   const struct build_options *options)
{
	struct looking looking = { .content = content, .options = options, .out = out };
	int rc = sources_create(&looking.sources, content);

	*out = (struct estimate){ 0 };
	looking.places_m = calloc(PLACES_MAX + CONTENT_SCANS_MAX, sizeof(*looking.places_m));
	if (rc == 0 && !looking.places_m)
		rc = -ENOMEM;
	if (rc == 0)
		rc = look(&looking);
	master_destroy(looking.master);
	free(looking.places_m);
	sources_destroy(looking.sources);
	return rc;
}

/* ---- for people */

static const char *time_text(char out[32], double seconds)
{
	if (seconds < 100)
		snprintf(out, 32, "%.*f s", seconds < 10 ? 1 : 0, seconds);
	else if (seconds < 6000)
		snprintf(out, 32, "%.*f min", seconds < 600 ? 1 : 0, seconds / 60);
	else
		snprintf(out, 32, "%.1f h", seconds / 3600);
	return out;
}

static const char *size_text(char out[32], uint64_t bytes)
{
	double mb = (double)bytes / 1e6;

	if (mb < 1000)
		snprintf(out, 32, "%.*f MB", mb < 10 ? 1 : 0, mb);
	else
		snprintf(out, 32, "%.1f GB", mb / 1000);
	return out;
}

static void print_room(FILE *to, const struct estimate *estimate)
{
	char need[32], has[32];
	uint64_t missing = estimate->disk_peak_bytes - estimate->disk_present_bytes;

	fprintf(to, "disk: %s more are needed, %s are free%s\n", size_text(need, missing),
		size_text(has, estimate->disk_free_bytes),
		missing > estimate->disk_free_bytes ? "; free some before you build" : "");
	if (estimate->memory_free_bytes > 0)
		fprintf(to, "memory: %s are needed, %s are available%s\n",
			size_text(need, estimate->memory_bytes),
			size_text(has, estimate->memory_free_bytes),
			estimate->memory_bytes > estimate->memory_free_bytes ? "; use fewer --jobs"
									     : "");
	if (estimate->load > estimate->processors * 0.5)
		fprintf(to,
			"other work runs on this machine (load %.1f on %" PRIu32
			" processors): the build will take longer\n",
			estimate->load, estimate->processors);
}

static void print_stage(FILE *to, const char *name, const struct estimate_stage *stage)
{
	char time[32], processor[32], memory[32], disk[32];

	size_text(disk, stage->disk_bytes);
	if (stage->is_done)
		fprintf(to, "%-12s %10s %10s %10s %10s\n", name, "is done", "-", "-", disk);
	else
		fprintf(to, "%-12s %10s %10s %10s %10s\n", name, time_text(time, stage->time_s),
			time_text(processor, stage->processor_s),
			size_text(memory, stage->memory_bytes), disk);
}

void estimate_print(FILE *to, const struct estimate *estimate)
{
	static const char *const names[] = { "surface", "import", "hierarchy", "samples",
					     "publishing" };
	const struct estimate_work *work = &estimate->work;
	struct estimate_stage all = { .time_s = estimate->time_s,
				      .memory_bytes = estimate->memory_bytes,
				      .disk_bytes = estimate->disk_peak_bytes };
	char memory[32], disk[32];

	for (int i = 0; i < ESTIMATE_STAGES; i++)
		all.processor_s += estimate->stages[i].processor_s;
	fprintf(to,
		"%s%" PRIu64 " triangles%s%s; %" PRIu32 " sampling points, about %" PRIu64
		" faces and %" PRIu64 " tiles\n",
		work->is_counted ? "" : "about ", work->triangle_count,
		work->surface_points > 0 || work->closed_from > 0
			? ", mostly of a surface that is made first"
			: "",
		work->has_pictures ? " with pictures" : "", work->point_count, work->face_count,
		work->tile_count);
	if (work->points_done > 0)
		fprintf(to, "%" PRIu32 " of the %" PRIu32 " points are done already\n",
			work->points_done, work->point_count);
	fprintf(to, "\n%-12s %10s %10s %10s %10s\n", "stage", "time", "processor", "memory",
		"disk");
	for (int i = 0; i < ESTIMATE_STAGES; i++)
		if (i != ESTIMATE_SURFACE || work->surface_points > 0)
			print_stage(to, names[i], &estimate->stages[i]);
	print_stage(to, "all", &all);
	fprintf(to, "\n");
	fprintf(to, "release: %s, about %" PRIu64 " triangles; .work keeps %s\n",
		size_text(disk, estimate->release_bytes), work->published_triangles,
		size_text(memory, estimate->work_bytes));
	if (estimate->budget_bytes > 0)
		fprintf(to, "budget: %s; at least about %s are needed%s\n",
			size_text(disk, estimate->budget_bytes),
			size_text(memory, estimate->least_bytes),
			estimate->budget_bytes < estimate->least_bytes ? ": it seems too small"
								       : "");
	print_room(to, estimate);
}
